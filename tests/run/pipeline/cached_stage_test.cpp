// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/cached_stage.hpp"

#include "machine/robot/kinematics.hpp"
#include "run/pipeline/stages/lay_path.hpp"
#include "store/plan_key.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/planning/result/every_field.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose {
namespace {

struct Item {
  std::string text;
  std::optional<double> maybe;
  std::array<Eigen::Vector3d, 2> ends{Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
  Pose pose = Pose::Identity();
  bool operator==(const Item& other) const {
    return text == other.text && maybe == other.maybe && ends == other.ends &&
           pose.matrix() == other.pose.matrix();
  }
};
struct Outcome {
  std::vector<Item> items;
  std::map<uint32_t, std::optional<Item>> by_number;
  std::vector<uint16_t> numbers;
  std::vector<std::vector<char>> marks;
  std::pair<Infeasibility, int> pair{Infeasibility::kStep, 3};
  bool operator==(const Outcome&) const = default;
};

Outcome SomeOutcome() {
  Outcome outcome;
  outcome.items = {{"a", 1.0 / 3, {}, {}}, {"", std::nullopt, {}, {}}};
  outcome.items[0].pose.translation().x() = 5;
  outcome.by_number[7] = std::nullopt;
  outcome.by_number[9] = outcome.items[0];
  outcome.numbers = {1, 65535};
  outcome.marks = {{}, {1, 0}};
  return outcome;
}

TEST(ValueReader, ReadsBackWhatWasWritten) {
  const Outcome outcome = SomeOutcome();
  const std::string bytes = ValueBytes().Add(outcome).bytes();
  Outcome back;
  ASSERT_TRUE(ValueReader(bytes).Read(back));
  EXPECT_EQ(back, outcome);
  for (size_t cut = 0; cut < bytes.size(); ++cut) {
    Outcome damaged;
    EXPECT_FALSE(ValueReader(std::string_view(bytes).substr(0, cut)).Read(damaged)) << cut;
  }
  EXPECT_FALSE(ValueReader(bytes + "x").Read(back));
}

TEST(ValueReader, NothingOfAPlanIsLost) {
  RandomStream random(1, 0);
  PlanResult plan, back;
  every_field::Fill(plan, random);
  ASSERT_TRUE(ValueReader(ValueBytes().Add(plan.passes[1]).bytes()).Read(back.passes.emplace_back()));
  EXPECT_TRUE(every_field::Same(back.passes[0], plan.passes[1]));
  ASSERT_TRUE(ValueReader(ValueBytes().Add(plan.gaps[1]).bytes()).Read(back.gaps.emplace_back()));
  EXPECT_TRUE(every_field::Same(back.gaps[0], plan.gaps[1]));
}

TEST(ValueReader, KnowsWhatStagesReturn) {
  using value_bytes_detail::CountFields;
  static_assert(CountFields<PlannedPoint>() == 30);
  static_assert(CountFields<PlanResult>() == 16);
  static_assert(CountFields<CheckedProgram>() == 12);
  static_assert(CountFields<StartProgram>() == 6);
  static_assert(CountFields<NearestPair>() == 4);
  static_assert(CountFields<PackedCurve>() == 8);
  static_assert(CountFields<FixedComparison>() == 10);
  static_assert(CountFields<JobToolpath>() == 8);
}

TEST(ValueBytes, HashesInPartsAsAWhole) {
  const std::vector<double> numbers(50000, 0.5);
  EXPECT_EQ(HashOfValues(numbers, 3), Hash(ValueBytes().Add(numbers, 3).bytes()));
  EXPECT_NE(HashOfValues(numbers, 3), HashOfValues(numbers, 4));
}

TEST(Cached, WorksAStageOutAgainOnlyWhereItIsHandedSomethingElse) {
  const test::MemoryCheckpoints store;
  int made = 0;
  const auto stage = [&](double handed) {
    return Cached<Outcome>(store, "stage", StageKey(handed), [&] {
      ++made;
      Outcome outcome = SomeOutcome();
      outcome.items[0].maybe = handed;
      return outcome;
    });
  };
  EXPECT_EQ(stage(1).items[0].maybe, 1);
  EXPECT_EQ(stage(1).items[0].maybe, 1);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(stage(2).items[0].maybe, 2);
  EXPECT_EQ(made, 2);
  EXPECT_EQ(stage(1).items[0].maybe, 1);
  EXPECT_EQ(stage(2).items[0].maybe, 2);
  EXPECT_EQ(made, 2) << "the one before is kept too";
  EXPECT_EQ(stage(3).items[0].maybe, 3);
  EXPECT_EQ(stage(1).items[0].maybe, 1) << "the last two alone are kept";
  EXPECT_EQ(made, 4);
  store.stages["stage"][0].second.pop_back();
  EXPECT_EQ(stage(3).items[0].maybe, 3);
  EXPECT_EQ(stage(1).items[0].maybe, 1);
  EXPECT_EQ(made, 5) << "damaged";
}

TEST(CachedInWorld, WorksAStageOutAgainOnlyWhereAnAnswerMayBeAnother) {
  const test::MemoryCheckpoints store;
  int made = 0;
  Cell cell = test::SampleCell();
  const auto post_at = [&](double y) { cell.bodies.back().X_MG = test::At(1500, y, 100); };
  const auto stage = [&](const std::string& key, double pose) {
    return CachedInWorld<double>(
        store, "stage", key, Stations(World(cell), {}), [&](const Stations& stations) {
          ++made;
          Checker checker(stations.At({}).world);
          return checker.Clearance(test::Degrees(0, -60, 90, 0, 60, pose), Phase::kFree, 200);
        });
  };
  cell.bodies.push_back({"post", BodyClass::kFixture, Mount::kWorld, 0, Pose::Identity(), Sphere{50}});
  post_at(3000);
  const double far = stage("a", 0);
  EXPECT_EQ(stage("a", 0), far);
  post_at(4000);
  EXPECT_EQ(stage("a", 0), far);
  EXPECT_EQ(made, 1);
  stage("b", 0);
  EXPECT_EQ(made, 2) << "handed something else";
  cell.bodies.back().X_MG = ForwardFlange(cell.arm, test::Degrees(0, -60, 90, 0, 60, 0));  // in its way
  EXPECT_LT(stage("b", 0), far);
  EXPECT_EQ(made, 3);
  post_at(4000);
  EXPECT_EQ(stage("b", 0), far);
  EXPECT_EQ(made, 3) << "what was there before it stood in the way";
  store.stages["stage"].pop_back();
  EXPECT_EQ(stage("b", 0), far);
  EXPECT_EQ(made, 4) << "the answer told of it";
  cell.bodies[0].shape = Sphere{10};  // no obstacle: a link
  stage("b", 0);
  EXPECT_EQ(made, 5);
  store.stages["stage"][0].second.pop_back();
  stage("b", 0);
  EXPECT_EQ(made, 6) << "damaged";
}

TEST(CachedInWorld, OfACellWithExternalAxesWhateverStandsInItCounts) {
  const test::MemoryCheckpoints store;
  int made = 0;
  Cell cell = test::SampleCell();
  cell.external_axes.emplace_back().name = "rail";
  const auto stage = [&] {
    CachedInWorld<int>(store, "stage", "key", Stations(World(cell), {}),
                       [&](const Stations&) { return ++made; });
  };
  stage();
  stage();
  EXPECT_EQ(made, 1);
  cell.bodies.back().X_MG = test::At(0, 5000, -200);
  stage();
  EXPECT_EQ(made, 2);
}

TEST(PlanKey, SeesEveryFieldButTheHashThatNamesThePlanAndWhatGapsTook) {
  PlanResult plan;
  plan.passes.resize(2);
  plan.passes[1].points.resize(3);
  std::vector<std::string> keys{KeyOf(plan, 1)};
  const auto change = [&](auto what) {
    PlanResult changed = plan;
    what(changed);
    EXPECT_EQ(KeyOf(changed, 1), KeyOf(changed, 4));
    keys.push_back(KeyOf(changed, 2));
  };
  change([](PlanResult& p) { p.job = "x"; });
  change([](PlanResult& p) { p.home[2] = 1e-300; });
  change([](PlanResult& p) { p.gaps.emplace_back(); });
  change([](PlanResult& p) { p.gaps.emplace_back().joints.emplace_back(Joints::Zero()); });
  change([](PlanResult& p) { p.passes.pop_back(); });
  change([](PlanResult& p) { p.passes[1].points[2].verdicts = {0, 1}; });
  change([](PlanResult& p) { p.passes[1].points[2].exhaustive_optimum = 1; });
  change([](PlanResult& p) { p.passes[1].points[2].compensation.emplace(); });
  change([](PlanResult& p) { std::swap(p.passes[0], p.passes[1]); });
  std::ranges::sort(keys);
  EXPECT_EQ(std::ranges::adjacent_find(keys), keys.end());
  PlanResult named = plan;
  named.input_hash = "other";
  EXPECT_EQ(KeyOf(named, 1), KeyOf(plan, 1));
  named.gaps.resize(1);
  plan.gaps.resize(1);
  named.gaps[0].poses_checked = 7;  // that summaries alone count
  EXPECT_EQ(KeyOf(named, 1), KeyOf(plan, 1));
}

}  // namespace
}  // namespace millpose
