// SPDX-License-Identifier: GPL-3.0-or-later
// Passes along which external axes move.
#include "base/value_bytes.hpp"
#include "machine/motion/line.hpp"
#include "planning/external/external_course.hpp"
#include "tests/planning/pass/pass_problem.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

/// A rail across that carries the robot, and a table that carries the part.
Cell RailAndTable(Cell cell) {
  cell.external_axes.resize(2);
  ExternalAxis &rail = cell.external_axes[0], &table = cell.external_axes[1];
  rail.direction = Eigen::Vector3d(0, 1, 0);
  rail.lower = -1000, rail.upper = 1000, rail.speed = 500;
  rail.compliance = 1e-6;
  table.kind = AxisKind::kRotary;
  table.carries = Carries::kWorkpiece;
  table.direction = Eigen::Vector3d::UnitZ();
  table.origin = {2600, 0, 0};
  table.lower = -3, table.upper = 3, table.speed = 0.5;
  return cell;
}

struct Coordinated {
  Stations stations;
  ExternalCourse course;
  Pass on_part;                             ///< in P, which is W with all axes at 0
  std::vector<ExternalPosition> positions;  ///< of its points
  Pass pass;                                ///< in W, each point at its own

  Coordinated(const PoseProblem& problem, const Cell& cell, ExternalCourse along, Pass of)
      : stations(World(cell), problem), course(std::move(along)), on_part(EndingWhereItBegan(std::move(of))) {
    positions = PositionsAlong(course, on_part);
    pass = on_part;
    for (size_t t = 0; t < positions.size(); ++t) {
      Pass one;
      one.points = {on_part.points[t]};
      Transform(Mechanism(cell.external_axes).Moved(Carries::kWorkpiece, positions[t]), one);
      pass.points[t] = one.points.front();
    }
  }
  PassResult Plan(const PathOptions& options, int threads = 2) const {
    return PlanPass({stations, positions}, {pass}, options, {.threads = threads});
  }
  Carrier Between(const ExternalPosition& from, const ExternalPosition& to) const {
    const Cell& cell = stations.world().cell();
    return {cell.arm, cell.X_WB, cell.X_FT,
            std::make_shared<const CoordinatedMotion>(
                CoordinatedMotion{Mechanism(cell.external_axes), cell.X_WB, cell.X_WP, from, to})};
  }
};

const ExternalCourse kCourse{{-250, -0.12}, {250, 0.15}};

/// What holds of every such plan.
void ExpectRides(const PoseProblem& problem, const PathOptions& options, const Coordinated& riding,
                 const PassResult& result) {
  const Mechanism mechanism(riding.stations.world().cell().external_axes);
  const double length = riding.on_part.points.back().arc_length - riding.on_part.points.front().arc_length;
  for (const PlannedPoint& planned : result.points) {
    ASSERT_TRUE(planned.external.has_value());
    const double share = (planned.point.arc_length - riding.on_part.points.front().arc_length) / length;
    for (size_t i = 0; i < 2; ++i)
      EXPECT_NEAR((*planned.external)[i],
                  riding.course.from[i] + share * (riding.course.to[i] - riding.course.from[i]), 1e-9);
    if (planned.skip != Infeasibility::kNone) continue;
    const Pose X_WB = mechanism.Moved(Carries::kRobot, *planned.external) * problem.X_WB;
    const Pose X_WT = X_WB * ForwardFlange(problem.arm, planned.q) * problem.X_FT;
    EXPECT_LT((X_WT.translation() - planned.point.position).norm(), 1e-8);
    EXPECT_LT((X_WT.linear().col(2) - planned.point.tool_axis).norm(), 1e-10);
    // The contact on the part is where the path has it.
    const Eigen::Vector3d on_part =
        mechanism.Moved(Carries::kWorkpiece, *planned.external).inverse() * X_WT.translation();
    const auto& points = riding.on_part.points;
    EXPECT_TRUE(std::ranges::any_of(
        points, [&](const MillingPoint& point) { return (point.position - on_part).norm() < 1e-8; }));
    EXPECT_TRUE((planned.q.array() >= problem.bounds.lower.array() - 1e-12).all());
    EXPECT_TRUE((planned.q.array() <= problem.bounds.upper.array() + 1e-12).all());
  }
  for (const Segment& piece : result.pieces) {
    EXPECT_FALSE(piece.closed);
    for (int t = piece.first; t < piece.last; ++t) {
      const PlannedPoint &from = result.points[static_cast<size_t>(t)],
                         &to = result.points[static_cast<size_t>(t) + 1];
      const Joints step = to.q - from.q;
      EXPECT_TRUE((step.cwiseAbs().array() <= options.steps.most.array() + 1e-12).all()) << t;
      const Carrier carrier = riding.Between(*from.external, *to.external);
      EXPECT_LE(HalfwayDeviation(carrier, from.q, to.q).position, options.max_deviation) << t;
      EXPECT_TRUE(OnLine(carrier, from.q, to.q, 0.5));
    }
  }
  EXPECT_EQ(result.external, *result.points.front().external);
}

TEST(CoordinatedPass, EveryPointMeetsItsContactWhereTheAxesAreThen) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const Coordinated riding(problem, RailAndTable(EmptyCell(problem)), kCourse, Row(-300, 300, 40));
  const PassResult result = riding.Plan(Options());
  ExpectRides(problem, Options(), riding, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_EQ(result.pieces[0].first, 0);
  EXPECT_EQ(result.pieces[0].last, 39);
  // The figures are those of the point's own station: rail and all.
  const PlannedPoint& last = result.points.back();
  const Station& there = riding.stations.At(kCourse.to);
  const PointScorer scorer(there.problem, last.point, riding.pass.rotation_reference);
  EXPECT_NEAR(scorer.ScoreOne(last.freedoms, last.branch).objective, last.objective, 1e-12);
}

TEST(CoordinatedPass, AxesThatDoNotMoveGiveThePlanOfAStationThatStands) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const ExternalPosition at{120, 0.1};
  const Coordinated riding(problem, RailAndTable(EmptyCell(problem)), StandingAt(at), Row(-300, 300, 30));
  const PassResult rides = riding.Plan(Options());
  const Station& station = riding.stations.At(at);
  const PassResult stands =
      PlanPass(station.problem, station.world, {riding.pass}, Options(), {.threads = 2});
  ASSERT_EQ(rides.points.size(), stands.points.size());
  for (size_t t = 0; t < stands.points.size(); ++t) {
    EXPECT_LT((rides.points[t].q - stands.points[t].q).cwiseAbs().maxCoeff(), 1e-6) << t;
    EXPECT_FALSE(stands.points[t].external);
  }
}

TEST(CoordinatedPass, KeepsClearOfWhatStandsWhileTheAxesMove) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const Coordinated open(problem, RailAndTable(EmptyCell(problem)), kCourse, Row(-300, 300, 40));
  const PassResult unbarred = open.Plan(Options());
  // A ball where the wrist would go by, in the world: in the arm's own frame it moves.
  Cell cell = CellWithBallAt(problem, unbarred, 20, 60);
  cell = RailAndTable(cell);
  const Mechanism mechanism(cell.external_axes);
  cell.bodies[1].X_MG.translation() =
      mechanism.Moved(Carries::kRobot, *unbarred.points[20].external) * cell.bodies[1].X_MG.translation();
  const Coordinated riding(problem, cell, kCourse, Row(-300, 300, 40));
  PathOptions options = Options();
  const PassResult result = riding.Plan(options);
  ExpectRides(problem, options, riding, result);
  EXPECT_GT(result.nodes_pruned, 0);
  ASSERT_FALSE(result.pieces.empty());
  int looks = 0;
  double nearest = 1e9;
  for (const Segment& piece : result.pieces)
    for (auto t = static_cast<size_t>(piece.first); t < static_cast<size_t>(piece.last); ++t) {
      const PlannedPoint &from = result.points[t], &to = result.points[t + 1];
      const Carrier carrier = riding.Between(*from.external, *to.external);
      for (int k = 0; k <= 20; ++k) {
        const double share = k / 20.0;
        const std::optional<Joints> q = OnLine(carrier, from.q, to.q, share);
        ASSERT_TRUE(q);
        Checker checker(riding.stations.world().At(carrier.ride->At(share)));
        nearest = std::min(nearest, checker.Clearance(*q, Phase::kCutting, 50));
        ++looks;
      }
    }
  EXPECT_GT(looks, 400);
  EXPECT_GE(nearest, cell.clearances.free - options.swept_resolution);
  EXPECT_LT(nearest, 45);  // it was in the way
}

TEST(CoordinatedPass, ARingEndsWhereItBeganOnThePart) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  Pass ring = Ring(150, 40);
  for (size_t t = 0; t < ring.points.size(); ++t) ring.points[t].arc_length = 23.5 * static_cast<double>(t);
  const Coordinated riding(problem, RailAndTable(EmptyCell(problem)), kCourse, ring);
  ASSERT_EQ(riding.pass.points.size(), 41u);
  const PassResult result = riding.Plan(Options());
  ExpectRides(problem, Options(), riding, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_EQ(result.pieces[0].last, 40);
  EXPECT_EQ(*result.points.back().external, kCourse.to);
}

TEST(CoordinatedPass, SameBytesForAnyNumberOfThreads) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const Coordinated riding(problem, RailAndTable(EmptyCell(problem)), kCourse, Row(-60, 60, 20));
  const std::string bytes = HashOfValues(riding.Plan(Options(), 1));
  for (const int threads : {2, 4}) EXPECT_EQ(HashOfValues(riding.Plan(Options(), threads)), bytes);
}

TEST(ExternalCourse, GoesEvenlyAndNoFasterThanItMay) {
  const Pass row = Row(0, 100, 11);
  const std::vector<ExternalAxis> axes = RailAndTable(Cell()).external_axes;
  const std::vector<ExternalPosition> positions = PositionsAlong({{-10, 0}, {10, 1}}, row);
  for (size_t t = 0; t < 11; ++t) {
    EXPECT_NEAR(positions[t][0], -10 + 2.0 * static_cast<double>(t), 1e-12);
    EXPECT_NEAR(positions[t][1], 0.1 * static_cast<double>(t), 1e-12);
  }
  EXPECT_EQ(positions.back(), (ExternalPosition{10, 1}));
  Pass fed = row;
  for (MillingPoint& point : fed.points) point.feed_rate = 20;  // 100 mm in 5 s
  // A tenth of 500 mm/s and of 0.5 rad/s for 5 s: 250 mm and 0.25 rad.
  EXPECT_TRUE(IsSlowEnough({{0, 0}, {249, 0}}, fed, axes, {0.1}));
  EXPECT_FALSE(IsSlowEnough({{0, 0}, {251, 0}}, fed, axes, {0.1}));
  EXPECT_TRUE(IsSlowEnough({{0, 0.249}, {0, 0}}, fed, axes, {0.1}));
  EXPECT_FALSE(IsSlowEnough({{0, 0.251}, {0, 0}}, fed, axes, {0.1}));
  fed.points[5].feed_rate = 40;  // faster for one segment: what the course asks of it there counts
  EXPECT_FALSE(IsSlowEnough({{0, 0}, {249, 0}}, fed, axes, {0.1}));
}

}  // namespace
}  // namespace millpose
