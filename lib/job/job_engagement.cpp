// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/job_engagement.hpp"

#include "job/engagement_options.hpp"
#include "job/lean_freedoms.hpp"
#include "planning/result/skipped.hpp"
#include "planning/result/station.hpp"
#include "toolpath/engagement/entries.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

bool Drills(const JobInputs& inputs) { return inputs.job.toolpath.strategy->DrillPoint().has_value(); }

/// Whether what the cutter meets follows from what the path has left: neither stated, nor that of a hole.
bool FollowsFromPath(const JobInputs& inputs) {
  return inputs.job.cutting && !inputs.job.cutting->side && !Drills(inputs);
}

}  // namespace

std::optional<CuttingForce> SetJobEngagement(const JobInputs& inputs, const Mesh& mesh,
                                             const Execution& execution, Toolpath& toolpath) {
  if (!inputs.job.cutting) return std::nullopt;
  const EngagementOptions options = MakeEngagementOptions(inputs, mesh);
  SetEngagement(options, execution.Threads(), execution.stop, toolpath);
  return HeaviestCut(options, toolpath);
}

void SetEngagementOf(const std::vector<std::vector<char>>& of, const JobInputs& inputs, const Mesh& mesh,
                     const Execution& execution, Toolpath& toolpath) {
  if (!inputs.job.cutting) return;
  SetEngagement(MakeEngagementOptions(inputs, mesh), execution.Threads(), execution.stop, toolpath, of);
}

namespace {

/// Brings the points of a pass to P, or back to W, where each of them has the part then.
void Move(const PlanResult& plan, const PassResult& planned, bool to_part, Pass& pass) {
  const auto motion = [&](const ExternalPosition& external) {
    const Pose X_WP = PartAt(plan, external);
    return to_part ? X_WP.inverse() : X_WP;
  };
  if (!MovesAlong(planned)) return Transform(motion(planned.external), pass);
  for (size_t i = 0; i < pass.points.size(); ++i) {
    Pass single;
    single.points = {pass.points[i]};
    Transform(motion(ExternalAt(planned, i)), single);
    pass.points[i] = std::move(single.points.front());
  }
}

/// The passes of a plan, in P, as if all their points were milled.
Toolpath Milled(const JobInputs& inputs, const PlanResult& plan) {
  Toolpath milled;
  for (const PassResult& pass : plan.passes) {
    Pass& own = milled.passes.emplace_back();
    for (const PlannedPoint& planned : pass.points) {
      own.points.push_back(AsLaid(inputs, planned.point));
      own.points.back().gouge = 0;
    }
    own.closed = pass.pieces.size() == 1 && pass.pieces.front().closed;
    Move(plan, pass, true, own);
  }
  return milled;
}

/// What is skipped takes nothing off.
Toolpath WithoutSkipped(const PlanResult& plan, Toolpath milled) {
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t t = 0; t < plan.passes[p].points.size(); ++t)
      if (plan.passes[p].points[t].skip != Infeasibility::kNone) milled.passes[p].points[t].gouge = 1;
  return milled;
}

/// Whether two paths without missing points take the same off.
bool CutAlike(const Toolpath& a, const Toolpath& b) {
  const auto points = [](const MillingPoint& x, const MillingPoint& y) {
    return IsSamePlace(x, y) && x.feed == y.feed && x.feed_rate == y.feed_rate;
  };
  return std::ranges::equal(a.passes, b.passes, [&](const Pass& x, const Pass& y) {
    return x.closed == y.closed && std::ranges::equal(x.points, y.points, points);
  });
}

size_t CountSkipped(const PlanResult& plan) {
  size_t count = 0;
  for (const PassResult& pass : plan.passes) count += CountSkipped(pass);
  return count;
}

/// The largest cut of a job.
struct Largest {
  double width = 0, depth = 0;  ///< mm

  explicit Largest(const Toolpath& milled) {
    for (const Pass& pass : milled.passes)
      for (const MillingPoint& point : pass.points) {
        width = std::max(width, point.engagement.width);
        depth = std::max(depth, point.engagement.depth);
      }
  }
  /// By how much a cut exceeds it, a share.
  double Excess(const Engagement& cut) const {
    return std::max(width > 0 ? cut.width / width : 0, depth > 0 ? cut.depth / depth : 0) - 1;
  }
};

/// Where the cutter would take too much off, and because of what.
class MissingMaterial {
 public:
  MissingMaterial(const PlanResult& plan, const Toolpath& now, const Largest& largest)
      : plan_(plan), now_(now), largest_(largest) {}

  /// Why a piece takes too much off; empty where it does not.
  std::string Why(size_t pass, const Segment& piece) const {
    constexpr double kMore = 0.2;
    const std::vector<MillingPoint>& points = now_.passes[pass].points;
    const MillingPoint* worst = nullptr;
    for (auto t = static_cast<size_t>(piece.first); t <= static_cast<size_t>(piece.last); ++t) {
      const MillingPoint& point = points[t];
      if (point.kind != PointKind::kCut || largest_.Excess(point.engagement) <= kMore) continue;
      if (!worst || largest_.Excess(point.engagement) > largest_.Excess(worst->engagement)) worst = &point;
    }
    if (!worst) return "";
    return fmt::format(
        "the cut would be {:.2f} mm wide and {:.2f} mm deep next to the material that {} leaves; the job's "
        "own cuts are at most {:.2f} and {:.2f} mm (path.over_missing: leave_out)",
        worst->engagement.width, worst->engagement.depth, NearestMissing(worst->position), largest_.width,
        largest_.depth);
  }

 private:
  std::string NearestMissing(const Eigen::Vector3d& place) const {
    double nearest = std::numeric_limits<double>::infinity();
    std::string name;
    size_t number = 0;
    for (size_t p = 0; p < plan_.passes.size(); ++p)
      for (size_t t = 0; t < plan_.passes[p].points.size(); ++t, ++number) {
        const PlannedPoint& planned = plan_.passes[p].points[t];
        const double distance = (now_.passes[p].points[t].position - place).norm();
        if (planned.skip == Infeasibility::kNone || distance >= nearest) continue;
        nearest = distance;
        name = fmt::format("point {} (pass {}, {})", number, plan_.passes[p].pass, ToString(planned.skip));
      }
    return name;
  }

  const PlanResult& plan_;
  const Toolpath& now_;
  const Largest& largest_;
};

}  // namespace

const Toolpath& MissingCuts::Whole(const EngagementOptions& options, const PlanResult& plan) {
  Toolpath whole = Milled(inputs_, plan);
  if (!whole_ || !CutAlike(*whole_, whole)) {
    SetEngagement(options, execution_.Threads(), execution_.stop, whole);
    whole_ = std::move(whole);
  }
  return *whole_;
}

Toolpath MissingCuts::Now(const EngagementOptions& options, const PlanResult& plan) {
  Toolpath now = WithoutSkipped(plan, Whole(options, plan));
  SetEngagementBesideMissing(options, execution_.Threads(), execution_.stop, now);
  return now;
}

size_t MissingCuts::LeaveOut(PlanResult& plan) {
  if (!FollowsFromPath(inputs_) || inputs_.job.over_missing == OverMissing::kCut) return 0;
  if (CountSkipped(plan) == 0) return 0;
  const EngagementOptions options = MakeEngagementOptions(inputs_, mesh_);
  const Largest largest(Whole(options, plan));
  size_t left_out = 0;
  for (;;) {
    const Toolpath now = Now(options, plan);
    const MissingMaterial missing(plan, now, largest);
    std::vector<std::tuple<size_t, int, std::string>> pieces;
    for (size_t p = 0; p < plan.passes.size(); ++p)
      for (const Segment& piece : plan.passes[p].pieces)
        if (std::string why = missing.Why(p, piece); !why.empty())
          pieces.emplace_back(p, piece.piece, std::move(why));
    if (pieces.empty()) return left_out;
    // From the last to the first: leaving one out renumbers those after it in its pass.
    for (auto at = pieces.rbegin(); at != pieces.rend(); ++at)
      millpose::LeaveOut(plan.passes[std::get<0>(*at)], std::get<1>(*at), Infeasibility::kOverMissing,
                         std::get<2>(*at));
    left_out += pieces.size();
  }
}

std::string MissingCuts::Count(PlanResult& plan) {
  constexpr double kMore = 1.2;  // times the force that was planned for: worth telling
  if (!inputs_.job.cutting || Drills(inputs_)) return "";
  const size_t skipped = CountSkipped(plan);
  if (skipped == 0) return "";
  Toolpath milled = Now(MakeEngagementOptions(inputs_, mesh_), plan);
  for (size_t p = 0; p < plan.passes.size(); ++p) Move(plan, plan.passes[p], false, milled.passes[p]);
  size_t more = 0, over = 0;
  double most = 0;
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t t = 0; t < plan.passes[p].points.size(); ++t) {
      PlannedPoint& point = plan.passes[p].points[t];
      over += point.skip == Infeasibility::kOverMissing;
      Engagement& planned = point.point.engagement;
      const Engagement& now = milled.passes[p].points[t].engagement;
      const double before = planned.force.norm(), after = now.force.norm();
      if (after > kMore * before) ++more, most = std::max(most, after);
      planned = now;
    }
  std::string text;
  if (over > 0)
    text = fmt::format(
        "{} points leave material, {} more are left out because the cutter would meet it there "
        "(path.over_missing); mill the former first, whatever is to be milled later",
        skipped - over, over);
  if (more == 0) return text;
  return fmt::format(
      "{}{} points are skipped, and the material that they leave is cut at {} others, where the mean "
      "force is more than 20 % above the one that poses were chosen for (up to {:.0f} N); see "
      "deflection.csv",
      text.empty() ? "" : text + "; ", skipped, more, most);
}

std::string EntriesOnMaterial(const JobInputs& inputs, const Mesh& mesh, const PlanResult& plan) {
  if (!FollowsFromPath(inputs) || inputs.cell.tool.centre_cutting) return "";
  std::vector<size_t> entries;
  std::vector<int> passes;
  size_t number = 0;
  for (const PassResult& pass : plan.passes) {
    for (const Segment& piece : pass.pieces) {
      auto first = static_cast<size_t>(piece.first);
      while (pass.points[first].skip != Infeasibility::kNone) ++first;
      entries.push_back(number + first);
      passes.push_back(pass.pass);
    }
    number += pass.points.size();
  }
  const std::vector<char> meets =
      MeetsMaterial(MakeEngagementOptions(inputs, mesh), WithoutSkipped(plan, Milled(inputs, plan)), entries);
  const auto count = std::ranges::count(meets, 1);
  if (count == 0) return "";
  const auto worst = static_cast<size_t>(std::ranges::find(meets, 1) - meets.begin());
  return fmt::format(
      "the tool comes straight down on material at {} of {} entries, first at point {} (pass {}), and "
      "tool.cutter does not say centre_cutting: enter along the pass (toolpath.ends.lead: along) or from "
      "outside the part (toolpath.ends.overrun_mm)",
      count, entries.size(), entries[worst], passes[worst]);
}

}  // namespace millpose
