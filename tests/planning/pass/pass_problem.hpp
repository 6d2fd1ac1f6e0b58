// SPDX-License-Identifier: GPL-3.0-or-later
// Passes to plan, and what holds of every plan.
#pragma once

#include "planning/pass/pass_planner.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {

/// An arm in an otherwise empty cell.
inline Cell EmptyCell(const PoseProblem& problem) {
  Cell cell;
  cell.name = "test";
  cell.arm = problem.arm;
  cell.X_WB = problem.X_WB;
  cell.X_FT = problem.X_FT;
  cell.cutter_length = 40;
  return cell;
}

/// A ball at the wrist and a ball in its way, where the wrist stood at point `t` of `result`.
inline Cell CellWithBallAt(const PoseProblem& problem, const PassResult& result, size_t t, double radius) {
  Cell cell = EmptyCell(problem);
  Body wrist{.name = "wrist",
             .body_class = BodyClass::kLink,
             .mount = Mount::kLink,
             .link = 5,
             .shape = Sphere{100}};
  Body ball{
      .name = "ball", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{radius}};
  ball.X_MG.translation() = (problem.X_WB * LinkFrames(problem.arm, result.points[t].q)[5]).translation();
  cell.bodies = {wrist, ball};
  return cell;
}

inline PathOptions Options() {
  PathOptions options;
  options.rotation_step = DegToRad(2);
  options.steps = {kPi, 1e9, Joints::Constant(DegToRad(5))};
  return options;
}

inline Pass Row(double from, double to, int count, double z = 0) {
  Pass pass;
  for (int t = 0; t < count; ++t) {
    pass.points.push_back(PanelPoint(from + (to - from) * t / (count - 1), z));
    pass.points.back().arc_length = (to - from) * t / (count - 1);
  }
  return pass;
}

/// A ring on a vertical wall in front of the arm, normals towards it.
inline Pass Ring(double radius, int count) {
  Pass pass;
  pass.closed = true;
  for (int t = 0; t < count; ++t) {
    const double angle = 2 * kPi * t / count;
    MillingPoint point;
    point.position = Eigen::Vector3d(2000, radius * std::cos(angle), 1150 + radius * std::sin(angle));
    point.normal = point.tool_axis = -Eigen::Vector3d::UnitX();
    point.feed = Eigen::Vector3d(0, -std::sin(angle), std::cos(angle));
    pass.points.push_back(point);
  }
  return pass;
}

/// What holds of every plan: poses meet the points, are admissible, steps are within the bound.
inline void ExpectSound(const PoseProblem& problem, const PathOptions& options, const Pass& pass,
                        const PassResult& result) {
  ASSERT_GE(result.points.size(), pass.points.size());  // more where parts of a split pass overlap
  std::vector<int> covered(result.points.size(), 0);
  EXPECT_EQ(std::count_if(result.points.begin(), result.points.end(),
                          [](const PlannedPoint& p) { return p.point.kind == PointKind::kCut; }),
            std::ssize(pass.points));
  for (size_t p = 0; p < result.pieces.size(); ++p) {
    const Segment& piece = result.pieces[p];
    EXPECT_EQ(piece.piece, static_cast<int>(p));
    for (int t = piece.first; t <= piece.last; ++t) {
      ++covered[t];
      EXPECT_EQ(result.points[t].piece, piece.piece);
      EXPECT_EQ(result.points[t].branch, result.points[piece.first].branch);
      if (t == piece.first) continue;
      const Joints step = result.points[t].q - result.points[t - 1].q;
      const Joints most =
          StepBound(options.steps, problem.arm, result.points[t - 1].point, result.points[t].point);
      EXPECT_TRUE((step.cwiseAbs().array() <= most.array() + 1e-12).all()) << t;
    }
    if (piece.closed) {
      const Joints step =
          (result.points[piece.first].q - result.points[piece.last].q).unaryExpr([](double d) {
            return std::remainder(d, 2 * kPi);
          });
      const Joints most = StepBound(options.steps, problem.arm, result.points[piece.last].point,
                                    result.points[piece.first].point);
      EXPECT_TRUE((step.cwiseAbs().array() <= most.array() + 1e-12).all());
    }
  }
  for (size_t t = 0; t < result.points.size(); ++t) {
    const PlannedPoint& point = result.points[t];
    const MillingPoint& asked = point.point;
    EXPECT_EQ(covered[t], point.skip == Infeasibility::kNone ? 1 : 0) << t;
    EXPECT_EQ(point.detail.empty(), point.skip == Infeasibility::kNone);
    if (point.skip != Infeasibility::kNone) continue;
    const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, point.q) * problem.X_FT;
    EXPECT_LT((X_WT.translation() - asked.position).norm(), 1e-8);
    EXPECT_LT((X_WT.linear().col(2) - asked.tool_axis).norm(), 1e-10);
    const PointScorer scorer(problem, asked, pass.rotation_reference);
    EXPECT_LT((X_WT.linear() - scorer.ToolPose(point.freedoms).linear()).norm(), 1e-10);
    EXPECT_TRUE((point.q.array() >= problem.bounds.lower.array() - 1e-12).all());
    EXPECT_TRUE((point.q.array() <= problem.bounds.upper.array() + 1e-12).all());
    EXPECT_EQ(Status(problem.arm, point.q), point.branch);
    const double f = 0.5 * point.indices.lambda_t2 + 0.5 * point.indices.lambda_n;
    EXPECT_NEAR(point.objective / f, 1, 1e-9);
    EXPECT_GE(point.objective, point.own_optimum * (1 - 1e-4));
    EXPECT_GT(point.dexterity, 0);
  }
}

/// Whether the tool runs from point t of `pass` to the next without being lifted.
inline bool IsCut(const Pass& pass, const PassResult& result, size_t t) {
  const size_t next = (t + 1) % pass.points.size();
  for (size_t i = 0; i < result.points.size(); ++i) {
    const PlannedPoint& a = result.points[i];
    if (a.skip != Infeasibility::kNone || a.point.position != pass.points[t].position) continue;
    const Segment& piece = result.pieces[static_cast<size_t>(a.piece)];
    const bool ends = static_cast<int>(i) == piece.last;
    if (ends && !piece.closed) continue;
    const PlannedPoint& b = result.points[ends ? static_cast<size_t>(piece.first) : i + 1];
    if (b.point.position == pass.points[next].position) return true;
  }
  return false;
}

}  // namespace millpose
