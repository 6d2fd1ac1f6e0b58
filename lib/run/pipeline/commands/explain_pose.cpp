// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/explain_pose.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/assemble.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/station.hpp"
#include "planning/result/verdict_map.hpp"
#include "report/html_columns.hpp"
#include "report/samples/axis_map.hpp"
#include "report/samples/sample_curves.hpp"
#include "run/pipeline/outputs/write_results.hpp"
#include "run/pipeline/programs/make_programs.hpp"
#include "store/read_whole.hpp"
#include "toolpath/lean_law.hpp"

namespace millpose {
namespace {

constexpr int kFollow = 2;  // cells that a pose may move to either side from one point to the next
constexpr double kTogether = 2 * kAxisStep;  // rad: the path is there

double ShortWayTo(double from, double to) {
  const double way = to - from;
  return way - 2 * kPi * std::floor(way / (2 * kPi) + 0.5);
}

/// A pass, and what its points are planned in.
struct PassOfPlan {
  const Stations& stations;
  const PlanResult& plan;
  const PassResult& pass;

  const PoseProblem& ProblemAt(size_t point) const { return stations.At(ExternalAt(pass, point)).problem; }
  Eigen::Vector3d OnPart(size_t point) const {
    return OnPartAtZero(plan, ExternalAt(pass, point), pass.points[point].point.position);
  }
};

/// All candidates of a point on the rotations of CurveGrid; index 8·rotation + branch.
std::vector<Candidate> Candidates(const PoseProblem& problem, const PassResult& pass, size_t point) {
  const RotationGrid grid = CurveGrid();
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < grid.count; ++i) rotations.push_back({grid.first + i * grid.step});
  std::vector<Candidate> candidates(8 * rotations.size());
  PointScorer(problem, pass.points[point].point, pass.rotation_reference).Score(rotations, candidates);
  return candidates;
}

double RotationOf(int cell) { return CurveGrid().first + cell * CurveGrid().step; }

/// The stiffest pose of all that the bounds alone forbid.
std::optional<ForbiddenPose> Forbidden(const PoseProblem& problem, const PassResult& pass, size_t point) {
  const std::vector<Candidate> bounded = Candidates(problem, pass, point),
                               free = Candidates(WithoutBounds(problem), pass, point);
  std::optional<ForbiddenPose> stiffest;
  for (size_t i = 0; i < free.size(); ++i) {
    if (free[i].obstacle != Infeasibility::kNone) continue;
    if (bounded[i].obstacle == Infeasibility::kNone) continue;
    if (stiffest && free[i].objective >= stiffest->pose.objective) continue;
    stiffest = {{RotationOf(static_cast<int>(i / 8)), static_cast<int>(i % 8), free[i].objective}, -1, 0};
    if (bounded[i].obstacle != Infeasibility::kLimit) continue;
    const BeyondLimit beyond = FarthestBeyond(problem.bounds, bounded[i].q);
    stiffest->joint = beyond.joint;
    stiffest->beyond = beyond.by;
  }
  return stiffest;
}

/// From a point's own optimum to the nearest pose on its branch that is known to be free; 0 where none is.
double BeyondTouch(const PlannedPoint& point) {
  double nearest = 2 * kPi;
  const AxisVerdicts verdicts = UnpackVerdicts(point.verdicts);
  for (int i = 0; i < kAxisRotations; ++i)
    if (verdicts[static_cast<size_t>(point.own_branch) * kAxisRotations + static_cast<size_t>(i)] ==
        kVerdictFree)
      nearest = std::min(nearest, std::abs(ShortWayTo(point.own_rotation, RotationOf(i))));
  if (point.free_branch == point.own_branch)
    nearest = std::min(nearest, std::abs(ShortWayTo(point.own_rotation, point.free_rotation)));
  return nearest < 2 * kPi ? nearest : 0;
}

/// What bars a cell of a branch; empty where nothing is known to.
std::string WhatBars(const PoseProblem& problem, const PassResult& pass, const AxisVerdicts& verdicts,
                     const Candidate& candidate, int branch, int cell) {
  switch (candidate.obstacle) {
    case Infeasibility::kUnreachable:
      return "then out of reach";
    case Infeasibility::kSingular:
      return "then singular";
    case Infeasibility::kLimit:
      return fmt::format("then axis {} is beyond its limit",
                         FarthestBeyond(problem.bounds, candidate.q).joint + 1);
    default:  // admissible: the other obstacles are known of points alone
      break;
  }
  const int verdict = verdicts[static_cast<size_t>(branch) * kAxisRotations + static_cast<size_t>(cell)];
  if (verdict < kVerdictPair) return {};
  return fmt::format("then {} come too near", pass.pairs.at(static_cast<size_t>(verdict - kVerdictPair)));
}

/// Follows a point's best free pose one way along its piece.
class Follower {
 public:
  Follower(const PassOfPlan& in, size_t point)
      : in_(in), pass_(in.pass), start_(point), branch_(pass_.points[point].free_branch) {}

  /// mm; what ends it, empty for the end of the piece.
  std::pair<double, std::string> Follow(int direction) const {
    const Segment& piece = pass_.pieces[static_cast<size_t>(pass_.points[start_].piece)];
    int cell = AxisCellOf(pass_.points[start_].free_rotation).index;
    double length = 0;
    for (int t = static_cast<int>(start_) + direction; t >= piece.first && t <= piece.last; t += direction) {
      const auto at = static_cast<size_t>(t);
      std::string obstacle;
      const std::optional<int> next = Next(at, cell, obstacle);
      if (!next) return {length, obstacle};
      cell = *next;
      length += (in_.OnPart(at) - in_.OnPart(at - static_cast<size_t>(direction))).norm();
      const PlannedPoint& planned = pass_.points[at];
      if (planned.branch == branch_ &&
          std::abs(ShortWayTo(RotationOf(cell), planned.freedoms[0])) < kTogether)
        return {length, "then it meets the path"};
    }
    return {length, {}};
  }

 private:
  /// The least open cell near `cell`, else what bars that.
  std::optional<int> Next(size_t at, int cell, std::string& obstacle) const {
    const PoseProblem& problem = in_.ProblemAt(at);
    const std::vector<Candidate> candidates = Candidates(problem, pass_, at);
    const AxisVerdicts verdicts = UnpackVerdicts(pass_.points[at].verdicts);
    std::optional<int> best;
    for (const int step : {0, -1, 1, -2, 2}) {
      static_assert(kFollow == 2);
      const int k = (cell + step + kAxisRotations) % kAxisRotations;
      const Candidate& candidate =
          candidates[size_t{8} * static_cast<size_t>(k) + static_cast<size_t>(branch_)];
      const std::string bars = WhatBars(problem, pass_, verdicts, candidate, branch_, k);
      if (step == 0) obstacle = bars;
      if (!bars.empty()) continue;
      if (!best ||
          candidate.objective <
              candidates[size_t{8} * static_cast<size_t>(*best) + static_cast<size_t>(branch_)].objective)
        best = k;
    }
    return best;
  }

  const PassOfPlan& in_;
  const PassResult& pass_;
  size_t start_;
  int branch_;
};

FollowedStretch StretchOf(const PassOfPlan& in, size_t point) {
  const Follower follower(in, point);
  const auto back = follower.Follow(-1), on = follower.Follow(1);
  FollowedStretch stretch{back.first + on.first, back.second.empty() && on.second.empty(), {}};
  stretch.obstacle = on.second.empty() ? back.second : on.second;
  return stretch;
}

}  // namespace

PoseReason ExplainPose(const PlanResult& plan, const Stations& stations, size_t pass_number, size_t number) {
  const PassResult& pass = plan.passes[pass_number];
  const PassOfPlan in{stations, plan, pass};
  const PlannedPoint& point = pass.points[number];
  PoseReason reason;
  if (point.skip != Infeasibility::kNone) {
    reason.skipped = ToString(point.skip) + ": " + point.detail;
    return reason;
  }
  const double scale = ShownScale(plan.objective_unit);
  reason.unit = ShownUnit(plan.objective_unit);
  reason.path = {point.freedoms[0], point.branch, scale * point.objective};
  reason.free = {point.free_rotation, point.free_branch, scale * point.free_optimum};
  reason.own = reason.free;
  if (point.own_branch >= 0) reason.own = {point.own_rotation, point.own_branch, scale * point.own_optimum};
  reason.unsmoothed = scale * point.unsmoothed;
  if (point.barred >= 0) {
    reason.barred = pass.pairs.at(static_cast<size_t>(point.barred));
    reason.beyond = BeyondTouch(point);
  }
  const bool leans = point.freedoms.size() > 1;
  if (leans) {
    const Leans lean = LeansOf(point.point.tool_axis, point.point.normal, point.point.feed);
    reason.lean = std::array{lean.lead, lean.tilt};
  }
  reason.forbidden = Forbidden(in.ProblemAt(number), pass, number);
  if (reason.forbidden) reason.forbidden->pose.objective *= scale;
  if (point.free_branch == point.branch && !leans) reason.stretch = StretchOf(in, number);
  return reason;
}

PointStory TellPoint(const std::filesystem::path& folder, size_t number) {
  const JobSettings job = ParseJob(ReadFile(folder / "job.yaml"), (folder / "job.yaml").string());
  CellSettings cell = ParseCell(ReadFile(folder / "cell.yaml"), (folder / "cell.yaml").string());
  SelectTool(job.tool, &cell);
  cell.bodies.clear();  // the objective knows no bodies
  const Cell bare = MakeCell(cell, {});
  const Stations stations(World(bare), AtOwnAxis(MakePoseProblem(job, cell, bare)));
  const PlanResult plan = ReadPlanIn(folder, FileRoot());
  size_t pass = 0, point = number;
  while (pass < plan.passes.size() && point >= plan.passes[pass].points.size())
    point -= plan.passes[pass++].points.size();
  if (pass == plan.passes.size())
    throw InputError({(folder / kPlanFile).string()}, fmt::format("holds no point {}", number));
  const PoseProblem& problem = stations.At(ExternalAt(plan.passes[pass], point)).problem;
  PointStory story;
  const std::vector<Candidate> candidates = Candidates(problem, plan.passes[pass], point);
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].obstacle == Infeasibility::kNone)
      story.curve.push_back(
          {RotationOf(static_cast<int>(i / 8)), static_cast<int>(i % 8), candidates[i].objective});
  story.reasons = ReasonSentences(ExplainPose(plan, stations, pass, point));
  if (const std::optional<ToolUncertainty> tool = UncertaintyOf(cell.tool))
    story.steps = FindPoseStepsAt(plan, *tool, FinishedFrom(job, plan.passes.size()), number);
  return story;
}

}  // namespace millpose
