// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/pass_planner.hpp"

#include "base/error.hpp"
#include "path/edge_kernel.hpp"
#include "path/turns.hpp"
#include "tests/pose/problems.hpp"

namespace millpose {
namespace {

/// An arm in an otherwise empty cell.
Cell EmptyCell(const PoseProblem& problem) {
  Cell cell;
  cell.name = "test";
  cell.arm = problem.arm;
  cell.X_WB = problem.X_WB;
  cell.X_FT = problem.X_FT;
  cell.cutter_length = 40;
  return cell;
}

PathOptions Options() {
  PathOptions options;
  options.rotation_step = DegToRad(2);
  options.exhaustive_step = DegToRad(1);
  options.max_joint_step = Joints::Constant(DegToRad(5));
  options.motion_weight = 1e-5;
  return options;
}

Pass Row(double from, double to, int count, double z = 0) {
  Pass pass;
  for (int t = 0; t < count; ++t) {
    pass.points.push_back(PanelPoint(from + (to - from) * t / (count - 1), z));
    pass.points.back().arc_length = (to - from) * t / (count - 1);
  }
  return pass;
}

/// A ring on a vertical wall in front of the arm, normals towards it.
Pass Ring(double radius, int count) {
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
void ExpectSound(const PoseProblem& problem, const PathOptions& options, const Pass& pass,
                 const PassResult& result) {
  ASSERT_GE(result.points.size(), pass.points.size());  // more where parts of a split pass overlap
  std::vector<int> covered(result.points.size(), 0);
  EXPECT_EQ(std::count_if(result.points.begin(), result.points.end(),
                          [](const PlannedPoint& p) { return p.point.kind == PointKind::kCut; }),
            std::ssize(pass.points));
  for (size_t p = 0; p < result.pieces.size(); ++p) {
    const Piece& piece = result.pieces[p];
    EXPECT_EQ(piece.piece, static_cast<int>(p));
    for (int t = piece.first; t <= piece.last; ++t) {
      ++covered[t];
      EXPECT_EQ(result.points[t].piece, piece.piece);
      EXPECT_EQ(result.points[t].branch, result.points[piece.first].branch);
      if (t == piece.first) continue;
      const Joints step = result.points[t].q - result.points[t - 1].q;
      EXPECT_TRUE((step.cwiseAbs().array() <= options.max_joint_step.array() + 1e-12).all()) << t;
    }
    if (piece.closed) {
      const Joints step =
          (result.points[piece.first].q - result.points[piece.last].q).unaryExpr([](double d) {
            return std::remainder(d, 2 * kPi);
          });
      EXPECT_TRUE((step.cwiseAbs().array() <= options.max_joint_step.array() + 1e-12).all());
    }
  }
  for (size_t t = 0; t < result.points.size(); ++t) {
    const PlannedPoint& point = result.points[t];
    const MillingPoint& asked = point.point;
    EXPECT_EQ(covered[t], point.skip == SkipReason::kNone ? 1 : 0) << t;
    EXPECT_EQ(point.detail.empty(), point.skip == SkipReason::kNone);
    if (point.skip != SkipReason::kNone) continue;
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
    EXPECT_GE(point.objective, point.exhaustive_optimum * (1 - 1e-4));
    EXPECT_GT(point.dexterity, 0);
  }
}

/// Whether the tool runs from point t of `pass` to the next without being lifted.
bool IsCut(const Pass& pass, const PassResult& result, size_t t) {
  const size_t next = (t + 1) % pass.points.size();
  for (size_t i = 0; i < result.points.size(); ++i) {
    const PlannedPoint& a = result.points[i];
    if (a.skip != SkipReason::kNone || a.point.position != pass.points[t].position) continue;
    const Piece& piece = result.pieces[static_cast<size_t>(a.piece)];
    const bool ends = static_cast<int>(i) == piece.last;
    if (ends && !piece.closed) continue;
    const PlannedPoint& b = result.points[ends ? static_cast<size_t>(piece.first) : i + 1];
    if (b.point.position == pass.points[next].position) return true;
  }
  return false;
}

TEST(PlanPass, FollowsARow) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Row(-300, 300, 60);
  const PassResult result = PlanPass(problem, world, pass, 3, 100, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_EQ(result.pieces[0].pass, 3);
  double path = 0, own = 0;
  for (const PlannedPoint& point : result.points) {
    path += point.objective;
    own += point.exhaustive_optimum;
  }
  EXPECT_LT(path, 1.05 * own);
  EXPECT_GE(result.grid_gap, 0);
  EXPECT_LT(result.grid_gap, 0.05);
}

TEST(PlanPass, SameBytesForAnyNumberOfThreads) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Row(-60, 60, 12);
  std::vector<PassResult> results;
  for (const int threads : {1, 2, 4}) {
    results.push_back(PlanPass(problem, world, pass, 0, 0, Options(), threads, {}));
  }
  for (size_t t = 0; t < pass.points.size(); ++t) {
    for (const PassResult& other : results) {
      EXPECT_EQ(results[0].points[t].q, other.points[t].q);
      EXPECT_EQ(results[0].points[t].objective, other.points[t].objective);
      EXPECT_EQ(results[0].points[t].genetic_optimum, other.points[t].genetic_optimum);
    }
  }
}

TEST(PlanPass, ClosesARing) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Ring(400, 150);
  const PassResult result = PlanPass(problem, world, pass, 0, 0, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_TRUE(result.pieces[0].closed);
}

TEST(PlanPass, SplitsWhereNoStepIsSmallEnough) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  Pass pass = Row(-60, 60, 24);
  for (int t = 10; t < 24; ++t) {  // a crease of 35°
    const Eigen::AngleAxisd turn(DegToRad(35), Eigen::Vector3d::UnitZ());
    pass.points[t].normal = pass.points[t].tool_axis = turn * pass.points[t].normal;
  }
  const PassResult result = PlanPass(problem, world, pass, 0, 0, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_EQ(result.pieces[0].last, 9);
  EXPECT_EQ(result.pieces[1].first, 10);
  EXPECT_EQ(result.uncut, std::vector<int>{9});  // no pose on either side reaches over the crease
}

TEST(PlanPass, OneBadPointDoesNotCostThePass) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  Pass pass = Row(-40, 40, 16);
  pass.points[5].position.x() += 9000;
  pass.points[7].position.x() += 9000;  // leaves point 6 alone
  const PassResult result = PlanPass(problem, world, pass, 0, 0, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_EQ(result.points[5].skip, SkipReason::kUnreachable);
  EXPECT_EQ(result.points[6].skip, SkipReason::kStep);
  EXPECT_EQ(result.points[7].skip, SkipReason::kUnreachable);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_EQ(result.pieces[1].first, 8);
}

/// A ball at the wrist and a ball in its way, where the wrist stood at point `t` of `result`.
Cell CellWithBallAt(const PoseProblem& problem, const PassResult& result, size_t t, double radius) {
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

TEST(PlanPass, GoesRoundWhatIsInTheWay) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const Pass pass = Row(-60, 60, 24);
  const PassResult before = PlanPass(problem, World(EmptyCell(problem)), pass, 0, 0, Options(), 2, {});
  const World world(CellWithBallAt(problem, before, 12, 30));
  ASSERT_TRUE(Checker(world).At(before.points[12].q, Phase::kCutting).has_value());
  const PassResult result = PlanPass(problem, world, pass, 0, 0, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_GT(result.nodes_struck, 0);
  EXPECT_GT(result.poses_checked, 0);
  double objective = 0, objective_before = 0;
  Checker checker(world);
  for (size_t t = 0; t < pass.points.size(); ++t) {
    ASSERT_EQ(result.points[t].skip, SkipReason::kNone) << t << result.points[t].detail;
    EXPECT_FALSE(checker.At(result.points[t].q, Phase::kCutting).has_value());
    objective += result.points[t].objective;
    objective_before += before.points[t].objective;
  }
  for (const Piece& piece : result.pieces) {
    for (int t = piece.first; t < piece.last; ++t) {
      EXPECT_FALSE(checker.Between(result.points[t].q, result.points[t + 1].q, Phase::kCutting).has_value());
    }
  }
  EXPECT_GT(objective, objective_before);  // the way round costs stiffness
}

TEST(PlanPass, SaysWhichBodiesBarAPoint) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-100, 100, 16);
  const PassResult before = PlanPass(problem, World(EmptyCell(problem)), pass, 0, 0, Options(), 2, {});
  Cell cell = EmptyCell(problem);
  Body spindle{
      .name = "spindle", .body_class = BodyClass::kSpindle, .mount = Mount::kTool, .shape = Cylinder{8, 200}};
  spindle.X_MG.translation().z() = 200;
  Body rod{.name = "rod", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{2}};
  rod.X_MG.translation() = pass.points[6].position + 200 * pass.points[6].tool_axis;
  cell.bodies = {spindle, rod};
  const PassResult result = PlanPass(problem, World(cell), pass, 0, 0, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_EQ(result.points[6].skip, SkipReason::kInterference);
  EXPECT_NE(result.points[6].detail.find("spindle"), std::string::npos) << result.points[6].detail;
  EXPECT_NE(result.points[6].detail.find("rod"), std::string::npos) << result.points[6].detail;
  EXPECT_EQ(result.points[0].skip, SkipReason::kNone);
  EXPECT_EQ(result.points[15].skip, SkipReason::kNone);
}

TEST(PlanPass, UnwindsWhereAJointRunsOutOfTurns) {
  // A ring on the inside of a cabin about the arm: A1 goes round once, its limits allow hardly more.
  PoseProblem problem = MakeProblem(Kr500R2830(), 1);
  Pass pass;
  pass.closed = true;
  for (int t = 0; t < 120; ++t) {
    const double angle = 2 * kPi * t / 120;
    MillingPoint point;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    point.position = 1900 * out + 1200 * Eigen::Vector3d::UnitZ();
    point.normal = point.tool_axis = -out;
    point.feed = Eigen::Vector3d::UnitZ().cross(out);
    pass.points.push_back(point);
  }
  PathOptions options = Options();
  options.rotation_step = DegToRad(4);
  const PassResult result = PlanPass(problem, World(EmptyCell(problem)), pass, 0, 0, options, 2, {});
  ExpectSound(problem, options, pass, result);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_FALSE(result.pieces[0].closed);
  EXPECT_TRUE(result.uncut.empty());
  for (size_t t = 0; t < pass.points.size(); ++t) EXPECT_TRUE(IsCut(pass, result, t)) << t;
  // The same ring with a joint that may turn on needs no split.
  problem.bounds.lower[0] = DegToRad(-400);
  problem.bounds.upper[0] = DegToRad(400);
  const PassResult free = PlanPass(problem, World(EmptyCell(problem)), pass, 0, 0, options, 2, {});
  ExpectSound(problem, options, pass, free);
  ASSERT_EQ(free.pieces.size(), 1u);
  EXPECT_TRUE(free.pieces[0].closed);
}

/// The arm's first joints held near the course of `result`, so that rotations are too.
void HoldArm(PoseProblem& problem, const PassResult& result, double margin_deg) {
  for (int j = 0; j < 3; ++j) {
    double least = 1e9, most = -1e9;
    for (const PlannedPoint& point : result.points) {
      least = std::min(least, point.q[j]);
      most = std::max(most, point.q[j]);
    }
    problem.bounds.lower[j] = std::max(problem.bounds.lower[j], least - DegToRad(margin_deg));
    problem.bounds.upper[j] = std::min(problem.bounds.upper[j], most + DegToRad(margin_deg));
  }
}

/// The rotation about the tool axis, but within 4° of a value only.
class HeldRotation final : public Freedom {
 public:
  explicit HeldRotation(double middle) : middle_(middle), rotation_(MakeFreedom("rotation")) {}
  std::string Name() const override { return "held rotation"; }
  double Lower() const override { return middle_ - DegToRad(4); }
  double Upper() const override { return middle_ + DegToRad(4); }
  bool Periodic() const override { return false; }
  bool IsToolRotation() const override { return true; }
  Pose Apply(const Pose& X_WT, double value) const override { return rotation_->Apply(X_WT, value); }

 private:
  double middle_;
  std::unique_ptr<Freedom> rotation_;
};

/// A rotation at which the points of a pass, 4° to either side too, are reached with the wrist unflipped and
/// flipped and in no other way; the unflipped branch.
std::optional<std::pair<double, int>> TwoWaysOnly(const PoseProblem& problem, const Pass& pass) {
  for (int place = 0; place < 72; ++place) {
    const double middle = DegToRad(5.0 * place) - kPi;
    unsigned always = 0xff, ever = 0;
    for (const MillingPoint& point : pass.points) {
      const PointScorer scorer(problem, point, pass.rotation_reference);
      for (const double off : {-4.0, 0.0, 4.0}) {
        unsigned reached = 0;
        for (int branch = 0; branch < 8; ++branch) {
          const Candidate at = scorer.ScoreOne({middle + DegToRad(off)}, branch);
          reached |= unsigned{at.admissibility == Admissibility::kAdmissible} << branch;
        }
        always &= reached;
        ever |= reached;
      }
    }
    for (int branch = 0; branch < 4; ++branch) {
      const unsigned both = 1u << branch | 1u << (branch + 4);
      if (always == both && ever == both) return std::pair{middle, branch};
    }
  }
  return std::nullopt;
}

TEST(PlanPass, PostsThatForceAnotherBranchInMidPassSplitItWithAnOverlap) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  const Pass pass = Row(-300, 300, 61);
  const auto held = TwoWaysOnly(problem, pass);
  ASSERT_TRUE(held.has_value());
  problem.freedoms = {std::make_shared<HeldRotation>(held->first)};
  // A motor beside the forearm changes sides when the wrist flips. Posts bar one side at the beginning of the
  // row, the other side at its end.
  Cell cell = EmptyCell(problem);
  const Eigen::Vector3d motor(-300, 0, 260);
  cell.bodies.push_back({.name = "motor",
                         .body_class = BodyClass::kLink,
                         .mount = Mount::kLink,
                         .link = 4,
                         .shape = Sphere{40}});
  cell.bodies.back().X_MG.translation() = motor;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    if (t > 14 && t < 46) continue;
    const PointScorer scorer(problem, pass.points[t], pass.rotation_reference);
    const Joints q = scorer.ScoreOne({held->first}, t <= 14 ? held->second + 4 : held->second).q;
    Body post{.name = "post", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{25}};
    post.name += std::to_string(t);
    post.X_MG.translation() = problem.X_WB * (LinkFrames(problem.arm, q)[4] * motor);
    cell.bodies.push_back(post);
  }
  const World world(cell);
  PathOptions options = Options();
  options.rotation_step = DegToRad(1);
  const PassResult result = PlanPass(problem, world, pass, 0, 0, options, 2, {});
  ExpectSound(problem, options, pass, result);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_TRUE(result.uncut.empty());
  EXPECT_GT(result.points.size(), pass.points.size());
  const auto branch = [&](int piece) {
    return result.points[static_cast<size_t>(result.pieces[static_cast<size_t>(piece)].first)].branch;
  };
  EXPECT_EQ(branch(0), held->second);
  EXPECT_EQ(branch(1), held->second + 4) << "the wrist flips between the pieces";
  for (size_t t = 0; t + 1 < pass.points.size(); ++t) EXPECT_TRUE(IsCut(pass, result, t)) << t;
  Checker checker(world);
  for (const PlannedPoint& point : result.points) EXPECT_FALSE(checker.At(point.q, Phase::kCutting));
}

TEST(PlanPass, NeverRunsThroughTheWristSingularity) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  // A course of A5 from 15° to −15°, nothing else moving: held near it, no rotation leads round A5 = 0.
  Pass pass;
  PassResult course;
  for (int t = 0; t <= 40; ++t) {
    const Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 15 - 0.75 * t, 16.2);
    const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, q) * problem.X_FT;
    MillingPoint point;
    point.position = X_WT.translation();
    point.normal = point.tool_axis = X_WT.linear().col(2);
    point.feed = X_WT.linear().col(0);
    point.feed_rate = 10;
    point.arc_length = 8.0 * t;
    pass.points.push_back(point);
    course.points.emplace_back().q = q;
  }
  HoldArm(problem, course, 0.2);
  PathOptions options = Options();
  options.rotation_step = DegToRad(0.25);
  const PassResult result = PlanPass(problem, World(EmptyCell(problem)), pass, 0, 0, options, 2, {});
  ExpectSound(problem, options, pass, result);  // every piece keeps its branch
  EXPECT_GE(result.pieces.size(), 2u);
  int singular = 0, before = 0, after = 0;
  for (size_t t = 0; t < result.points.size(); ++t) {
    const PlannedPoint& point = result.points[t];
    singular += point.skip == SkipReason::kSingular;
    if (point.skip != SkipReason::kNone) continue;
    EXPECT_GE(DistanceToSingularity(problem.arm, point.q).wrist, 0.05 - 1e-9);
    ++(t < 20 ? before : after);
  }
  EXPECT_GE(singular, 1);
  EXPECT_LE(singular, 10);
  EXPECT_GE(before, 14);
  EXPECT_GE(after, 14);
}

TEST(PlanPass, HalfThePartOutOfReachLeavesTheOtherHalf) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  Pass pass = Row(-60, 60, 24);
  for (int t = 12; t < 24; ++t) pass.points[t].position.x() += 3000;
  const PassResult result = PlanPass(problem, world, pass, 0, 0, Options(), 2, {});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  for (int t = 0; t < 24; ++t) {
    EXPECT_EQ(result.points[t].skip, t < 12 ? SkipReason::kNone : SkipReason::kUnreachable) << t;
  }
  EXPECT_TRUE(result.uncut.empty());
}

TEST(PlanPass, SmoothsWhatItFinds) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Row(-300, 300, 60);
  PathOptions options = Options();
  PathOptions rough = options;
  rough.smoothing_loss = 0;
  const PassResult smooth = PlanPass(problem, world, pass, 0, 0, options, 2, {});
  ExpectSound(problem, options, pass, smooth);
  const PassResult before = PlanPass(problem, world, pass, 0, 0, rough, 2, {});
  const Smoothing& figures = smooth.smoothing;
  EXPECT_LT(figures.square_after, 0.25 * figures.square_before);
  EXPECT_LE(figures.objective_after, 1.01 * figures.objective_before);
  EXPECT_NEAR(figures.square_before, before.smoothing.square_after, 1e-12 * figures.square_before);
  EXPECT_EQ(before.smoothing.square_after, before.smoothing.square_before);
}

TEST(PlanPass, RingsInsideACabinWindAJointAndTheNextRunsTheOtherWay) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  // The inner skin of a cabin that lies along the arm's reach, the tool radial: once round turns it by 360°.
  const auto ring = [](double x) {
    constexpr int kPoints = 100;
    constexpr double kRadius = 450;
    Pass pass;
    pass.closed = true;
    pass.rotation_reference = Eigen::Vector3d::UnitX();
    for (int t = 0; t < kPoints; ++t) {
      const double angle = 2 * kPi * t / kPoints;
      const Eigen::Vector3d out(0, std::sin(angle), std::cos(angle));
      MillingPoint point;
      point.position = Eigen::Vector3d(x, 0, 1300) + kRadius * out;
      point.normal = point.tool_axis = -out;
      point.feed = Eigen::Vector3d(0, std::cos(angle), -std::sin(angle));
      point.feed_rate = 10;
      point.arc_length = kRadius * angle;
      pass.points.push_back(point);
    }
    return pass;
  };
  std::vector<PassResult> as_laid;
  for (int p = 0; p < 3; ++p) {
    const Pass pass = ring(1900 + 20 * p);
    as_laid.push_back(PlanPass(problem, world, pass, p, 100 * p, Options(), 2, {}));
    ExpectSound(problem, Options(), pass, as_laid.back());
    ASSERT_EQ(as_laid.back().pieces.size(), 1u);
    ASSERT_TRUE(as_laid.back().pieces[0].closed);
  }
  const auto end = [](const PassResult& pass) -> Joints {  // back at the first point, turns counted
    const Joints &first = pass.points.front().q, &last = pass.points.back().q;
    return last + (first - last).unaryExpr(&ShortWay);
  };
  const Joints winding = end(as_laid[0]) - as_laid[0].points.front().q;
  EXPECT_NEAR(winding.cwiseAbs().sum(), 2 * kPi, 1e-9) << "one joint, once round";
  const Joints home = Degrees(0, -90, 90, 0, 0, 0);
  const auto turning = [&](const std::vector<PassResult>& passes) {
    double sum = 0;
    Joints at = home;
    for (const PassResult& pass : passes) {
      sum += (pass.points.front().q - at).cwiseAbs().sum();
      at = end(pass);
    }
    return sum + (home - at).cwiseAbs().sum();
  };
  std::vector<PassResult> free = as_laid;
  FixTurns(as_laid, {home, problem.bounds.lower, problem.bounds.upper, false});
  FixTurns(free, {home, problem.bounds.lower, problem.bounds.upper, true});
  EXPECT_LT(turning(free), turning(as_laid) - DegToRad(600)) << "two unwindings saved";
  for (const PassResult& pass : free) {
    for (size_t t = 1; t < pass.points.size(); ++t) {
      const Joints step = pass.points[t].q - pass.points[t - 1].q;
      EXPECT_LE(step.cwiseAbs().maxCoeff(), DegToRad(5) + 1e-9);
    }
    EXPECT_TRUE((end(pass).array() >= problem.bounds.lower.array() - 1e-9).all());
    EXPECT_TRUE((end(pass).array() <= problem.bounds.upper.array() + 1e-9).all());
  }
}

TEST(PlanPass, StopsWhenAsked) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(
      PlanPass(problem, World(EmptyCell(problem)), Row(-60, 60, 8), 0, 0, Options(), 1, source.get_token()),
      Interrupted);
}

}  // namespace
}  // namespace millpose
