// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/checkpoint_key.hpp"

#include "base/value_bytes.hpp"

namespace millpose {
namespace {

struct Inner {
  int a = 1;
  std::vector<double> list{1, 2};
};
struct Outer {
  std::string text = "x";
  Inner inner;
  std::optional<double> maybe;
  std::variant<int, Inner> one = 3;
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
};

std::string KeyOf(const auto& value) { return ValueBytes().Add(value).bytes(); }

TEST(ValueBytes, EveryFieldCounts) {
  std::vector<Outer> values(8);
  values[1].text = "";
  values[2].inner.a = 2;
  values[3].inner.list = {1, 2, 0};
  values[4].maybe = 0;
  values[5].one = Inner{};
  values[6].vector.z() = 1e-300;
  values[7].one = 4;
  for (size_t i = 0; i < values.size(); ++i)
    for (size_t j = 0; j < values.size(); ++j)
      EXPECT_EQ(KeyOf(values[i]) == KeyOf(values[j]), i == j) << i << " " << j;
}

TEST(ValueBytes, WhatIsCutElsewhereIsNotTheSame) {
  const std::vector<std::string> a{"ab", "c"}, b{"a", "bc"};
  EXPECT_NE(KeyOf(a), KeyOf(b));
}

TEST(ValueBytes, SeesAllFieldsOfWhatStagesAreHanded) {
  using value_bytes_detail::CountFields;
  static_assert(CountFields<Arm>() == 19);
  static_assert(CountFields<PathOptions>() == 17);
  static_assert(CountFields<LinkMoveOptions>() == 4);
  static_assert(CountFields<PoseProblem>() == 10);
  static_assert(CountFields<MillingPoint>() == 12);
  static_assert(CountFields<Body>() == 7);
}

PoseProblem ProblemWith(const ObjectiveParameters& parameters) {
  PoseProblem problem;
  problem.freedoms.push_back(RotationAboutTool());
  problem.objective = MakeObjective("process_force", parameters);
  return problem;
}

TEST(CheckpointKey, AForceThatTheObjectiveIsMadeWithCounts) {
  const World world{Cell{}};
  const std::string one = PassContext(ProblemWith({{"feed_N", 10}}), world, {});
  EXPECT_EQ(PassContext(ProblemWith({{"feed_N", 10}}), world, {}), one);
  EXPECT_NE(PassContext(ProblemWith({{"feed_N", 11}}), world, {}), one);
}

TEST(CheckpointKey, WhateverElseAFreedomDependsOnCounts) {
  class Steered final : public Freedom {
   public:
    explicit Steered(double by) : by_(by) {}
    std::string Name() const override { return "steered"; }
    double Lower() const override { return 0; }
    double Upper() const override { return 1; }
    bool Periodic() const override { return false; }
    std::vector<double> Parameters() const override { return {by_}; }

   private:
    double by_;
  };
  const auto key = [](double by) {
    PoseProblem problem = ProblemWith({{"feed_N", 10}});
    problem.freedoms.push_back(std::make_shared<Steered>(by));
    return PassContext(problem, World{Cell{}}, {});
  };
  EXPECT_EQ(key(1), key(1));
  EXPECT_NE(key(1), key(2));
}

TEST(CheckpointKey, WhateverAPassOrAGapIsHandedCounts) {
  const PoseProblem problem = ProblemWith({{"feed_N", 10}});
  Cell cell;
  cell.bodies.push_back({"link", BodyClass::kLink, Mount::kLink, 3, Pose::Identity(), Sphere{5}});
  const std::string pass = PassContext(problem, World(cell), {}), gap = LinkMoveContext(World(cell), {});
  const auto expect_other = [&](const auto& change) {
    Cell changed = cell;
    change(changed);
    EXPECT_NE(PassContext(problem, World(changed), {}), pass);
    EXPECT_NE(LinkMoveContext(World(changed), {}), gap);
  };
  expect_other([](Cell& c) { c.clearances.cutting += 1; });
  expect_other([](Cell& c) { c.X_WP.translation().z() = 1e-9; });
  expect_other([](Cell& c) { c.home[5] = 0.1; });
  expect_other([](Cell& c) { c.bodies[0].shape = Sphere{5.1}; });
  expect_other([](Cell& c) { c.bodies[0].link = 4; });
  expect_other([](Cell& c) { c.cutter_length = 7; });
  PoseProblem other = problem;
  other.bounds.upper[2] += 0.1;
  EXPECT_NE(PassContext(other, World(cell), {}), pass);
  PathOptions options;
  options.leave = RetractOptions{};
  EXPECT_NE(PassContext(problem, World(cell), options), pass);
  LinkMoveOptions gaps;
  gaps.seed = 2;
  EXPECT_NE(LinkMoveContext(World(cell), gaps), gap);
}

TEST(CheckpointKey, PassesAndGapsAreToldApartByPlaceAndNumber) {
  Pass pass;
  pass.points.emplace_back();
  const std::string key = PassKey("context", pass, 2, 10);
  EXPECT_EQ(PassKey("context", pass, 2, 10), key);
  EXPECT_NE(PassKey("other", pass, 2, 10), key);
  EXPECT_NE(PassKey("context", pass, 3, 10), key);
  EXPECT_NE(PassKey("context", pass, 2, 11), key) << "its points have other random streams";
  pass.points[0].feed_rate = 1;
  EXPECT_NE(PassKey("context", pass, 2, 10), key);
  const LinkMoveEnd home, piece{1, 0, Joints::Constant(0.1)};
  const std::string there = LinkMoveKey("context", home, piece);
  EXPECT_NE(LinkMoveKey("context", piece, home), there);
  for (LinkMoveEnd end : {LinkMoveEnd{2, 0, piece.q}, LinkMoveEnd{1, 1, piece.q},
                          LinkMoveEnd{1, 0, Joints::Constant(0.2)}, LinkMoveEnd{1, 0, piece.q, {5.0}}})
    EXPECT_NE(LinkMoveKey("context", home, end), there);
  LinkMove gap;
  gap.to_pass = 1, gap.to_piece = 0;
  EXPECT_TRUE(IsLinkMoveOf(gap, home, piece));
  EXPECT_FALSE(IsLinkMoveOf(gap, piece, home));
  gap.to_piece = 1;
  EXPECT_FALSE(IsLinkMoveOf(gap, home, piece));
}

TEST(CheckpointKey, APlanIsOfItsPassWhateverSplitsAddToIt) {
  Pass pass;
  for (int i = 0; i < 3; ++i) pass.points.emplace_back().position.x() = i;
  PassResult plan;
  plan.pass = 4;
  for (const int i : {0, 1, 2, 1, 2}) plan.points.emplace_back().point = pass.points[static_cast<size_t>(i)];
  EXPECT_TRUE(IsPlanOf(plan, pass, 4));
  EXPECT_FALSE(IsPlanOf(plan, pass, 3));
  pass.points[2].position.y() = 1;
  EXPECT_FALSE(IsPlanOf(plan, pass, 4));
}

TEST(CheckpointKey, APlanIsOfTheRingThatItLeavesOpenWhereverItBegins) {
  Pass pass;
  for (int i = 0; i < 4; ++i) pass.points.emplace_back().position.x() = i;
  pass.closed = true;
  pass.opening = RingOpening::kAnywhere;
  PassResult plan;
  plan.opened_at = 2;
  for (const int i : {1, 2, 3, 0, 1}) plan.points.emplace_back().point = pass.points[static_cast<size_t>(i)];
  EXPECT_TRUE(IsPlanOf(plan, pass, 0));
  plan.opened_at = 3;
  EXPECT_FALSE(IsPlanOf(plan, pass, 0));
  plan.opened_at = 4;
  EXPECT_FALSE(IsPlanOf(plan, pass, 0)) << "of a longer ring";
}

}  // namespace
}  // namespace millpose
