// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/free_smoothing.hpp"

#include "planning/pass/cut_check.hpp"
#include "tests/planning/pass/rough_row.hpp"

namespace millpose {
namespace {

constexpr double kResolution = 0.5;
constexpr double kFeeler = 400;  // mm from the tool's axis

/// A row whose path swerves, in the steps of a grid, by 10° and back: a feeler on the tool, beside its axis
/// in the direction of the row, is lifted by 70 mm.
struct Swerve {
  RoughRow row{
      60, 10, [](int t) { return DegToRad(std::round(std::clamp(12 - 1.3 * std::abs(t - 30), 0.0, 10.0))); }};
  Carrier carrier{row.problem.arm, row.problem.X_WB, row.problem.X_FT};
  Cell cell;
  Body feeler{.name = "feeler", .body_class = BodyClass::kSpindle, .mount = Mount::kTool, .shape = Sphere{2}};

  Swerve() {
    cell.arm = row.problem.arm, cell.X_WB = row.problem.X_WB, cell.X_FT = row.problem.X_FT;
    cell.clearances = {1, 1};
    const Eigen::Vector3d along = (row.points[1].position - row.points[0].position).normalized();
    feeler.X_MG.translation() = kFeeler * (carrier.ToolPose(row.path[0].q).linear().transpose() * along);
    cell.bodies = {feeler};
  }
  /// A ball where the feeler of point `t` would be with its rotation less by `less`.
  void AddBall(size_t t, double less, double radius) {
    Body ball{.name = fmt::format("ball at {}", t),
              .body_class = BodyClass::kFixture,
              .mount = Mount::kWorld,
              .shape = Sphere{radius}};
    const Candidate there = row.scorers[t].ScoreOne({row.path[t].freedoms[0] - less}, row.path[t].branch);
    EXPECT_EQ(there.obstacle, Infeasibility::kNone);
    ball.X_MG.translation() = carrier.ToolPose(there.q) * feeler.X_MG.translation();
    cell.bodies.push_back(ball);
  }

  SmoothOptions Options() const {
    SmoothOptions options = row.Options();
    options.loss = 0.1;
    return options;
  }
  /// Smoothed without looking.
  std::vector<PathNode> Blind() const {
    std::vector<PathNode> path = row.path;
    SmoothPath(row.scorers, row.points, row.ranges, Options(), path);
    return path;
  }
  /// By a checker of its own, motion by motion.
  bool Free(const World& world, std::span<const PathNode> path) const {
    Checker checker(world);
    for (size_t t = 0; t + 1 < path.size(); ++t) {
      if (checker.At(path[t].q, Phase::kCutting)) return false;
      if (CheckCut(checker, carrier, path[t].q, path[t + 1].q, kResolution)) return false;
    }
    return !checker.At(path.back().q, Phase::kCutting);
  }
  double Rms(const std::vector<PathNode>& path) {
    std::vector<PathNode> kept = std::exchange(row.path, path);
    const double rms = row.Rms();
    row.path = std::move(kept);
    return rms;
  }
};

/// Without looking smoothing meets the balls; with looking it goes round them, on the side of the path.
void ExpectGoesRound(Swerve& swerve, double less) {
  const World world(swerve.cell);
  ASSERT_TRUE(swerve.Free(world, swerve.row.path));
  ASSERT_FALSE(swerve.Free(world, swerve.Blind()));
  std::vector<PathNode> path = swerve.row.path;
  std::vector<std::shared_ptr<PointVerdicts>> known;
  for (size_t i = 0; i < path.size(); ++i) known.push_back(std::make_shared<PointVerdicts>());
  SegmentChecker checker({world, swerve.carrier, kResolution, true, 2, {}}, known, {});
  SmoothFree(swerve.row.scorers, swerve.row.points, swerve.Options(), checker, path);
  EXPECT_TRUE(swerve.Free(world, path));
  EXPECT_GT(path[30].freedoms[0], swerve.row.path[30].freedoms[0] - less);
  EXPECT_LT(swerve.Rms(path), 0.5 * swerve.row.Rms());
  double objective = 0;
  for (const PathNode& node : path) objective += node.objective;
  EXPECT_LE(objective, 1.1 * swerve.row.Objective());
}

TEST(SmoothFree, KeepsOffWhatThePathWentRound) {
  Swerve swerve;
  const double less = swerve.row.path[30].freedoms[0] - swerve.Blind()[30].freedoms[0];
  ASSERT_GT(less, DegToRad(1));
  swerve.AddBall(30, less, 0.6 * less * kFeeler - 3);  // reaches 60 % of the way up to the path
  ExpectGoesRound(swerve, less);
}

TEST(SmoothFree, DoesNotPassThroughWhatIsThin) {
  // A rail below the whole path: what is beyond it is free again.
  Swerve swerve;
  for (size_t t = 0; t < swerve.row.path.size(); ++t) swerve.AddBall(t, DegToRad(2), 3);
  ExpectGoesRound(swerve, DegToRad(2));
}

TEST(SmoothFree, IsSmoothPathWhereNothingIsInTheWay) {
  Swerve swerve;
  const World world(swerve.cell);
  const std::vector<PathNode> blind = swerve.Blind();
  std::vector<PathNode> path = swerve.row.path;
  std::vector<std::shared_ptr<PointVerdicts>> known;
  for (size_t i = 0; i < path.size(); ++i) known.push_back(std::make_shared<PointVerdicts>());
  SegmentChecker checker({world, swerve.carrier, kResolution, true, 2, {}}, known, {});
  SmoothFree(swerve.row.scorers, swerve.row.points, swerve.Options(), checker, path);
  EXPECT_LE(swerve.Rms(path), swerve.Rms(blind));  // it may be run again
  EXPECT_GT(swerve.Rms(path), 0.9 * swerve.Rms(blind));
  SmoothOptions off = swerve.Options();
  off.loss = 0;
  path = swerve.row.path;
  SmoothFree(swerve.row.scorers, swerve.row.points, off, checker, path);
  for (size_t t = 0; t < path.size(); ++t) EXPECT_EQ(path[t].q, swerve.row.path[t].q);
}

}  // namespace
}  // namespace millpose
