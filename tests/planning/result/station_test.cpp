// SPDX-License-Identifier: GPL-3.0-or-later
// Base and part with a rail and a table somewhere.
#include "planning/result/station.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

PlanResult RailAndTable() {
  PlanResult plan;
  plan.external_axes = {{.name = "rail", .direction = Vector3d::UnitY(), .compliance = {}},
                        {.name = "table",
                         .kind = AxisKind::kRotary,
                         .carries = Carries::kWorkpiece,
                         .direction = Vector3d::UnitZ(),
                         .origin = Vector3d(1700, 0, 0),
                         .compliance = {}}};
  plan.X_WB.translation() = Vector3d(10, 20, 30);
  plan.X_WP.translation() = Vector3d(1700, 100, 500);
  return plan;
}

TEST(Station, TheRailCarriesTheBaseAndTheTableThePart) {
  const PlanResult plan = RailAndTable();
  const ExternalPosition at{400, DegToRad(90)};
  EXPECT_LT((BaseAt(plan, at).translation() - Vector3d(10, 420, 30)).norm(), 1e-9);
  EXPECT_LT((PartAt(plan, at).translation() - Vector3d(1600, 0, 500)).norm(), 1e-9);
  EXPECT_EQ(BaseAt(plan, {}).matrix(), plan.X_WB.matrix());
  EXPECT_EQ(PartAt(plan, {}).matrix(), plan.X_WP.matrix());
}

TEST(Station, APlaceOnThePartIsTheSamePlaceWhereverTheTableStands) {
  const PlanResult plan = RailAndTable();
  const Vector3d on_part(40, -50, 60);
  for (const double turn : {-2.0, 0.0, 0.3, 3.0}) {
    const ExternalPosition at{-250, turn};
    EXPECT_LT((OnPartAtZero(plan, at, PartAt(plan, at) * on_part) - plan.X_WP * on_part).norm(), 1e-9);
    // The arm sees the part from the base as it does in W.
    const Pose seen = BaseFromPartAtZero(plan, at).inverse() * plan.X_WP;
    EXPECT_LT((seen.matrix() - (BaseAt(plan, at).inverse() * PartAt(plan, at)).matrix()).norm(), 1e-9);
  }
  EXPECT_EQ(OnPartAtZero(plan, {}, on_part), on_part);
}

TEST(Station, APointsOwnPositionCountsBeforeThatOfItsPass) {
  PlanResult plan = RailAndTable();
  PassResult pass;
  pass.external = {100, 0};
  pass.points.resize(2);
  EXPECT_FALSE(MovesAlong(pass));
  pass.points[1].external = ExternalPosition{200, 0.5};
  EXPECT_TRUE(MovesAlong(pass));
  EXPECT_EQ(ExternalAt(pass, 0), pass.external);
  EXPECT_EQ(ExternalAt(pass, 1), *pass.points[1].external);
  EXPECT_EQ(PositionText(plan.external_axes, {200, DegToRad(30)}), "rail 200 mm, table 30 deg");
  EXPECT_FALSE(MovesAlong(plan));
  plan.passes = {pass};
  EXPECT_TRUE(MovesAlong(plan));
}

}  // namespace
}  // namespace millpose
