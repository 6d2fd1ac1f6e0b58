// SPDX-License-Identifier: GPL-3.0-or-later
// Readings made from a plan's own prediction come back as the factors that they were made with.
#include "run/pipeline/commands/calibrate_part.hpp"

#include <nlohmann/json.hpp>

#include "job/assemble.hpp"
#include "report/deflection.hpp"
#include "run/pipeline/outputs/run.hpp"
#include "store/output_folder.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

/// A reading at a cut point: where it is in P, what is predicted there along the normal, what of that is
/// taken out (mm), and by which side of the cut it was left.
struct Place {
  Eigen::Vector3d position;
  double predicted = 0, taken = 0;
  CutSide side = CutSide::kDown;
};

/// The small job with narrower steps, so that it mills up and down, planned into a folder.
class MilledPart {
 public:
  MilledPart(const std::string& folder, const Override& more) : folder_(folder) {
    CopySmallJob(folder_);
    folder_.Change("job.yaml", "stepover_mm: 40", "stepover_mm: 16");
    PlanArguments arguments;
    arguments.job = folder_.path() / "job.yaml";
    arguments.threads = 2;
    arguments.overrides = {{"programs", "[]"}, more};
    RunPlan(arguments, Silent(), {});
  }

  std::vector<Place> Places() const {
    const PlanResult plan = ParsePlanFile(ReadFile(out() / kPlanFile), "plan");
    const JobInputs inputs = LoadJobInputs(out() / "job.yaml");
    std::vector<Place> places;
    std::vector<const PlannedPoint*> points;
    for (const PassResult& pass : plan.passes)
      for (const PlannedPoint& point : pass.points) points.push_back(&point);
    for (const DeflectedPoint& point : PredictDeflections(plan, {}, MakeCompliances(inputs.cell)).points) {
      const auto& shift = points[point.number]->compensation;
      if (point.engagement.side == CutSide::kAir) continue;
      places.push_back({plan.X_WP.inverse() * points[point.number]->point.position,
                        shift ? shift->normal.expected : point.deflection.normal,
                        shift ? shift->normal.taken : 0, point.engagement.side});
    }
    return places;
  }

  /// A row for each place, `error(place)` in mm, `off` mm beside it.
  CalibratedPart Calibrated(const std::function<double(const Place&)>& error, double off = 0) const {
    std::string rows = "x_mm,y_mm,z_mm,error_um\n";
    for (const Place& place : Places())
      rows += fmt::format("{},{},{},{}\n", place.position.x(), place.position.y(), place.position.z() + off,
                          1000 * error(place));
    return Calibrated(rows);
  }
  CalibratedPart Calibrated(const std::string& rows) const {
    folder_.Write("measured.csv", rows);
    return CalibratePart({folder_.path() / "measured.csv", out(), {}});
  }
  std::filesystem::path out() const { return folder_.path() / "support_pad.out"; }
  const TestFolder& folder() const { return folder_; }

 private:
  TestFolder folder_;
};

const MilledPart& Milled() {
  static const MilledPart part("calibrate",
                               Override{"process.force_factors", "{up: 1.1, down: 0.9, slot: 1}"});
  return part;
}

TEST(CalibratePart, FindsTheFactorOfEachSideWhereverTheFaceStands) {
  const auto truth = [](CutSide side) { return side == CutSide::kUp ? 1.4 : 0.8; };
  const CalibratedPart part = Milled().Calibrated(
      [&](const Place& place) { return 0.03 + truth(place.side) * place.predicted; }, 0.25);
  // Factors of the next plan are those of this one times what was found.
  size_t determined = 0;
  for (const auto& [side, given, next] :
       {std::tuple(CutSide::kUp, 1.1, part.factors.up), std::tuple(CutSide::kDown, 0.9, part.factors.down)}) {
    const CalibratedFactor& found = part.found.sides[static_cast<size_t>(side)];
    determined += found.determined ? 1 : 0;
    EXPECT_NEAR(next, given * (found.determined ? truth(side) : part.found.scale.value), 1e-6);
  }
  EXPECT_GE(determined, 1u);
  EXPECT_NEAR(part.farthest, 0.25, 1e-9);
}

// Of a side that the readings do not tell, the factor of all of them is taken.
TEST(CalibratePart, ASideWithoutReadingsFollowsTheRest) {
  const CalibratedPart part = Milled().Calibrated([](const Place& place) { return 1.2 * place.predicted; });
  const CalibratedFactor& slot = part.found.sides[static_cast<size_t>(CutSide::kSlot)];
  ASSERT_FALSE(slot.determined);
  EXPECT_NEAR(part.found.scale.value, 1.2, 1e-6);
  EXPECT_NEAR(part.factors.slot, 1.2, 1e-6);
}

TEST(CalibratePart, PlacesThatAreReadTwiceTellHowWellReadingsRepeat) {
  const std::vector<Place> places = Milled().Places();
  std::string rows = "x_mm,y_mm,z_mm,error_um\n";
  for (const Place& place : places)
    for (const double error : {-3.0, 3.0})
      rows += fmt::format("{},{},{},{}\n", place.position.x(), place.position.y(), place.position.z(),
                          1000 * place.predicted + error);
  const CalibratedPart part = Milled().Calibrated(rows);
  ASSERT_TRUE(part.found.repeatability);
  EXPECT_NEAR(*part.found.repeatability, 0.003 * std::sqrt(2), 1e-9);
  EXPECT_FALSE(Milled().Calibrated([](const Place&) { return 0.0; }).found.repeatability);
}

TEST(CalibratePart, WhatACompensatedPlanTookOutCountsAsNotMilled) {
  const MilledPart part("calibrate_shifted", Override{"compensation", "{deflection: normal, shrink: 0.5}"});
  const std::vector<Place> places = part.Places();
  EXPECT_TRUE(std::ranges::any_of(places, [](const Place& place) { return place.taken != 0; }));
  const CalibratedPart found =
      part.Calibrated([](const Place& place) { return 1.3 * place.predicted - place.taken; });
  EXPECT_NEAR(found.found.scale.value, 1.3, 1e-3);
}

TEST(CalibratePart, ReadingsThatCannotBeOfThisPartAreNamedTogether) {
  const Eigen::Vector3d p = Milled().Places()[0].position;
  const std::string rows =
      fmt::format("x_mm,y_mm,z_mm,error_um\n{0},{1},{2},5\n{0},{1},{3},5\n{0},{1},{2},2e5\n", p.x(), p.y(),
                  p.z(), p.z() + 21);
  const std::string refusal = RefusalOf([&] { Milled().Calibrated(rows); });
  EXPECT_EQ(refusal.find("measured.csv:2"), std::string::npos) << refusal;
  EXPECT_NE(
      refusal.find("measured.csv:3: the place is 21 mm from the nearest cut point of the plan's finished "
                   "face; allowed: the cutter's diameter, 20 mm"),
      std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find("measured.csv:4: error_um: given 200000; allowed: within ±100000"),
            std::string::npos)
      << refusal;
}

TEST(CalibratePart, APlanWithoutAForceHasNothingToCompare) {
  TestFolder folder("calibrate_none");
  CopySmallJob(folder);
  folder.Change("job.yaml", "  cutting: {material: 5A06, teeth: 4, depth_mm: 1}\n", "");
  folder.Change("job.yaml", "{name: surface_error}", "{name: chen2021}");
  PlanArguments arguments;
  arguments.job = folder.path() / "job.yaml";
  arguments.overrides = {{"programs", "[]"}};
  RunPlan(arguments, Silent(), {});
  folder.Write("measured.csv", "x_mm,y_mm,z_mm,error_um\n0,0,0,5\n");
  EXPECT_NE(RefusalOf([&] {
              CalibratePart({folder.path() / "measured.csv", folder.path() / "support_pad.out", {}});
            }).find("the plan predicts no deflection: it needs process.cutting"),
            std::string::npos);
}

}  // namespace
}  // namespace millpose::test
