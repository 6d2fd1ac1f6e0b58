// SPDX-License-Identifier: GPL-3.0-or-later
// The audit of `plan --audit`: the cell that it hands to the judge, and what it makes of the judge's answers.
#include "audit/interference.hpp"
#include "base/file.hpp"
#include "base/random.hpp"
#include "job/assemble.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/kinematics.hpp"
#include "run/pipeline/audit/audit.hpp"
#include "run/pipeline/audit/judge_setup.hpp"
#include "tests/audit/folder.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

/// Joint angles about home, where the tool comes near the part and the arm near itself.
Joints SomePose(const Cell& cell, RandomStream& random) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = random.Uniform(cell.arm.lower[i], cell.arm.upper[i]);
  return q;
}

TEST(PlanAudit, TheJudgeSeesTheCellAsItReadsItItself) {
  const fs::path folder = fs::path(SourceDir()) / "toolpaths/support_pad";
  const Cell cell = MakeJobCell(LoadJobInputs(folder / "job.yaml"));
  audit::Judge given(MakeJudgeSetup(cell)), read(audit::ReadSetup(ReadFile(folder / "job.yaml"), {folder}));
  RandomStream random(3, 0);
  int touching = 0, near = 0;
  for (int k = 0; k < 60; ++k) {
    const audit::Angles q = ToJudge(SomePose(cell, random));
    const bool cutting = k % 2 == 1;
    const auto contact = given.At(q, cutting, true), same = read.At(q, cutting, true);
    EXPECT_EQ(contact.has_value(), same.has_value()) << k;
    touching += contact.has_value();
    for (const audit::Near& pair : given.TooNear({q, q, cutting}, 1, 0, 1)) {
      // Every pair of triangles measured, body by body of that name: never farther than told.
      const double distance = static_cast<double>(read.Distance(pair.first, pair.second, q, cutting, 20));
      EXPECT_LE(distance, pair.distance + 1e-3) << pair.first << " " << pair.second;
      EXPECT_LT(pair.distance, pair.wanted);
      near += pair.distance > 0;
    }
  }
  EXPECT_GT(touching, 0);
  EXPECT_GT(near, 0);
}

/// A plan of one cut that stands still at home, beside a fixture that is `gap` mm from the holder.
AuditFigures AuditBeside(double gap, double share_of_angle = 1e-4) {
  std::map<std::string, std::string> bytes;
  Cell cell = MakeCell(LoadCell(fs::path(SourceDir()) / "cells/quantec_r2700.yaml", &bytes), bytes);
  const Pose X_WT = cell.X_WB * ForwardFlange(cell.arm, cell.home) * cell.X_FT;
  Body post{"post", BodyClass::kFixture, Mount::kWorld, 0, Pose::Identity(), Box{{10, 10, 10}}};
  post.X_MG = X_WT * Pose(Eigen::Translation3d(-63.0 / 2 - 5 - gap, 0, 90));  // beside the holder
  cell.bodies.push_back(post);
  PlanResult plan;
  plan.arm = cell.arm, plan.X_WB = cell.X_WB, plan.X_FT = cell.X_FT, plan.home = cell.home;
  PassResult& pass = plan.passes.emplace_back();
  pass.points.resize(2);
  pass.points[0].q = pass.points[1].q = cell.home;
  pass.points[1].q[5] += share_of_angle;
  pass.pieces.push_back({0, 0, 0, 1, false});
  AuditRules rules{.bounds = {}, .cutter = {}, .resolution = 0.5};
  rules.bounds.lower = cell.arm.lower, rules.bounds.upper = cell.arm.upper;
  return Audit(plan, Mesh(Triangles{}), cell, rules, {.threads = 2});
}

/// A cut along which the rail goes by `way` mm while the joints stand still, past a fixture that stands
/// half-way of 400 mm, `gap` mm from the holder.
AuditFigures AuditAlongRail(double way, double gap, double feed) {
  std::map<std::string, std::string> bytes;
  Cell cell = MakeCell(LoadCell(fs::path(SourceDir()) / "cells/kr500_rail.yaml", &bytes), bytes);
  const Pose X_WT = cell.X_WB * ForwardFlange(cell.arm, cell.home) * cell.X_FT;
  Body post{"post", BodyClass::kFixture, Mount::kWorld, 0, Pose::Identity(), Box{{10, 10, 10}}};
  const Eigen::Vector3d beside = X_WT.linear().col(0).cross(Eigen::Vector3d::UnitY()).norm() > 0.5
                                     ? X_WT.linear().col(0)
                                     : X_WT.linear().col(1);
  const Eigen::Vector3d out = (beside - beside.y() * Eigen::Vector3d::UnitY()).normalized();
  post.X_MG =
      Pose(Eigen::Translation3d(Eigen::Vector3d(X_WT.translation() + 90 * X_WT.linear().col(2) +
                                                (63.0 / 2 + 5 + gap) * out + Eigen::Vector3d(0, 200, 0))));
  cell.bodies.push_back(post);
  PlanResult plan;
  plan.arm = cell.arm, plan.X_WB = cell.X_WB, plan.X_FT = cell.X_FT, plan.home = cell.home;
  plan.external_axes = cell.external_axes;
  PassResult& pass = plan.passes.emplace_back();
  pass.external = {0};
  pass.points.resize(2);
  for (size_t i = 0; i < 2; ++i) {
    PlannedPoint& point = pass.points[i];
    point.q = cell.home;
    point.external = ExternalPosition{way * static_cast<double>(i)};
    point.point.position = X_WT.translation() + way * static_cast<double>(i) * Eigen::Vector3d::UnitY();
    point.point.feed_rate = feed;
  }
  pass.pieces.push_back({0, 0, 0, 1, false});
  AuditRules rules{.bounds = {}, .cutter = {}, .resolution = 0.5};
  rules.bounds.lower = cell.arm.lower, rules.bounds.upper = cell.arm.upper;
  return Audit(plan, Mesh(Triangles{}), cell, rules, {.threads = 2});
}

TEST(PlanAudit, FollowsARailThatMovesAlongACut) {
  const AuditFigures past = AuditAlongRail(400, -2, 80), beside = AuditAlongRail(400, 4, 80),
                     short_of = AuditAlongRail(100, -2, 80), clear = AuditAlongRail(400, 30, 80);
  EXPECT_GT(past.interferences, 0);
  EXPECT_EQ(beside.interferences, 0);
  EXPECT_GT(beside.clearance_violations, 0);
  for (const AuditFigures& free : {short_of, clear}) {
    EXPECT_EQ(free.interferences + free.clearance_violations, 0);
    EXPECT_EQ(free.limit_violations, 0);
  }
  EXPECT_EQ(AuditAlongRail(400, 30, 1001).limit_violations, 1) << "the rail makes 1000 mm/s";
  EXPECT_EQ(AuditAlongRail(2001, 30, 80).limit_violations, 1) << "and 2000 mm";
}

TEST(PlanAudit, TellsContactAndClearanceApartByPair) {
  const AuditFigures free = AuditBeside(12), near = AuditBeside(4), touching = AuditBeside(-2);
  EXPECT_EQ(free.interferences + free.clearance_violations, 0);
  EXPECT_TRUE(Findings(free).empty());

  EXPECT_EQ(near.interferences, 0);
  EXPECT_GT(near.clearance_violations, 0);
  ASSERT_EQ(near.pairs.size(), 1u);
  EXPECT_NEAR(near.pairs[0].least_mm, 4, 0.1);
  EXPECT_EQ(near.pairs[0].wanted_mm, 10);
  ASSERT_EQ(Findings(near).size(), 1u);
  EXPECT_NE(Findings(near)[0].find("post"), std::string::npos);
  EXPECT_NE(Findings(near)[0].find("holder"), std::string::npos);

  EXPECT_GT(touching.interferences, 0);
  EXPECT_EQ(touching.clearance_violations, 0);
  ASSERT_EQ(Findings(touching).size(), 1u);
  EXPECT_NE(Findings(touching)[0].find("touches"), std::string::npos);
}

}  // namespace
}  // namespace millpose
