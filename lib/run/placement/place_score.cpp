// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_score.hpp"

#include <numeric>
#include <tuple>

#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "machine/collision/point_memory.hpp"
#include "machine/robot/make_pose.hpp"
#include "planning/ladder/branch_ladder.hpp"
#include "planning/links/retract.hpp"
#include "planning/pose/lean_problem.hpp"
#include "run/placement/sample.hpp"

namespace millpose {
namespace {

constexpr double kRotationStep = DegToRad(5);
constexpr size_t kPart = 8;  // passes that share a checker

/// A branch that may be the best: by what each point promises, or once it has a ladder by its best way.
struct OpenBranch {
  BranchScore bound;
  size_t branch = 0;
  std::optional<BranchLadder> ladder;

  /// The better first; of equal ones those that are not known well, then by number.
  static bool GoesBefore(const OpenBranch& a, const OpenBranch& b) {
    if (IsBetter(a.bound, b.bound) || IsBetter(b.bound, a.bound)) return IsBetter(a.bound, b.bound);
    return std::tuple(a.ladder.has_value(), a.branch) < std::tuple(b.ladder.has_value(), b.branch);
  }
};

/// What a pass is scored with.
struct PassScorer {
  const PoseProblem& problem;
  RetractOptions leave;
  Checker& checker;

  /// A pass stays on one branch: the one that is best for it, more free points first, then the least worst.
  /// Its ends must have room for the retract.
  std::vector<ScoredPoint> Score(const Pass& pass) const {
    std::vector<CandidateTable> tables;
    for (const MillingPoint& point : pass.points)
      tables.push_back(
          CandidateTable::OfStep(PointScorer(problem, point, pass.rotation_reference), kRotationStep));
    const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
    std::vector<PointMemory> memories(tables.size());
    const BranchLadder::Looks looks{[&](size_t t, const Joints& q, const FreedomValues& freedoms) {
                                      return !checker.Blocked(q, Phase::kCutting, freedoms, memories[t]);
                                    },
                                    [&](size_t t, const Joints& q) {
                                      const bool end = t == 0 || (!pass.closed && t + 1 == tables.size());
                                      return !end || CanLeave(checker, carrier, q, leave);
                                    }};
    std::vector<OpenBranch> open;
    for (const BranchScore& promise : PromisesOf(tables))
      open.push_back({promise, open.size(), std::nullopt});
    std::optional<BranchScore> best;
    while (!open.empty()) {
      const auto next = std::ranges::min_element(open, OpenBranch::GoesBefore);
      if (best && !IsBetter(next->bound, *best)) break;
      if (!next->ladder) {
        next->bound = next->ladder.emplace(problem.bounds, tables, next->branch).Bound();
        continue;
      }
      BranchScore score = next->ladder->Score(looks, best);
      if (!best || IsBetter(score, *best)) best = std::move(score);
      open.erase(next);
    }
    return best->points;
  }
};

OperationScore SumOf(const std::vector<ScoredPoint>& points) {
  OperationScore score;
  for (const ScoredPoint& point : points) {
    ++score.points[static_cast<size_t>(point.obstacle)];
    if (point.obstacle != Infeasibility::kNone) continue;
    score.worst = std::max(score.worst, point.objective);
    score.mean += point.objective;
  }
  if (const size_t free = score.points.front(); free > 0) score.mean /= static_cast<double>(free);
  return score;
}

/// The cell's bodies that stand still, and those to keep out of.
Cell StandingBodies(const JobInputs& inputs, const Cell& cell) {
  Cell standing = cell;
  standing.excluded_pairs.clear();
  std::erase_if(standing.bodies, [](const Body& body) {
    return body.mount == Mount::kTool || (body.mount == Mount::kLink && body.link > 0);
  });
  for (const KeepOutSettings& keep_out : inputs.job.placement->keep_out)
    standing.bodies.push_back(MakeKeepOut(keep_out, inputs.keep_out_bytes));
  return standing;
}

}  // namespace

size_t PlaceScore::total() const {
  size_t count = 0;
  for (const OperationScore& score : operations)
    count += std::accumulate(score.points.begin(), score.points.end(), size_t{0});
  return count;
}

size_t PlaceScore::free() const { return Count(Infeasibility::kNone); }

size_t PlaceScore::Count(Infeasibility obstacle) const {
  size_t count = 0;
  for (const OperationScore& score : operations) count += score.points[static_cast<size_t>(obstacle)];
  return count;
}

PlaceScorer::PlaceScorer(const std::vector<JobInputs>& inputs, const Execution& execution) : inputs_(inputs) {
  count_ = static_cast<size_t>(inputs.front().job.placement->points);
  for (const JobInputs& own : inputs) {
    prepared_.push_back(PrepareJob(own, NoCheckpoints{}, execution));
    samples_.push_back(millpose::SampleOf(prepared_.back().made.toolpath, count_));
  }
  standing_.emplace(StandingBodies(inputs.front(), prepared_.front().cell));
  for (const std::string& name : standing_->TouchedBy(Mover()))
    if (std::ranges::none_of(inputs.front().job.placement->keep_out,
                             [&](const KeepOutSettings& body) { return body.name == name; }))
      stands_on_.push_back(name);
}

bool PlaceScorer::robot() const { return inputs_.front().job.placement->moves == PlaceMoves::kRobot; }

Mount PlaceScorer::Mover() const { return robot() ? Mount::kLink : Mount::kWorkpiece; }

std::pair<Pose, Pose> PlaceScorer::PosesAt(const PoseSettings& place, size_t operation) const {
  const Cell& cell = prepared_[operation].cell;
  if (robot()) {
    const Pose X_SB = MakePose(inputs_.front().cell.stated_base).inverse(Eigen::Isometry) * cell.X_WB;
    return {MakePose(place) * X_SB, cell.X_WP};
  }
  WorkpieceSettings settings = inputs_.front().job.workpiece;
  settings.pose = place;
  return {cell.X_WB, MakeWorkpiecePose(settings, cell.X_WB)};
}

std::string PlaceScorer::Touches(const Pose& X_WB, const Pose& X_WP) const {
  for (const std::string& name : standing_->With(X_WB, X_WP).TouchedBy(Mover()))
    if (std::ranges::find(stands_on_, name) == stands_on_.end()) return name;
  return "";
}

std::vector<ScoredPoint> PlaceScorer::ScorePoints(size_t operation, const Toolpath& sample,
                                                  const World& world, const Execution& execution) const {
  const PreparedJob& prepared = prepared_[operation];
  const Toolpath placed = PlacedToolpath(inputs_[operation], sample, world.cell().X_WP);
  PoseProblem problem = AtOwnAxis(prepared.problem);
  problem.X_WB = world.cell().X_WB;
  const RetractOptions leave = MakeLinkMoveOptions(inputs_[operation].job).leave;
  std::vector<std::vector<ScoredPoint>> passes(placed.passes.size());
  const size_t parts = (passes.size() + kPart - 1) / kPart;
  ParallelFor(parts, execution.Threads(), execution.stop, [&](size_t part) {
    Checker checker(world);
    for (size_t i = part * kPart; i < std::min(passes.size(), (part + 1) * kPart); ++i)
      passes[i] = PassScorer{problem, leave, checker}.Score(placed.passes[i]);
  });
  std::vector<ScoredPoint> points;
  for (const std::vector<ScoredPoint>& pass : passes) points.insert(points.end(), pass.begin(), pass.end());
  return points;
}

Samples PlaceScorer::SampleOf(const PathSection& share) const {
  Samples samples;
  for (const PreparedJob& prepared : prepared_)
    samples.push_back(millpose::SampleOf(Shared(prepared.made.toolpath, share), count_));
  return samples;
}

std::vector<ScoredPoint> PlaceScorer::Points(const PoseSettings& place, const Execution& execution) const {
  const auto [X_WB, X_WP] = PosesAt(place, 0);
  const World world = prepared_.front().world.With(X_WB, X_WP);
  if (!Touches(X_WB, X_WP).empty() || Checker(world).Blocked(world.cell().home, Phase::kFree))
    return std::vector<ScoredPoint>(CountPoints(samples_.front()),
                                    ScoredPoint{Infeasibility::kInterference, 0});
  return ScorePoints(0, samples_.front(), world, execution);
}

PlaceScore PlaceScorer::Score(const PoseSettings& place, const Samples& samples,
                              const Execution& execution) const {
  PlaceScore score;
  score.place = place;
  for (size_t i = 0; i < prepared_.size() && score.touches.empty(); ++i)
    score.touches = std::apply([&](const Pose& X_WB, const Pose& X_WP) { return Touches(X_WB, X_WP); },
                               PosesAt(place, i));
  score.operations.resize(prepared_.size());
  for (size_t i = 0; i < prepared_.size(); ++i) {
    const auto [X_WB, X_WP] = PosesAt(place, i);
    const World world = prepared_[i].world.With(X_WB, X_WP);
    if (score.touches.empty() && Checker(world).Blocked(world.cell().home, Phase::kFree))
      score.touches = "home";
    if (!score.touches.empty()) {  // not looked at any further
      score.operations[i].points[static_cast<size_t>(Infeasibility::kInterference)] = CountPoints(samples[i]);
      continue;
    }
    score.operations[i] = SumOf(ScorePoints(i, samples[i], world, execution));
  }
  return score;
}

}  // namespace millpose
