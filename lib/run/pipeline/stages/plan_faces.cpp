// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_faces.hpp"

#include <atomic>

#include "base/counted.hpp"
#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "job/job_engagement.hpp"
#include "planning/result/skipped.hpp"
#include "run/pipeline/stages/face_candidates.hpp"
#include "run/pipeline/stages/other_ways.hpp"
#include "run/pipeline/stages/plan_passes.hpp"
#include "run/pipeline/stages/repair_ends.hpp"
#include "store/cached_stage.hpp"
#include "store/plan_key.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/pass_variants.hpp"

namespace millpose {
namespace {

constexpr int kSequences = 300;  // looked at, one after the other, until one is free
constexpr double kSameHeight = 1 + 1e-9;
// Of the largest displacement: a little less of it would be paid for by displacements that vary along passes,
// and of the marks.
constexpr double kWorthLowering = 0.85, kWorthTurning = 0.99;

class FacesOfJob {
 public:
  FacesOfJob(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
             const Execution& execution, std::vector<PassResult>& passes)
      : inputs_(inputs),
        prepared_(prepared),
        checkpoints_(checkpoints),
        execution_(execution),
        passes_(passes),
        options_{MakeGearModel(inputs.cell),
                 MakePathOptions(inputs.job),
                 MakeLinkMoveOptions(inputs.job).leave,
                 {}},
        first_(static_cast<size_t>(FinishedFrom(inputs.job, passes.size()))),
        directions_(passes.size()),
        at_(passes.size(), 0),
        tried_(passes.size(), 0) {
    for (size_t i = first_; i < passes.size(); ++i)
      directions_[i][0].emplace(FaceDirection{
          prepared.made.toolpath.passes[i], prepared.toolpath.passes[i], std::move(passes[i]), 0, {}});
  }

  std::vector<FaceChoice> Plan() {
    std::vector<size_t> all;
    for (size_t i = first_; i < passes_.size(); ++i) all.push_back(i);
    execution_.progress.Begin("faces", 2 * all.size());
    Attain(all, 0);
    LowerLargest([](const FaceDirection& direction) { return direction.attainable; },
                 [&](size_t i) { Attain({i}, 1); });
    for (const size_t i : all) options_.limit = std::max(options_.limit, Now(i).attainable);
    for (const size_t direction : {0, 1}) {
      std::vector<size_t> run;
      for (const size_t i : all)
        if (at_[i] == direction) run.push_back(i);
      PlanAt(run, direction);
    }
    LowerLargest([](const FaceDirection& direction) { return WorstOf(*direction.face); },
                 [&](size_t i) { PlanAt({i}, 1); });
    RaiseLimit();
    LowerMarks();
    neighbours_ = FindNeighbours();
    const JobFace value = ValueAsItIs();
    if (value.step > std::max(value.worst, options_.limit)) FindSequence(value);
    return Finish();
  }

 private:
  FaceDirection& Now(size_t i) { return *directions_[i][at_[i]]; }

  void Attain(const std::vector<size_t>& run, size_t direction) {
    Each(run, [&](size_t i) {
      FaceDirection& of = *directions_[i][direction];
      of.attainable = Kept<double>("face-bound", i, direction, of.planned, [&](const Stations& stations) {
        return AttainableFace(stations, of.planned, options_, Inner());
      });
    });
  }
  void PlanAt(const std::vector<size_t>& run, size_t direction) {
    Each(run, [&](size_t i) {
      FaceDirection& of = *directions_[i][direction];
      of.face = Kept<PlannedFace>("face", i, direction, of.planned, [&](const Stations& stations) {
        return PlanFace(stations, of.planned, options_, Inner());
      });
    });
  }
  void Each(const std::vector<size_t>& run, const std::function<void(size_t)>& work) {
    ParallelFor(run.size(), execution_.Threads(), execution_.stop, [&](size_t k) {
      work(run[k]);
      if (counted_++ < 2 * (passes_.size() - first_)) execution_.progress.Advance(1);  // not what is tried
    });
  }
  /// A job of few passes spends its threads inside them.
  Execution Inner() const {
    const int threads = execution_.Threads();
    return {passes_.size() >= static_cast<size_t>(threads) ? 1 : threads, execution_.progress,
            execution_.stop, execution_.Memory()};
  }
  template <class Result>
  Result Kept(const char* stage, size_t pass, size_t direction, const PassResult& planned,
              const std::function<Result(const Stations&)>& make) const {
    return CachedInWorld<Result>(
        checkpoints_, fmt::format("{}-{}{}", stage, pass, direction == 0 ? "" : "-turned"),
        StageKey(prepared_.problem, options_, KeyOf(std::vector{planned}, 1)), prepared_.stations, make);
  }

  bool MayTurn(size_t i) const {
    const Pass& made = prepared_.made.toolpath.passes[i];
    return tried_[i] == 0 && FreeDirections(inputs_.job) && made.reversible &&
           !prepared_.external[i].Moves() && made.points.size() == prepared_.toolpath.passes[i].points.size();
  }

  /// Plans passes from their other end; those stay without that cannot be milled as well so.
  void PlanTurned(const std::vector<size_t>& run) {
    Toolpath made = prepared_.made.toolpath, placed = prepared_.toolpath;
    std::vector<std::vector<char>> points(passes_.size());
    std::vector<char> wanted(passes_.size(), 0);
    for (size_t i = 0; i < passes_.size(); ++i) points[i].assign(made.passes[i].points.size(), 0);
    for (const size_t i : run) {
      made.passes[i] = RunFromEnd(made.passes[i]);
      points[i].assign(made.passes[i].points.size(), 1);
      wanted[i] = tried_[i] = 1;
    }
    const Execution silent{execution_.threads, Silent(), execution_.stop, execution_.memory};
    SetEngagementOf(points, inputs_, prepared_.laying.mesh, silent, made);
    for (const size_t i : run) {
      Pass pass = made.passes[i];
      Transform(prepared_.stations.At(prepared_.external[i].from).world.cell().X_WP, pass);
      pass.rotation_reference = placed.passes[i].rotation_reference;
      placed.passes[i] = std::move(pass);
    }
    PlannedPasses planned =
        PlanPasses(prepared_.stations, {placed, prepared_.external, [&](size_t i) { return wanted[i] != 0; }},
                   options_.path, checkpoints_, silent);
    RepairEnds({prepared_.stations, placed, prepared_.external, "turned-ends"}, options_.path, options_.leave,
               checkpoints_, silent, planned.passes);
    for (const size_t i : run) {
      const PassResult &turned = planned.passes[i], &given = directions_[i][0]->planned;
      if (turned.pieces.size() != given.pieces.size() || CountSkipped(turned) > CountSkipped(given)) continue;
      directions_[i][1].emplace(
          FaceDirection{std::move(made.passes[i]), std::move(placed.passes[i]), turned, 0, {}});
    }
  }

  /// Turns the pass with the largest value as long as that makes it less; back again if the largest is not
  /// worth it in the end.
  void LowerLargest(const std::function<double(const FaceDirection&)>& value,
                    const std::function<void(size_t)>& work_out) {
    const std::vector<size_t> before = at_;
    const auto largest = [&] {
      size_t at = first_;
      for (size_t i = first_; i < passes_.size(); ++i)
        if (value(Now(i)) > value(Now(at))) at = i;
      return at;
    };
    if (first_ >= passes_.size()) return;
    const double first = value(Now(largest()));
    for (;;) {
      const size_t i = largest();
      if (value(Now(i)) <= options_.limit || !MayTurn(i)) break;
      PlanTurned({i});
      if (!directions_[i][1]) break;
      work_out(i);
      if (value(*directions_[i][1]) >= value(Now(i))) break;
      at_[i] = 1;
    }
    if (value(Now(largest())) > kWorthLowering * first) at_ = before;
  }

  /// Where passes exceed the limit, as interference or the search has it, the job leaves so much anyway:
  /// beneath that the sum of their marks counts again.
  void RaiseLimit() {
    const double before = options_.limit;
    std::vector<size_t> beyond;
    for (size_t i = first_; i < passes_.size(); ++i) {
      const double worst = WorstOf(*Now(i).face);
      if (worst > before * kSameHeight) beyond.push_back(i);
      options_.limit = std::max(options_.limit, worst);
    }
    Each(beyond, [&](size_t i) {
      FaceDirection& now = Now(i);
      PlannedFace again = Kept<PlannedFace>(
          "face-again", i, at_[i], now.planned,
          [&](const Stations& stations) { return PlanFace(stations, now.planned, options_, Inner()); });
      if (Holds(again) && MarksOf(again) < MarksOf(*now.face)) now.face = std::move(again);
    });
  }

  bool Holds(const PlannedFace& planned) const { return WorstOf(planned) <= options_.limit * kSameHeight; }

  /// Turns passes that leave marks and need not from their other end.
  void LowerMarks() {
    std::vector<size_t> run;
    for (size_t i = first_; i < passes_.size(); ++i)
      if (MayTurn(i) && MarksOf(*Now(i).face) > 0) run.push_back(i);
    if (run.empty()) return;
    PlanTurned(run);
    std::erase_if(run, [&](size_t i) { return !directions_[i][1]; });
    PlanAt(run, 1);
    for (const size_t i : run) {
      const PlannedFace& turned = *directions_[i][1]->face;
      if (Holds(turned) && MarksOf(turned) < kWorthTurning * MarksOf(*Now(i).face)) at_[i] = 1;
    }
  }

  std::vector<NeighbourPieces> FindNeighbours() const {
    std::vector<PassResult> given(passes_.size());
    for (size_t i = first_; i < passes_.size(); ++i) given[i] = directions_[i][0]->planned;
    return FindNeighbourPieces(given, first_, inputs_.cell.tool.cutter_diameter);
  }
  PassFace AsGiven(PassFace face, size_t direction) const {
    if (direction == 1) std::ranges::reverse(face);
    return face;
  }
  JobFace ValueAsItIs() {
    std::vector<PassFace> faces(passes_.size());
    for (size_t i = first_; i < passes_.size(); ++i) faces[i] = AsGiven(FaceOf(*Now(i).face), at_[i]);
    std::vector<const PassFace*> asked;
    for (const PassFace& face : faces) asked.push_back(&face);
    return ValueOf(asked, neighbours_);
  }

  /// All ways to mill pass `i`: the first ones as PlanFace has them.
  std::vector<FaceCandidateOfPass> CandidatesOf(size_t i) const {
    std::vector<FaceCandidateOfPass> candidates;
    if (i < first_) return {{}};
    for (size_t direction = 0; direction < 2; ++direction)
      if (const auto& of = directions_[i][direction])
        candidates.push_back({direction, {}, AsGiven(FaceOf(*of->face), direction)});
    for (size_t direction = 0; direction < 2; ++direction) {
      const auto& of = directions_[i][direction];
      if (!of) continue;
      for (FixedFace& fixed : Kept<std::vector<FixedFace>>(
               "face-fixed", i, direction, of->planned,
               [&](const Stations& at) { return FixedFacesOf(at, of->planned, options_, Inner()); }))
        candidates.push_back({direction, fixed.at, AsGiven(std::move(fixed.face), direction)});
    }
    return candidates;
  }

  /// The best of what those candidates make whose numbers are given, by pass; empty where some pass has none.
  std::vector<size_t> ChosenOf(const std::vector<std::vector<size_t>>& of) const {
    std::vector<std::vector<PassFace>> faces(of.size());
    for (size_t i = 0; i < of.size(); ++i)
      for (const size_t c : of[i]) faces[i].push_back(candidates_[i][c].face);
    std::vector<size_t> chosen = ChooseSequence(faces, neighbours_, options_.limit);
    for (size_t i = 0; i < chosen.size(); ++i) chosen[i] = of[i][chosen[i]];
    return chosen;
  }
  JobFace ValueOfChosen(const std::vector<size_t>& chosen) const {
    std::vector<const PassFace*> faces;
    for (size_t i = 0; i < chosen.size(); ++i) faces.push_back(&candidates_[i][chosen[i]].face);
    return ValueOf(faces, neighbours_);
  }

  /// Of each pass the candidates at one rotation.
  std::vector<std::vector<size_t>> AtPlace(int place) const {
    std::vector<std::vector<size_t>> at(candidates_.size());
    for (size_t i = 0; i < candidates_.size(); ++i)
      for (size_t c = 0; c < candidates_[i].size(); ++c)
        if (i < first_ || (candidates_[i][c].fixed && candidates_[i][c].fixed->place == place))
          at[i].push_back(c);
    return at;
  }

  /// Tries all passes from both ends and at fixed rotations, and takes the best sequence that is free, where
  /// one is better than what there is.
  void FindSequence(const JobFace& now) {
    std::vector<size_t> run;
    for (size_t i = first_; i < passes_.size(); ++i)
      if (MayTurn(i)) run.push_back(i);
    if (!run.empty()) PlanTurned(run);
    run.clear();
    for (size_t i = first_; i < passes_.size(); ++i)
      if (directions_[i][1] && !directions_[i][1]->face) run.push_back(i);
    PlanAt(run, 1);
    for (size_t i = first_; i < passes_.size(); ++i)
      if (!directions_[i][0]->face) PlanAt({i}, 0);
    candidates_.resize(passes_.size());
    ParallelFor(passes_.size(), execution_.Threads(), execution_.stop,
                [&](size_t i) { candidates_[i] = CandidatesOf(i); });
    std::set<int> places;
    for (const FaceCandidateOfPass& candidate : candidates_.back())
      if (candidate.fixed) places.insert(candidate.fixed->place);
    for (int round = 0; round < kSequences; ++round) {
      CheckStop(execution_.stop);
      std::vector<size_t> best;
      JobFace value = now;
      const auto take = [&](std::vector<size_t> chosen) {
        if (chosen.empty()) return;
        const JobFace other = ValueOfChosen(chosen);
        if (!IsBetter(other, value, options_.limit)) return;
        value = other;
        best = std::move(chosen);
      };
      take(ChosenOf(MixedCandidates(candidates_, now.Largest())));
      for (const int place : places) take(ChosenOf(AtPlace(place)));
      if (best.empty() || Take(best)) return;
    }
  }

  /// Puts a sequence in place, or takes the candidates out that are not free.
  bool Take(const std::vector<size_t>& chosen) {
    std::vector<std::optional<PlannedFace>> planned(passes_.size());
    ParallelFor(passes_.size() - first_, execution_.Threads(), execution_.stop, [&](size_t k) {
      const size_t i = first_ + k;
      const FaceCandidateOfPass& candidate = candidates_[i][chosen[i]];
      const FaceDirection& of = *directions_[i][candidate.direction];
      planned[i] = candidate.fixed
                       ? PlanFixedFace(prepared_.stations, of.planned, *candidate.fixed, options_, Inner())
                       : of.face;
    });
    bool free = true;
    for (size_t i = first_; i < passes_.size(); ++i) {
      if (planned[i]) continue;
      candidates_[i].erase(candidates_[i].begin() + static_cast<std::ptrdiff_t>(chosen[i]));
      free = false;
    }
    if (!free) return false;
    for (size_t i = first_; i < passes_.size(); ++i) {
      at_[i] = candidates_[i][chosen[i]].direction;
      Now(i).face = std::move(planned[i]);
    }
    return true;
  }

  /// The largest steps of pieces to those beside them.
  void SetSteps(FaceChoiceFigures FaceChoice::*at) {
    const auto figures = [&](size_t i, size_t piece) -> FaceChoiceFigures& {
      std::vector<FaceChoice>& choices = Now(i).face->choices;
      return choices[at_[i] == 0 ? piece : choices.size() - 1 - piece].*at;
    };
    for (const NeighbourPieces& pair : neighbours_) {
      FaceChoiceFigures &a = figures(pair.pass, pair.piece), &b = figures(pair.other_pass, pair.other_piece);
      if (a.count == 0 || b.count == 0) continue;
      const double step = std::abs(a.middle - b.middle);
      a.step = std::max(a.step, step);
      b.step = std::max(b.step, step);
    }
  }

  std::vector<FaceChoice> Finish() {
    SetSteps(&FaceChoice::before);
    SetSteps(&FaceChoice::after);
    std::vector<FaceChoice> all;
    size_t turned = 0;
    for (size_t i = first_; i < passes_.size(); ++i) {
      FaceDirection& now = Now(i);
      passes_[i] = std::move(now.face->pass);
      all.insert(all.end(), now.face->choices.begin(), now.face->choices.end());
      if (at_[i] == 0) continue;
      prepared_.made.toolpath.passes[i] = std::move(now.made);
      prepared_.toolpath.passes[i] = std::move(now.placed);
      prepared_.turned[i] = prepared_.turned[i] == 0 ? 1 : 0;
      ++turned;
    }
    execution_.progress.End(fmt::format(
        "{} of {} pieces moved, {} turned round",
        std::ranges::count_if(all, [](const FaceChoice& choice) { return choice.way != FaceWay::kPlanned; }),
        all.size(), CountedPasses(turned)));
    return all;
  }

  const JobInputs& inputs_;
  PreparedJob& prepared_;
  const CheckpointStore& checkpoints_;
  const Execution& execution_;
  std::vector<PassResult>& passes_;
  FacePlanOptions options_;
  size_t first_;
  std::atomic<size_t> counted_ = 0;
  std::vector<std::array<std::optional<FaceDirection>, 2>> directions_;  ///< as given; from the other end
  std::vector<size_t> at_;                                               ///< which of these
  std::vector<char> tried_;  ///< passes that were planned from their other end, if without success
  std::vector<NeighbourPieces> neighbours_;
  std::vector<std::vector<FaceCandidateOfPass>> candidates_;
};

}  // namespace

std::vector<FaceChoice> PlanFaces(const JobInputs& inputs, PreparedJob& prepared,
                                  const CheckpointStore& checkpoints, const Execution& execution,
                                  std::vector<PassResult>& passes) {
  if (!prepared.problem.objective->JudgesFace()) return {};
  return FacesOfJob(inputs, prepared, checkpoints, execution, passes).Plan();
}

}  // namespace millpose
