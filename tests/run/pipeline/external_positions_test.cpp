// SPDX-License-Identifier: GPL-3.0-or-later
// Where the external axes may stand, by what a job says of them; what no cell can do with it is refused.
#include "job/external_positions.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

void Set(const std::string& name, AxisKind kind, double lower, double upper, ExternalAxis& axis) {
  axis.name = name;
  axis.kind = kind;
  axis.lower = lower;
  axis.upper = upper;
}

/// A rail of 4 m and a table of two turns.
CellSettings RailAndTable() {
  CellSettings cell;
  cell.name = "plant";
  cell.external_axes.resize(2);
  Set("rail", AxisKind::kLinear, -1000, 3000, cell.external_axes[0]);
  Set("table", AxisKind::kRotary, -2 * kPi, 2 * kPi, cell.external_axes[1]);
  cell.external_axes[0].home = 500;
  cell.external_axes[1].home = 0.3;
  return cell;
}

JobSettings JobWith(std::vector<ExternalSettings> external) {
  JobSettings job;
  job.file = "job.yaml";
  job.external = std::move(external);
  return job;
}

ExternalSettings Entry(const std::string& axis, ExternalScope scope = ExternalScope::kPerPass) {
  ExternalSettings entry;
  entry.axis = axis;
  entry.scope = scope;
  return entry;
}

std::vector<std::string> ProblemsOf(const JobSettings& job, const CellSettings& cell = RailAndTable()) {
  std::vector<std::string> messages;
  for (const Problem& problem : CheckExternal(job, cell)) {
    EXPECT_EQ(problem.place.file, "job.yaml");
    messages.push_back(problem.message);
  }
  return messages;
}

TEST(PositionsOf, AnAxisStandsAtHomeUnlessTheJobSaysElse) {
  const CellSettings cell = RailAndTable();
  std::vector<AxisPositions> positions = PositionsOf(JobWith({}), cell);
  ASSERT_EQ(positions.size(), 2u);
  EXPECT_EQ(positions[0].values, std::vector{500.0});
  EXPECT_EQ(positions[1].values, std::vector{0.3});
  EXPECT_FALSE(positions[0].per_pass || positions[1].per_pass);
  ExternalSettings rail = Entry("rail", ExternalScope::kConstant), table = Entry("table");
  rail.at_mm = 750;
  table.at_deg = -0.2;
  positions = PositionsOf(JobWith({table, rail}), cell);  // by name, whatever their order
  EXPECT_EQ(positions[0].values, std::vector{750.0});
  EXPECT_EQ(positions[1].values, std::vector{-0.2});
  EXPECT_FALSE(positions[0].per_pass);
  EXPECT_TRUE(positions[1].per_pass);
}

// Ends included, evenly, no two neighbours farther apart than asked, and with one position less they would
// be.
TEST(PositionsOf, CoverTheRangeWithAsFewPositionsAsTheStepAllows) {
  RandomStream random(1, 0);
  for (int k = 0; k < 200; ++k) {
    CellSettings cell = RailAndTable();
    const double lower = random.Uniform(-4000, 0), upper = lower + random.Uniform(1, 5000);
    const double low = random.Uniform(-3, 0), high = low + random.Uniform(0.1, 2 * kPi - 0.1);
    Set("rail", AxisKind::kLinear, lower, upper, cell.external_axes[0]);
    Set("table", AxisKind::kRotary, low, high, cell.external_axes[1]);
    ExternalSettings rail = Entry("rail"), table = Entry("table");
    const double mm = random.Uniform(20, 3000), rad = random.Uniform(0.02, 2);
    if (k % 2 == 0) rail.step_mm = mm;
    if (k % 3 == 0) table.step_deg = rad;
    const std::vector<AxisPositions> positions = PositionsOf(JobWith({rail, table}), cell);
    const auto expect = [](const std::vector<double>& values, double from, double to, double step) {
      ASSERT_GE(values.size(), 2u);
      EXPECT_EQ(values.front(), from);
      EXPECT_NEAR(values.back(), to, 1e-9);
      const double even = (to - from) / static_cast<double>(values.size() - 1);
      for (size_t i = 1; i < values.size(); ++i) EXPECT_NEAR(values[i] - values[i - 1], even, 1e-9);
      EXPECT_LE(even, step + 1e-8);
      if (values.size() == 2) return;
      EXPECT_GT((to - from) / static_cast<double>(values.size() - 2), step - 1e-8);
    };
    expect(positions[0].values, lower, upper, rail.step_mm.value_or((upper - lower) / 8));
    expect(positions[1].values, low, high, table.step_deg.value_or(DegToRad(30)));
  }
}

// Both ends of a full turn are one position, and a second turn brings no other.
TEST(PositionsOf, OfATableThatTurnsOnAreOneTurnAboutHome) {
  for (const double home : {0.0, 0.3, 2 * kPi, -2 * kPi}) {
    CellSettings cell = RailAndTable();
    cell.external_axes[1].home = home;
    const std::vector<double> values = PositionsOf(JobWith({Entry("table")}), cell)[1].values;
    ASSERT_EQ(values.size(), 12u);
    for (size_t i = 0; i < values.size(); ++i) {
      EXPECT_GE(values[i], -2 * kPi - 1e-12);
      EXPECT_LE(values[i], 2 * kPi + 1e-12);
      EXPECT_LE(std::abs(values[i] - home), 2 * kPi);
      for (size_t j = 0; j < i; ++j)
        EXPECT_GT(std::abs(std::remainder(values[i] - values[j], 2 * kPi)), DegToRad(29.9));
    }
  }
}

TEST(CheckExternal, TakesWhatTheCellHas) {
  ExternalSettings rail = Entry("rail", ExternalScope::kConstant), table = Entry("table");
  EXPECT_TRUE(ProblemsOf(JobWith({})).empty());
  EXPECT_TRUE(ProblemsOf(JobWith({rail, table})).empty());
  rail.at_mm = 3000;  // the limits themselves
  table.at_deg = -2 * kPi;
  EXPECT_TRUE(ProblemsOf(JobWith({rail, table})).empty());
}

TEST(CheckExternal, NamesEntryGivenAndAllowed) {
  ExternalSettings wrong_unit = Entry("rail"), turned = Entry("table"), far = Entry("rail");
  wrong_unit.at_deg = 0.1;
  wrong_unit.step_deg = 0.1;
  turned.step_mm = 5;
  EXPECT_EQ(ProblemsOf(JobWith({wrong_unit, turned})),
            (std::vector<std::string>{
                "external[0].at_deg: has no effect here: axis rail is linear; allowed: at_mm",
                "external[0].step_deg: has no effect here: axis rail is linear; allowed: step_mm",
                "external[1].step_mm: has no effect here: axis table is rotary; allowed: step_deg"}));
  far.at_mm = 3000.5;
  turned = Entry("table");
  turned.at_deg = DegToRad(-361);
  EXPECT_EQ(ProblemsOf(JobWith({far, turned})),
            (std::vector<std::string>{
                "external[0].at_mm: given 3000.5; allowed: -1000 to 3000, the limits of rail",
                "external[1].at_deg: given -361; allowed: -360 to 360, the limits of table"}));
  EXPECT_EQ(ProblemsOf(JobWith({Entry("rial"), Entry("rail"), Entry("rail")})),
            (std::vector<std::string>{
                "external[0].axis: given 'rial'; allowed: the external axes of cell plant: rail, table; did "
                "you mean 'rail'?",
                "external[2].axis: given rail twice"}));
  CellSettings none;
  none.name = "plain";
  EXPECT_EQ(ProblemsOf(JobWith({Entry("rail")}), none),
            std::vector<std::string>{
                "external[0].axis: given 'rail'; allowed: the external axes of cell plain: it has none"});
}

TEST(CheckExternal, MoreThanTwoThousandPositionsOfAllAxesAreTooMany) {
  ExternalSettings rail = Entry("rail"), table = Entry("table", ExternalScope::kConstant);
  rail.step_mm = 16;           // 251 positions
  table.step_deg = kPi / 3.5;  // 7
  EXPECT_TRUE(ProblemsOf(JobWith({rail, table})).empty());
  table.step_deg = kPi / 4;
  EXPECT_EQ(ProblemsOf(JobWith({rail, table})),
            std::vector<std::string>{
                "external: given steps make 2008 positions; allowed: up to 2000, with larger steps"});
}

}  // namespace
}  // namespace millpose::test
