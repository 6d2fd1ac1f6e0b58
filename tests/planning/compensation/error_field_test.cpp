// SPDX-License-Identifier: GPL-3.0-or-later
// What a measured face says of the next: patterns are found and taken out, noise is left alone.
#include "planning/compensation/error_field.hpp"

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/result/station.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/base/tier.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// 11 × 8 places of a face of 600 by 900 mm, bent a little.
std::vector<Vector3d> FacePlaces() {
  std::vector<Vector3d> places;
  for (int i = 0; i < 11; ++i)
    for (int j = 0; j < 8; ++j) {
      const double x = 60.0 * i - 300, y = 128.0 * j - 450;
      places.emplace_back(x, y, -y * y / 3000);
    }
  return places;
}

double SmoothError(const Vector3d& p) {
  return 0.1 + 0.12 * SinCos(p.x() / 150).sin + 0.08 * SinCos(p.y() / 200 + 1).cos;
}

std::vector<ErrorReading> Readings(RandomStream& random, double pattern, double noise, int times = 1) {
  std::vector<ErrorReading> readings;
  for (const Vector3d& place : FacePlaces())
    for (int k = 0; k < times; ++k)
      readings.push_back({place, pattern * SmoothError(place) + noise * random.Normal()});
  return readings;
}

TEST(ErrorField, NoiseAloneIsLeftAlone) {
  const int draws = OfTier(12, 200);
  RandomStream random(43, 21);
  int found = 0;
  for (int draw = 0; draw < draws; ++draw) found += FitErrors(Readings(random, 0, 0.05)).significant ? 1 : 0;
  EXPECT_LE(found, OfTier(1, 6));
}

TEST(ErrorField, APatternUnderNoiseIsFoundBetweenTheReadings) {
  RandomStream random(43, 22);
  const FittedErrors fitted = FitErrors(Readings(random, 1, 0.01));
  EXPECT_TRUE(fitted.significant);
  EXPECT_GT(fitted.explained, 0.9);
  EXPECT_NEAR(fitted.field.noise(), 0.01, 0.006);
  EXPECT_FALSE(fitted.repeatability);
  double worst = 0, outside = 0;
  for (int i = 0; i < 200; ++i) {
    const double x = random.Uniform(-290, 290), y = random.Uniform(-440, 440);
    const Vector3d place(x, y, -y * y / 3000);
    const double off = std::abs(fitted.field.At(place) - SmoothError(place));
    worst = std::max(worst, off);
    outside += off > 3 * fitted.field.DeviationAt(place) ? 1 : 0;
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(outside, 10);
}

TEST(ErrorField, PlacesReadTwiceTellWhatAReadingIsWorth) {
  RandomStream random(43, 23);
  const FittedErrors fitted = FitErrors(Readings(random, 1, 0.02, 3));
  EXPECT_EQ(fitted.places, FacePlaces().size());
  ASSERT_TRUE(fitted.repeatability);
  EXPECT_NEAR(*fitted.repeatability, 0.02, 0.003);
}

TEST(ErrorField, ManyReadingsAreAveragedInPlaces) {
  RandomStream random(43, 24);
  std::vector<ErrorReading> readings;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d place(random.Uniform(-300, 300), random.Uniform(-450, 450), 0);
    readings.push_back({place, SmoothError(place) + 0.05 * random.Normal()});
  }
  const FittedErrors fitted = FitErrors(readings);
  EXPECT_EQ(fitted.places, 250u);
  EXPECT_TRUE(fitted.significant);
  EXPECT_NEAR(fitted.field.At({10, -20, 0}), SmoothError({10, -20, 0}), 0.02);
}

// What only half comes back is told as a half, what does not come back as nothing.
TEST(ErrorField, ASecondPartTellsWhatComesBack) {
  RandomStream random(43, 25);
  const FittedErrors first = FitErrors(Readings(random, 1, 0.01));
  const Repeats half = RepeatsOf(first.field, Readings(random, 0.5, 0.01));
  EXPECT_TRUE(half.certain());
  EXPECT_NEAR(half.share, 0.5, 0.05);
  EXPECT_LT(half.low, half.share);
  EXPECT_FALSE(RepeatsOf(first.field, Readings(random, -0.2, 0.01)).certain());
  const Repeats nothing = RepeatsOf(first.field, Readings(random, 0, 0.05));
  EXPECT_LT(nothing.low, 0.1);
}

/// An arm as built: its joint frames off their places and directions, gears that err with the angle, and
/// joints that stay behind when they turn back. First order in all of these.
struct BuiltArm {
  std::array<Eigen::Matrix<double, 6, 1>, 6> frames;  ///< shift (mm) and turn (rad) of each joint's frame
  Joints gear, phase, waves, lost;                    ///< rad, rad, waves a revolution, rad

  explicit BuiltArm(RandomStream& random) {
    constexpr double kShift = 0.25, kTurn = 3e-4, kGear = 10.0 / 3600, kLost = 0.3 / 60;  // mm, rad, degrees
    for (auto& frame : frames)
      for (int k = 0; k < 6; ++k) frame[k] = (k < 3 ? kShift : kTurn) * random.Normal();
    for (int j = 0; j < 6; ++j) {
      gear[j] = DegToRad(kGear);
      phase[j] = random.Uniform(0, 2 * kPi);
      waves[j] = random.Uniform(20, 60);
      lost[j] = DegToRad(kLost);
    }
  }

  /// Where the tip is against where the joints say, in B, mm; `behind`: what each joint's output lags, rad.
  Vector3d Off(const Arm& arm, const Joints& q, const Vector3d& p_FT, const Joints& behind) const {
    const std::array<Pose, 7> links = LinkFrames(arm, q);
    const Vector3d tip = ForwardFlange(arm, q) * p_FT;
    Vector3d off = Vector3d::Zero();
    for (size_t j = 0; j < 6; ++j) {
      const Vector3d turn = links[j + 1].linear() * frames[j].tail<3>();
      off += links[j + 1].linear() * frames[j].head<3>() + turn.cross(tip - links[j + 1].translation());
    }
    Joints dq = behind;
    for (int j = 0; j < 6; ++j) dq[j] += gear[j] * SinCos(waves[j] * q[j] + phase[j]).sin;
    return off + Jacobian(arm, q, p_FT).topRows<3>() * dq;
  }

  /// Along the normal at every point of a plan, as nominal or as commanded, mm.
  std::vector<double> FaceErrors(const PlanResult& plan, bool commanded) const {
    std::vector<double> errors;
    Joints output = plan.passes[0].points[0].q;
    for (const PassResult& pass : plan.passes)
      for (const PlannedPoint& point : pass.points) {
        const Joints& q = commanded && point.compensation ? point.compensation->q : point.q;
        for (int j = 0; j < 6; ++j) output[j] = std::clamp(output[j], q[j] - lost[j] / 2, q[j] + lost[j] / 2);
        const Vector3d off = plan.X_WB.linear() * Off(plan.arm, q, plan.X_FT.translation(), output - q);
        const Vector3d there = plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT.translation();
        errors.push_back(point.point.normal.dot(there + off - point.point.position));
      }
    return errors;
  }
};

std::vector<Vector3d> PlacesOnPart(const PlanResult& plan) {
  std::vector<Vector3d> places;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      places.push_back(plan.X_WP.inverse() * point.point.position);
  return places;
}

/// What measuring $BASE at the face's four corners takes out: offset and slopes of the errors there.
std::vector<double> BaseAtCorners(const std::vector<Vector3d>& places, const std::vector<double>& errors) {
  Eigen::Matrix<double, 4, 3> rows;
  Eigen::Vector4d values;
  int row = 0;
  for (const auto& [x, y] : {std::pair(1, 1), {1, -1}, {-1, 1}, {-1, -1}}) {
    const auto corner =
        std::ranges::max_element(places, {}, [&](const Vector3d& p) { return x * p.x() + y * p.y(); });
    rows.row(row) << 1, corner->x(), corner->y();
    values[row++] = errors[static_cast<size_t>(corner - places.begin())];
  }
  const Vector3d fit = rows.colPivHouseholderQr().solve(values);
  std::vector<double> taken;
  for (const Vector3d& p : places) taken.push_back(fit.dot(Vector3d(1, p.x(), p.y())));
  return taken;
}

/// The sample panel's path with few points, each milled with one rotation about the tool axis.
PlanResult PanelPlan() {
  const std::filesystem::path source = SourceDir();
  const JobInputs inputs = LoadJobInputs(source / "toolpaths/cabin_panel/job.yaml",
                                         {{"toolpath.stepover_mm", "45"}, {"toolpath.spacing_mm", "20"}});
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  cell.X_WP = MakeWorkpiecePose(inputs.job.workpiece, cell.X_WB);
  const Mesh mesh = ReadPart(inputs, cell).import.mesh;
  const Toolpath path = PlacedToolpath(inputs, MakeJobToolpath(inputs, mesh, {}).toolpath, cell.X_WP);
  PlanResult plan;
  plan.arm = cell.arm;
  plan.X_WB = cell.X_WB, plan.X_FT = cell.X_FT, plan.X_WP = cell.X_WP;
  for (const Pass& pass : path.passes) {
    PassResult& result = plan.passes.emplace_back();
    result.pass = static_cast<int>(plan.passes.size()) - 1;
    for (const MillingPoint& point : pass.points) {
      PlannedPoint planned;
      planned.point = point;
      Pose X_WT = Pose::Identity();
      const Vector3d z = point.normal, x = Vector3d::UnitZ().cross(z).normalized();
      X_WT.linear() << x, z.cross(x), z;
      X_WT.translation() = point.position;
      const InverseResult found = Inverse(cell.arm, cell.X_WB.inverse() * X_WT * cell.X_FT.inverse());
      const auto* solution = std::ranges::find(found.solutions, 2, &ArmSolution::branch);
      if (solution == found.solutions.end() || found.count == 0) continue;
      planned.q = solution->q;
      planned.branch = solution->branch;
      result.points.push_back(planned);
    }
    const auto last = static_cast<int>(result.points.size()) - 1;
    result.pieces.push_back({result.pass, 0, 0, last, false});
  }
  return plan;
}

/// Worst error of the first part and of a second that follows the first's map.
std::pair<double, double> WorstOfTwoParts(PlanResult plan, RandomStream& random, double reading_noise) {
  const BuiltArm arm(random);
  const std::vector<Vector3d> places = PlacesOnPart(plan);
  const std::vector<double> first = arm.FaceErrors(plan, false), base = BaseAtCorners(places, first);
  double worst = 0;
  std::vector<ErrorReading> readings;
  for (size_t i = 0; i < first.size(); ++i) {
    worst = std::max(worst, std::abs(first[i] - base[i]));
    if (i % 2 == 0) readings.push_back({places[i], first[i] - base[i] + reading_noise * random.Normal()});
  }
  const FittedErrors fitted = FitErrors(readings);
  EXPECT_TRUE(fitted.significant);
  CompensationOptions options;
  options.most = 5;
  for (const PassResult& pass : plan.passes) {
    std::vector<double>& amounts = options.map.emplace_back();
    for (size_t i = 0; i < pass.points.size(); ++i)
      amounts.push_back(fitted.field.At(plan.X_WP.inverse() * pass.points[i].point.position));
  }
  Compensate(options, ForcesOf(plan), plan);
  double worst_after = 0;
  const std::vector<double> second = arm.FaceErrors(plan, true);
  for (size_t i = 0; i < second.size(); ++i)
    worst_after = std::max(worst_after, std::abs(second[i] - base[i]));
  return {worst, worst_after};
}

// Geometry, gears and lost motion that nobody knows: the second part's worst error against the first's.
TEST(ErrorMap, OneMeasuredPartCorrectsTheNext) {
  const PlanResult plan = PanelPlan();
  size_t points = 0;
  for (const PassResult& pass : plan.passes) points += pass.points.size();
  ASSERT_GT(points, 300u);
  RandomStream random(43, 26);
  std::vector<double> ratios;
  for (int draw = 0; draw < OfTier(2, 20); ++draw) {
    const auto [before, after] = WorstOfTwoParts(plan, random, 0.005);
    ratios.push_back(after / before);
  }
  std::ranges::sort(ratios);
  RecordProperty("median_ratio", fmt::format("{:.3f}", ratios[ratios.size() / 2]));
  RecordProperty("worst_ratio", fmt::format("{:.3f}", ratios.back()));
  EXPECT_LE(ratios[ratios.size() / 2], 0.35);
}

TEST(ErrorMap, IsBoundedByTheLargestShiftAndLeavesTheRest) {
  PlanResult plan = PanelPlan();
  CompensationOptions options;
  options.most = 0.1;
  for (const PassResult& pass : plan.passes) options.map.emplace_back(pass.points.size(), 0.25);
  options.map[0][0] = -0.03;
  const CompensationCounts counts = Compensate(options, ForcesOf(plan), plan);
  EXPECT_GT(counts.cut, 0u);
  EXPECT_NEAR(counts.largest_cut, 0.25, 1e-12);
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      const bool first = &point == &plan.passes[0].points[0];
      EXPECT_NEAR(point.compensation->shift.dot(point.point.normal), first ? 0.03 : -0.1, 1e-12);
      const Vector3d tip =
          plan.X_WB * ForwardFlange(plan.arm, point.compensation->q) * plan.X_FT.translation();
      EXPECT_LT((tip - point.point.position - point.compensation->shift).norm(), 1e-6);
    }
}

}  // namespace
}  // namespace millpose
