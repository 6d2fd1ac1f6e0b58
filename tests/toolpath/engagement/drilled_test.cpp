// SPDX-License-Identifier: GPL-3.0-or-later
// Thrust, torque and power of a drill against figures worked out by hand, and where on its way it cuts.
#include "toolpath/engagement/drilled.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "toolpath/engagement/cutting_power.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kDrillRadius = 5;

EngagementOptions DrillOptions(double point_deg = 118) {
  EngagementOptions options;
  options.spindle_speed = 50;  // 3000 rpm
  options.drill = DrillLips{{"AlMgSi", 800, 0.25, ""}, 2 * kDrillRadius, 2, DegToRad(point_deg)};
  return options;
}

/// A hole along z from the origin, blind or open at the height `out`; fed at 5 mm/s: 0.05 mm a tooth. The tip
/// stands at each of the heights in turn.
Pass HoleOf(const std::vector<double>& heights, double out = -1e9) {
  Pass pass;
  for (const double height : heights) {
    MillingPoint point;
    point.position = {3, 4, height};
    point.feed_rate = 5;
    point.own = OwnCut{-height, out - height};
    pass.points.push_back(point);
  }
  return pass;
}

std::vector<Engagement> CutsAlong(const EngagementOptions& options, const Pass& hole) {
  Toolpath path{{hole}, {}};
  SetEngagement(options, 1, {}, path);
  std::vector<Engagement> cuts;
  for (const MillingPoint& point : path.passes[0].points) cuts.push_back(point.engagement);
  return cuts;
}

// h = 0.05·sin 59° = 0.0428584 mm, k_c = 800·h^(−0.25) = 1758.25 N/mm²; 2 lips: 2·0.05·1758.25 = 175.825 N
// per mm of radius. Thrust 0.63·0.857167·175.825·5 = 474.74 N, torque 175.825·5²/2 = 2197.8 N·mm.
TEST(DrillLips, HasTheLoadWorkedOutByHand) {
  const DrillLoad load = LoadOfDrill(*DrillOptions().drill, 10, 5, 0.05);
  EXPECT_NEAR(load.thrust, 474.74, 0.01);
  EXPECT_NEAR(load.torque, 2197.8, 0.05);
  // A flat point: h = 0.05, k_c = 1691.79, 169.179 N/mm; thrust 0.63·169.179·5, torque 169.179·12.5.
  const DrillLoad flat = LoadOfDrill(*DrillOptions(180).drill, 10, 5, 0.05);
  EXPECT_NEAR(flat.thrust, 532.92, 0.01);
  EXPECT_NEAR(flat.torque, 2114.7, 0.05);
}

// What is bored in two steps takes the work of one, and the thrust goes with a_p.
TEST(DrillLips, RingsAddUp) {
  const DrillLips lips = *DrillOptions().drill;
  const DrillLoad whole = LoadOfDrill(lips, 10, 5, 0.03), pilot = LoadOfDrill(lips, 6, 3, 0.03),
                  ring = LoadOfDrill(lips, 10, 2, 0.03);
  EXPECT_NEAR(pilot.thrust + ring.thrust, whole.thrust, 1e-9);
  EXPECT_NEAR(pilot.torque + ring.torque, whole.torque, 1e-9);
  EXPECT_NEAR(ring.torque / whole.torque, (25.0 - 9) / 25, 1e-12);
}

// The catalogue's own example: Ø 22 mm, 0.15 mm/rev, k_c 2200 N/mm², flat: 20 N·m and 2286 N, rounded there.
TEST(DrillLips, AgreesWithTheCataloguesExample) {
  const DrillLoad load = LoadOfDrill({{"steel", 2200, 0, ""}, 22, 2, kPi}, 22, 11, 0.075);
  EXPECT_NEAR(load.torque, 20e3, 100);
  EXPECT_NEAR(load.thrust, 2286, 2);
}

TEST(Drilled, CutsOnlyWhereItGoesDeeper) {
  // Down, out to break the chip, down again to 1 mm above where it was, on, and out.
  const std::vector<double> heights{2, -4, -8, 2, -7, -8, -12, 2};
  const std::vector<Engagement> cuts = CutsAlong(DrillOptions(), HoleOf(heights));
  const std::vector<bool> expected{false, true, true, false, false, false, true, false};
  for (size_t i = 0; i < heights.size(); ++i) {
    EXPECT_EQ(cuts[i].side != CutSide::kAir, expected[i]) << i;
    EXPECT_EQ(cuts[i].force.norm() > 0, expected[i]) << i;
  }
  EXPECT_NEAR((cuts[6].force - Vector3d(0, 0, 474.74)).norm(), 0, 0.01) << "towards the holder";
  EXPECT_EQ(cuts[6].width, 10);
  EXPECT_NEAR(cuts[6].depth, 5, 1e-9);
}

// The point is 5/tan 59° = 3.0043 mm long: 1.5 mm deep half of the radius cuts, and 1.5 mm beyond the far
// side the outer half alone.
TEST(Drilled, CutsWithWhatOfThePointIsInTheMaterial) {
  const double full = CutsAlong(DrillOptions(), HoleOf({2, -12}))[1].force.norm();
  const Engagement entering = CutsAlong(DrillOptions(), HoleOf({2, -1.5021}))[1];
  EXPECT_NEAR(entering.width, 5, 0.2);
  EXPECT_NEAR(entering.force.norm(), full / 2, 0.02 * full);
  const std::vector<Engagement> leaving = CutsAlong(DrillOptions(), HoleOf({2, -19, -21.5021, -23.1}, -20));
  EXPECT_NEAR(leaving[1].force.norm(), full, 1e-9);
  EXPECT_NEAR(leaving[2].force.norm(), full / 2, 0.02 * full);
  EXPECT_EQ(leaving[2].width, 10);
  EXPECT_EQ(leaving[3].side, CutSide::kAir);
}

// A hole that was drilled to Ø 6 before leaves a ring; above the stock there is air.
TEST(Drilled, MeetsTheStockThatStands) {
  EngagementOptions options = DrillOptions();
  options.stock = [](const Vector3d& place) {
    const double across = std::hypot(place.x() - 3, place.y() - 4);
    return place.z() < 6 && across > 3;
  };
  const std::vector<Engagement> cuts = CutsAlong(options, HoleOf({9, 6.5, 0, -6}));
  EXPECT_EQ(cuts[1].side, CutSide::kAir);
  for (const size_t i : {2, 3}) {
    EXPECT_NEAR(cuts[i].depth, 2, 0.05);
    EXPECT_EQ(cuts[i].width, 10);
    const DrillLoad ring = LoadOfDrill(*options.drill, 10, cuts[i].depth, 0.05);
    EXPECT_NEAR(cuts[i].force.z(), ring.thrust, 1e-9);
  }
}

TEST(Drilled, LeavesWhatIsNotAskedFor) {
  Toolpath path{{HoleOf({2, -4, -8})}, {}};
  SetEngagement(DrillOptions(), 1, {}, path, {{0, 0, 1}});
  EXPECT_EQ(path.passes[0].points[1].engagement.side, CutSide::kAir);
  EXPECT_EQ(path.passes[0].points[2].engagement.side, CutSide::kSlot);
  // Points that were moved know no hole any more, and keep what was worked out.
  for (MillingPoint& point : path.passes[0].points) point.own.reset();
  SetEngagement(DrillOptions(), 1, {}, path);
  EXPECT_EQ(path.passes[0].points[2].engagement.side, CutSide::kSlot);
}

TEST(Drilled, HeaviestCutIsTheThrust) {
  Toolpath path{{HoleOf({2, -1, -8, 2})}, {}};
  SetEngagement(DrillOptions(), 1, {}, path);
  const CuttingForce heaviest = HeaviestCut(DrillOptions(), path);
  EXPECT_NEAR((heaviest.mean - Vector3d(0, 0, 474.74)).norm(), 0, 0.01);
  EXPECT_NEAR(heaviest.peak, 474.74, 0.01);
  EXPECT_EQ(heaviest.engaged, 2);
}

// 2197.8 N·mm at 50 rev/s: 690.5 W.
TEST(Drilled, TakesThePowerOfItsTorque) {
  const EngagementOptions options = DrillOptions();
  const std::vector<Engagement> cuts = CutsAlong(options, HoleOf({2, -8}));
  EXPECT_NEAR(CuttingPower(options, cuts[1], 5), 690.5, 0.1);
  EXPECT_EQ(CuttingPower(options, cuts[0], 5), 0);
}

}  // namespace
}  // namespace millpose
