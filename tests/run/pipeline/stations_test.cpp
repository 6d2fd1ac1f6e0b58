// SPDX-License-Identifier: GPL-3.0-or-later
// Where the external axes stand for each pass: chosen from the job's positions, and left again for another
// where a pass is planned better there.
#include "base/value_bytes.hpp"
#include "job/assemble.hpp"
#include "job/external_positions.hpp"
#include "planning/result/pass_value.hpp"
#include "planning/result/skipped.hpp"
#include "run/pipeline/stages/choose_stations.hpp"
#include "run/pipeline/stages/other_stations.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

/// The small job in the sample cell with a rail of 4 m, the pad `y` mm along it.
JobInputs RailInputs(const std::string& external, double y = 0, std::vector<Override> more = {}) {
  more.insert(more.end(), {{"cell", "../../cells/kr500_rail.yaml"},
                           {"programs", "[]"},
                           {"external", external},
                           {"workpiece.pose.xyz_mm", fmt::format("[2076, {}, 1006]", y)}});
  return SmallInputs(more);
}

PlannedJob Planned(const JobInputs& inputs) { return PlanJob(inputs, NoCheckpoints(), {.threads = 2}); }

StationChoices Choices(const JobInputs& inputs, const PreparedJob& prepared, int threads = 1) {
  return ChooseStations(inputs, prepared.stations.AtOwnAxis(), {.threads = threads}, prepared.made.toolpath);
}

/// The worst point's objective in a plan; none where a point is skipped.
std::optional<double> WorstOf(const PlannedJob& job) {
  double worst = 0;
  for (const PassResult& pass : job.plan.passes) {
    if (CountSkipped(pass) > 0) return std::nullopt;
    worst = std::max(worst, ValueOf(pass).worst);
  }
  return worst;
}

TEST(ChooseStations, WithoutExternalAxesThereIsNothingToChoose) {
  const PreparedJob& prepared = FreshPlan().prepared;
  const StationChoices choices = Choices(SmallInputs(), prepared);
  EXPECT_EQ(choices.external, std::vector<ExternalCourse>(prepared.toolpath.passes.size()));
  EXPECT_TRUE(choices.warnings.empty());
  for (const auto& next : choices.elsewhere) EXPECT_TRUE(next.empty());
}

TEST(ChooseStations, AGivenPositionIsThatOfEveryPass) {
  const JobInputs inputs = RailInputs("[{axis: rail, scope: constant, at_mm: 125}]");
  const StationChoices choices = Choices(inputs, PrepareJob(inputs, NoCheckpoints(), {.threads = 1}));
  for (const ExternalCourse& course : choices.external) EXPECT_EQ(course, StandingAt({125}));
  for (const auto& next : choices.elsewhere) EXPECT_TRUE(next.empty());
}

// The pad stands where only one half of the rail leads: what is chosen is planned without a loss, and no
// position of the job's is better by more than joining poses costs, which scores do not know.
TEST(ChooseStations, WhatIsChosenIsAsGoodAsWhatPlanningEveryPositionFinds) {
  const PlannedJob chosen = Planned(RailInputs("[{axis: rail, scope: constant}]", 1400));
  ASSERT_EQ(chosen.prepared.external.size(), 2u);
  EXPECT_EQ(chosen.prepared.external[0], chosen.prepared.external[1]) << "constant: one for the whole job";
  ASSERT_TRUE(WorstOf(chosen));
  size_t lossless = 0, lossy = 0;
  double best = std::numeric_limits<double>::infinity();
  for (int at = -2000; at <= 2000; at += 500) {
    const PlannedJob there =
        Planned(RailInputs(fmt::format("[{{axis: rail, scope: constant, at_mm: {}}}]", at), 1400));
    const std::optional<double> worst = WorstOf(there);
    ++(worst ? lossless : lossy);
    if (worst) best = std::min(best, *worst);
    if (there.prepared.external == chosen.prepared.external) {
      EXPECT_EQ(HashOfValues(there.plan.passes[0]), HashOfValues(chosen.plan.passes[0]));
    }
  }
  EXPECT_GE(lossless, 2u);
  EXPECT_GE(lossy, 2u);
  EXPECT_LE(*WorstOf(chosen), 1.1 * best);
}

TEST(ChooseStations, EveryPassHasOthersToTryAndThreadsDoNotMatter) {
  const JobInputs inputs = RailInputs("[{axis: rail, scope: per_pass}]");
  const PreparedJob prepared = PrepareJob(inputs, NoCheckpoints(), {.threads = 2});
  const StationChoices one = Choices(inputs, prepared), four = Choices(inputs, prepared, 4);
  EXPECT_EQ(one.external, four.external);
  EXPECT_EQ(one.elsewhere, four.elsewhere);
  const std::vector<double> given = PositionsOf(inputs.job, inputs.cell)[0].values;
  for (size_t p = 0; p < one.external.size(); ++p) {
    std::vector<ExternalCourse> all = one.elsewhere[p];
    EXPECT_EQ(all.size(), 3u);
    all.push_back(one.external[p]);
    for (size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(std::ranges::count(given, all[i].from[0]), 1) << "one of the job's";
      EXPECT_EQ(std::ranges::count(all, all[i]), 1) << "each once";
    }
  }
}

/// A fixture over the whole rail, or over a part of it: at home the arm stands in it.
JobInputs Walled(double y, double length, const std::string& external) {
  JobInputs inputs = RailInputs(external);
  BodySettings& wall = inputs.cell.bodies.emplace_back();
  wall.name = "wall";
  wall.shape.size = {300, length, 200};
  wall.pose.position = {900, y, 2500};
  return inputs;
}

TEST(ChooseStations, PositionsWhereTheArmStandsInSomethingAreLeftOut) {
  const std::string rail = "[{axis: rail, scope: per_pass}]";
  const JobInputs inputs = Walled(-2400, 5000, rail);  // up to y = 100
  const StationChoices choices = Choices(inputs, PrepareJob(inputs, NoCheckpoints(), {.threads = 1}));
  for (size_t p = 0; p < choices.external.size(); ++p) {
    EXPECT_GT(choices.external[p].from[0], 100);
    for (const ExternalCourse& next : choices.elsewhere[p]) EXPECT_GT(next.from[0], 100);
  }
  const std::string refusal =
      RefusalOf([&] { PrepareJob(Walled(0, 9000, rail), NoCheckpoints(), {.threads = 1}); });
  EXPECT_NE(refusal.find("external: none of the positions is free; at rail -2000 mm: at home "),
            std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find("wall"), std::string::npos) << refusal;
}

TEST(ChooseStations, AGivenPositionThatIsNotFreeIsAWarning) {
  const JobInputs inputs = Walled(0, 9000, "[{axis: rail, scope: constant, at_mm: 125}]");
  const StationChoices choices = Choices(inputs, PrepareJob(inputs, NoCheckpoints(), {.threads = 1}));
  ASSERT_EQ(choices.warnings.size(), 1u);
  EXPECT_NE(choices.warnings[0].find("with the external axes at rail 125 mm at home "), std::string::npos)
      << choices.warnings[0];
}

/// Passes planned where the job says, to be planned again elsewhere.
class Elsewhere {
 public:
  explicit Elsewhere(double at)
      : inputs_(RailInputs(fmt::format("[{{axis: rail, scope: constant, at_mm: {}}}]", at), 1400)),
        job(Planned(inputs_)) {
    job.prepared.elsewhere.assign(job.plan.passes.size(), {});
  }
  /// Of pass 0 alone.
  void Try(const std::vector<ExternalPosition>& next, bool wanted = true) {
    job.prepared.elsewhere[0].clear();
    for (const ExternalPosition& external : next) job.prepared.elsewhere[0].push_back(StandingAt(external));
    PlanOtherStations(
        inputs_, job.prepared, kept, [&](size_t) { return wanted; }, {.threads = 1}, job.plan.passes);
  }

 private:
  JobInputs inputs_;

 public:
  PlannedJob job;
  MemoryCheckpoints kept;
};

TEST(PlanOtherStations, APassMovesToTheStationThatServesItBest) {
  Elsewhere far(-2000);  // out of the pad's reach
  ASSERT_GT(CountSkipped(far.job.plan.passes[0]), 0u);
  const std::string other = HashOfValues(far.job.plan.passes[1]);
  far.Try({{-1900}, {1500}, {500}});
  const PassResult& moved = far.job.plan.passes[0];
  EXPECT_EQ(CountSkipped(moved), 0u);
  EXPECT_EQ(moved.external, ExternalPosition{1500});
  EXPECT_EQ(far.job.prepared.external[0], StandingAt({1500}));
  EXPECT_EQ(HashOfValues(far.job.plan.passes[1]), other) << "nothing else was offered";
  // The part stands where it stood, the base elsewhere: points and path are those of the new station.
  const Toolpath& toolpath = far.job.prepared.toolpath;
  for (const PlannedPoint& point : moved.points)
    EXPECT_TRUE(std::ranges::any_of(toolpath.passes[0].points, [&](const MillingPoint& laid) {
      return (laid.position - point.point.position).norm() < 1e-9;
    }));
}

TEST(PlanOtherStations, WhatIsNoBetterOrNotAskedForStays) {
  Elsewhere far(-2000);
  const std::string before = HashOfValues(far.job.plan.passes[0]);
  far.Try({{1500}}, false);
  EXPECT_EQ(far.kept.writes, 0);
  far.Try({{-1900}});  // hardly nearer
  EXPECT_EQ(far.kept.writes, 1) << "it was tried";
  EXPECT_EQ(HashOfValues(far.job.plan.passes[0]), before);
  EXPECT_EQ(far.job.prepared.external[0], StandingAt({-2000}));
}

// A gouge is one everywhere: no station is planned for it.
TEST(PlanOtherStations, PointsThatNoStationCouldServeAskForNone) {
  Elsewhere near(1500);
  PassResult& pass = near.job.plan.passes[0];
  ASSERT_EQ(CountSkipped(pass), 0u);
  for (PlannedPoint& point : pass.points) point.objective = point.own_optimum;  // joining them costs nothing
  pass.points[1].skip = Infeasibility::kGouge;
  near.Try({{1000}});
  EXPECT_EQ(near.kept.writes, 0);
  pass.points[1].skip = Infeasibility::kInterference;
  near.Try({{1000}});
  EXPECT_EQ(near.kept.writes, 1);
}

// With the worst point first, a pass that pays more than a tenth of its own optimum for joining its poses.
TEST(PlanOtherStations, APassThatPaysForJoiningItsPosesTriesOthersToo) {
  Elsewhere near(1500);
  PassResult& pass = near.job.plan.passes[0];
  for (PlannedPoint& point : pass.points) point.objective = 1.09 * point.own_optimum;
  near.Try({{1000}});
  EXPECT_EQ(near.kept.writes, 0);
  for (PlannedPoint& point : pass.points) point.objective = 1.11 * point.own_optimum;
  near.Try({{1000}});
  EXPECT_EQ(near.kept.writes, 1);
}

}  // namespace
}  // namespace millpose::test
