// SPDX-License-Identifier: GPL-3.0-or-later
// Passes that have to be split.
#include "tests/base/tier.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

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
  explicit HeldRotation(double middle) : middle_(middle), rotation_(RotationAboutTool()) {}
  std::string Name() const override { return "held rotation"; }
  double Lower() const override { return middle_ - DegToRad(4); }
  double Upper() const override { return middle_ + DegToRad(4); }
  bool Periodic() const override { return false; }
  bool IsToolRotation() const override { return true; }
  Pose Apply(const Pose& X_WT, double value) const override { return rotation_->Apply(X_WT, value); }

 private:
  double middle_;
  FreedomPointer rotation_;
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
          reached |= unsigned{at.obstacle == Infeasibility::kNone} << branch;
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

TEST(PlanPass, SplitsWhereNoStepIsSmallEnough) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  Pass pass = Row(-60, 60, 24);
  for (int t = 10; t < 24; ++t) {  // a crease of 35°
    const Eigen::AngleAxisd turn(DegToRad(35), Eigen::Vector3d::UnitZ());
    pass.points[t].normal = pass.points[t].tool_axis = turn * pass.points[t].normal;
  }
  const PassResult result = PlanPass(problem, world, {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_EQ(result.pieces[0].last, 9);
  EXPECT_EQ(result.pieces[1].first, 10);
  EXPECT_EQ(result.uncut, std::vector<int>{9});  // no pose on either side reaches over the crease
}

/// A ring on the inside of a cabin about the arm: A1 goes round once, its limits allow hardly more.
Pass RingAboutTheArm() {
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
  return pass;
}

PathOptions CoarseOptions() {
  PathOptions options = Options();
  options.rotation_step = DegToRad(4);
  return options;
}

TEST(PlanPass, UnwindsWhereAJointRunsOutOfTurns) {
  PoseProblem problem = MakeProblem(Kr500R2830(), 1);
  const Pass pass = RingAboutTheArm();
  const PathOptions options = CoarseOptions();
  const PassResult result = PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = 2});
  ExpectSound(problem, options, pass, result);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_FALSE(result.pieces[0].closed);
  EXPECT_TRUE(result.uncut.empty());
  for (size_t t = 0; t < pass.points.size(); ++t) EXPECT_TRUE(IsCut(pass, result, t)) << t;
  // The same ring with a joint that may turn on needs no split.
  problem.bounds.lower[0] = DegToRad(-400);
  problem.bounds.upper[0] = DegToRad(400);
  const PassResult free = PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = 2});
  ExpectSound(problem, options, pass, free);
  ASSERT_EQ(free.pieces.size(), 1u);
  EXPECT_TRUE(free.pieces[0].closed);
}

TEST(PlanPass, LeadsOfTheJobFollowBeyondTheOverlapOfASplit) {
  const PoseProblem problem = MakeProblem(Kr500R2830(), 1);
  const Pass pass = RingAboutTheArm();
  const auto height = [](const PlannedPoint& point) { return 1900 - point.point.position.head<2>().norm(); };
  for (const LeadShape shape : {LeadShape::kRamp, LeadShape::kArc}) {
    if (shape == LeadShape::kArc && OfTier(1, 0)) continue;
    PathOptions options = CoarseOptions();
    options.ends.lead = shape;
    options.ends.lead_length = 40;
    const PassResult result = PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = 2});
    ExpectSound(problem, options, pass, result);
    ASSERT_GE(result.pieces.size(), 2u);
    EXPECT_TRUE(result.uncut.empty());
    for (size_t t = 0; t < pass.points.size(); ++t) EXPECT_TRUE(IsCut(pass, result, t)) << t;
    size_t leads = 0;
    for (const Segment& piece : result.pieces) {
      // From the piece's ends inwards: off the surface, ever nearer to it, then what is cut twice, then the
      // cut.
      for (const int step : {1, -1}) {
        const PointKind kind = step > 0 ? PointKind::kLeadIn : PointKind::kLeadOut;
        int t = step > 0 ? piece.first : piece.last;
        if (result.points[t].point.kind != kind) continue;
        ++leads;
        EXPECT_GT(height(result.points[t]), 5) << "begins in the air";
        for (; height(result.points[t]) > 1e-6; t += step) {
          EXPECT_EQ(result.points[t].point.kind, kind);
          EXPECT_LT(height(result.points[t + step]), height(result.points[t]) + 1e-9);
        }
        EXPECT_EQ(result.points[t].point.kind, kind) << "cut twice";
      }
    }
    EXPECT_EQ(leads, result.pieces.size()) << "one at each split, that where the ring begins among them";
  }
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
  const PassResult result = PlanPass(problem, world, {pass}, options, {.threads = 2});
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
  const PassResult result = PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = 2});
  ExpectSound(problem, options, pass, result);  // every piece keeps its branch
  EXPECT_GE(result.pieces.size(), 2u);
  int singular = 0, before = 0, after = 0;
  for (size_t t = 0; t < result.points.size(); ++t) {
    const PlannedPoint& point = result.points[t];
    singular += point.skip == Infeasibility::kSingular;
    if (point.skip != Infeasibility::kNone) continue;
    EXPECT_GE(DistanceToSingularity(problem.arm, point.q).wrist, 0.05 - 1e-9);
    ++(t < 20 ? before : after);
  }
  EXPECT_GE(singular, 1);
  EXPECT_LE(singular, 10);
  EXPECT_GE(before, 14);
  EXPECT_GE(after, 14);
}

}  // namespace
}  // namespace millpose
