// SPDX-License-Identifier: GPL-3.0-or-later
#include "read_vtp.hpp"
#include "small_plan.hpp"

namespace millpose {

using test::ReadVtp, test::VtpArrays;

TEST(PathVtp, HasEveryPointPieceAndIndex) {
  const VtpArrays arrays = ReadVtp(PathVtp(SmallPlan()));
  EXPECT_EQ(arrays.attributes.at("NumberOfPoints"), "4");
  EXPECT_EQ(arrays.attributes.at("NumberOfVerts"), "1");
  EXPECT_EQ(arrays.attributes.at("NumberOfLines"), "1");
  EXPECT_EQ(arrays.values.at("Points/position_mm"),
            (std::vector<double>{0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}));
  EXPECT_EQ(arrays.values.at("Lines/connectivity"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(arrays.values.at("Lines/offsets"), (std::vector<double>{3}));
  EXPECT_EQ(arrays.values.at("Verts/connectivity"), (std::vector<double>{3}));
  EXPECT_EQ(arrays.values.at("PointData/objective"), (std::vector<double>{1, 2, 3, 0}));
  EXPECT_EQ(arrays.values.at("PointData/planned"), (std::vector<double>{1, 1, 1, 0}));
  for (const char* name : {"lambda_t1_mm_N", "mu", "a6_deg", "clearance_mm", "rotation_deg", "pass"})
    EXPECT_EQ(arrays.values.at(std::string("PointData/") + name).size(), 4u) << name;
  EXPECT_EQ(arrays.values.at("PointData/normal").size(), 12u);
}

TEST(PathVtp, ClosedPiecesReturnToTheirStart) {
  PlanResult plan = SmallPlan();
  plan.passes[0].pieces[0].closed = true;
  const VtpArrays arrays = ReadVtp(PathVtp(plan));
  EXPECT_EQ(arrays.values.at("Lines/connectivity"), (std::vector<double>{0, 1, 2, 0}));
}

TEST(PathVtp, SecondPassRefersToItsOwnPoints) {
  PlanResult plan = SmallPlan();
  plan.passes.push_back(plan.passes[0]);
  const VtpArrays arrays = ReadVtp(PathVtp(plan));
  EXPECT_EQ(arrays.values.at("Lines/connectivity"), (std::vector<double>{0, 1, 2, 4, 5, 6}));
  EXPECT_EQ(arrays.values.at("Lines/offsets"), (std::vector<double>{3, 6}));
}

// Blocks have 8192 numbers: one that is full, one begun.
TEST(PathVtp, LongArraysComeInBlocks) {
  PlanResult plan = SmallPlan();
  const PlannedPoint point = plan.passes[0].points[0];
  for (const size_t count : {size_t{8192}, size_t{9000}}) {
    std::vector<double> lengths;
    plan.passes[0].points.assign(count, point);
    for (size_t i = 0; i < count; ++i)
      lengths.push_back(plan.passes[0].points[i].point.arc_length = 0.1 * static_cast<double>(i));
    const VtpArrays arrays = ReadVtp(PathVtp(plan));
    EXPECT_EQ(arrays.values.at("PointData/s_mm"), lengths);
    EXPECT_EQ(arrays.values.at("PointData/normal").size(), 3 * count);
    EXPECT_TRUE(arrays.values.at("Verts/connectivity").empty());
  }
}

}  // namespace millpose
