// SPDX-License-Identifier: GPL-3.0-or-later
// What a measured face says of the next: patterns are found and taken out, noise is left alone.
#include "planning/compensation/error_field.hpp"

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/units.hpp"
#include "geometry/mesh/point_fit.hpp"
#include "job/assemble.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/result/gear_course.hpp"
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

/// One gear that is passed on this flank, +1 or −1, with a lever of 1 m.
GearValues OnFlank(double flank) {
  GearValues flanks = GearValues::Zero();
  flanks[2] = 1000 * flank;
  return flanks;
}

/// There and back, line by line.
double Flank(const Vector3d& place) {
  return static_cast<int>(std::floor((place.y() + 450) / 128 + 0.5)) % 2 == 0 ? 1 : -1;
}

std::vector<ErrorReading> Readings(RandomStream& random, double pattern, double noise, int times = 1) {
  std::vector<ErrorReading> readings;
  for (const Vector3d& place : FacePlaces())
    for (int k = 0; k < times; ++k)
      readings.push_back(
          {{place, OnFlank(Flank(place))}, pattern * SmoothError(place) + noise * random.Normal()});
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
    const double off = std::abs(fitted.field.At({place}) - SmoothError(place));
    worst = std::max(worst, off);
    outside += off > 3 * fitted.field.DeviationAt({place}) ? 1 : 0;
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(outside, 10);
}

// Lost motion errs one way there and the other way back: neighbouring lines say the contrary of each other.
TEST(ErrorField, WhatFollowsTheFlanksIsToldApart) {
  RandomStream random(43, 27);
  std::vector<ErrorReading> readings;
  for (const Vector3d& place : FacePlaces())
    readings.push_back({{place, OnFlank(Flank(place))},
                        0.5 * SmoothError(place) + 0.1 * Flank(place) + 0.005 * random.Normal()});
  const FittedErrors fitted = FitErrors(readings);
  EXPECT_TRUE(fitted.significant);
  EXPECT_GT(fitted.field.shape().by_flanks, 0);
  const Vector3d place(20, 100, -10000.0 / 3000);
  for (const double flank : {1.0, -1.0})
    EXPECT_NEAR(fitted.field.At({place, OnFlank(flank)}), 0.5 * SmoothError(place) + 0.1 * flank, 0.02);
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
    readings.push_back({{place}, SmoothError(place) + 0.05 * random.Normal()});
  }
  const FittedErrors fitted = FitErrors(readings);
  EXPECT_EQ(fitted.places, 250u);
  EXPECT_TRUE(fitted.significant);
  EXPECT_NEAR(fitted.field.At({{10, -20, 0}}), SmoothError({10, -20, 0}), 0.02);
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

  BuiltArm(RandomStream& random, double lost_arcmin) {
    constexpr double kShift = 0.25, kTurn = 3e-4, kGear = 10.0 / 3600;  // mm, rad, degrees
    for (auto& frame : frames)
      for (int k = 0; k < 6; ++k) frame[k] = (k < 3 ? kShift : kTurn) * random.Normal();
    for (int j = 0; j < 6; ++j) {
      gear[j] = DegToRad(kGear);
      phase[j] = random.Uniform(0, 2 * kPi);
      waves[j] = random.Uniform(20, 60);
      lost[j] = DegToRad(random.Uniform(0.5, 1.5) * lost_arcmin / 60);
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

  /// Where the tip is at every point of a plan against where it is wanted, in P, mm; the programs as nominal
  /// or as commanded, each pass entered from where its approach begins.
  std::vector<Vector3d> TipErrors(const PlanResult& plan, bool commanded) const {
    std::vector<Vector3d> errors;
    Joints output = plan.passes[0].points[0].q;
    const auto follow = [&](const Joints& q) {
      for (int j = 0; j < 6; ++j) output[j] = std::clamp(output[j], q[j] - lost[j] / 2, q[j] + lost[j] / 2);
    };
    for (size_t p = 0; p < plan.passes.size(); ++p) {
      follow(plan.gaps[p].joints.back());
      for (const PlannedPoint& point : plan.passes[p].points) {
        const Joints& q = commanded && point.compensation ? point.compensation->q : point.q;
        follow(q);
        const Vector3d off = plan.X_WB.linear() * Off(plan.arm, q, plan.X_FT.translation(), output - q);
        const Vector3d there = plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT.translation();
        errors.push_back(plan.X_WP.linear().transpose() * (there + off - point.point.position));
      }
    }
    return errors;
  }
};

/// As of a cell that knows nothing of its lost motion.
std::vector<MilledPlace> PlacesOnPart(const PlanResult& plan) {
  const std::vector<std::vector<GearValues>> flanks = FlankLevers(plan, {});
  std::vector<MilledPlace> places;
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t i = 0; i < flanks[p].size(); ++i)
      places.push_back({plan.X_WP.inverse() * plan.passes[p].points[i].point.position, flanks[p][i]});
  return places;
}

/// The place of the part as the arm itself finds it at the face's four corners: what is milled is off against
/// that.
Eigen::Isometry3d BaseAtCorners(const std::vector<MilledPlace>& places, const std::vector<Vector3d>& errors) {
  std::vector<Vector3d> nominal, touched;
  for (const auto& [x, y] : {std::pair(1, 1), {1, -1}, {-1, 1}, {-1, -1}}) {
    const auto corner = std::ranges::max_element(
        places, {}, [&](const MilledPlace& p) { return x * p.position.x() + y * p.position.y(); });
    nominal.push_back(corner->position);
    touched.push_back(corner->position + errors[static_cast<size_t>(corner - places.begin())]);
  }
  return FitPoints(nominal, touched)->X;
}

/// Along the normal, mm, with that $BASE.
std::vector<double> FaceErrors(const PlanResult& plan, const std::vector<MilledPlace>& places,
                               const std::vector<Vector3d>& errors, const Eigen::Isometry3d& base) {
  std::vector<double> along;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      const Vector3d& p = places[along.size()].position;
      const Vector3d normal = plan.X_WP.linear().transpose() * point.point.normal;
      along.push_back(normal.dot(p + errors[along.size()] - base * p));
    }
  return along;
}

/// A pass milled with one rotation about the tool axis on one branch, with the pose 30 mm above its first
/// point before it; empty where that leaves the limits.
std::optional<PassResult> MilledWith(const Cell& cell, const Pass& pass, double rotation, int branch) {
  PassResult result;
  Joints near = cell.home;
  std::vector<MillingPoint> points = {pass.points.front()};
  points[0].position += 30 * points[0].normal;
  points.insert(points.end(), pass.points.begin(), pass.points.end());
  for (const MillingPoint& point : points) {
    const Vector3d z = point.normal, level = Vector3d::UnitZ().cross(z).normalized();
    const SineCosine turn = SinCos(rotation);
    const Vector3d x = turn.cos * level + turn.sin * z.cross(level);
    Pose X_WT = Pose::Identity();
    X_WT.linear() << x, z.cross(x), z;
    X_WT.translation() = point.position;
    const auto q = InverseNear(cell.arm, cell.X_WB.inverse() * X_WT * cell.X_FT.inverse(), branch, near);
    if (!q || (q->array() < cell.arm.lower.array() + 0.01).any() ||
        (q->array() > cell.arm.upper.array() - 0.01).any())
      return std::nullopt;
    PlannedPoint& planned = result.points.emplace_back();
    planned.point = point;
    planned.q = near = *q;
    planned.branch = branch;
  }
  result.pieces.push_back({0, 0, 0, static_cast<int>(pass.points.size()) - 1, false});
  return result;
}

/// The sample panel's path with few points, milled with one rotation about the tool axis.
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
  for (int way = 0; way < 12 * 8; ++way) {
    plan.passes.clear();
    plan.gaps.clear();
    for (const Pass& pass : path.passes) {
      std::optional<PassResult> milled = MilledWith(cell, pass, way / 8 * kPi / 6, way % 8);
      if (!milled) break;
      milled->pass = milled->pieces[0].pass = static_cast<int>(plan.passes.size());
      LinkMove& link = plan.gaps.emplace_back();
      link.to_pass = milled->pass, link.to_piece = 0, link.planned = true;
      link.joints = {milled->points.front().q};
      milled->points.erase(milled->points.begin());
      plan.passes.push_back(std::move(*milled));
    }
    if (plan.passes.size() == path.passes.size()) return plan;
  }
  ADD_FAILURE() << "no rotation serves the whole panel";
  return plan;
}

/// Errors of a first part and of a second that follows the first's map, mm.
struct TwoParts {
  double worst = 0, rms = 0, worst_after = 0, rms_after = 0;
};

TwoParts MillTwo(PlanResult plan, const BuiltArm& arm, RandomStream& random) {
  constexpr double kReading = 0.005;
  const std::vector<MilledPlace> places = PlacesOnPart(plan);
  const std::vector<Vector3d> tips = arm.TipErrors(plan, false);
  const Eigen::Isometry3d base = BaseAtCorners(places, tips);
  const auto figures = [](const std::vector<double>& errors) {
    double worst = 0, squares = 0;
    for (const double error : errors) worst = std::max(worst, std::abs(error)), squares += error * error;
    return std::pair(worst, std::sqrt(squares / static_cast<double>(errors.size())));
  };
  const std::vector<double> first = FaceErrors(plan, places, tips, base);
  std::vector<ErrorReading> readings;
  for (size_t i = 0; i < first.size(); i += 2)
    readings.push_back({places[i], first[i] + kReading * random.Normal()});
  const FittedErrors fitted = FitErrors(readings);
  EXPECT_TRUE(fitted.significant);
  CompensationOptions options;
  options.most = 5;
  size_t number = 0;
  for (const PassResult& pass : plan.passes) {
    std::vector<double>& amounts = options.map.emplace_back();
    for (size_t i = 0; i < pass.points.size(); ++i) amounts.push_back(fitted.field.At(places[number++]));
  }
  Compensate(options, ForcesOf(plan), plan);
  TwoParts parts;
  std::tie(parts.worst, parts.rms) = figures(first);
  std::tie(parts.worst_after, parts.rms_after) =
      figures(FaceErrors(plan, places, arm.TipErrors(plan, true), base));
  return parts;
}

// Geometry, gears and lost motion that nobody knows.
TEST(ErrorMap, OneMeasuredPartCorrectsTheNext) {
  const PlanResult plan = PanelPlan();
  for (const double lost : {0.0, 0.3}) {
    RandomStream random(43, 26);
    std::vector<double> worst, rms;
    for (int draw = 0; draw < OfTier(2, 20); ++draw) {
      const BuiltArm arm(random, lost);
      const TwoParts parts = MillTwo(plan, arm, random);
      worst.push_back(parts.worst_after / parts.worst);
      rms.push_back(parts.rms_after / parts.rms);
    }
    std::ranges::sort(worst);
    std::ranges::sort(rms);
    const std::string of = lost > 0 ? "lost_motion" : "no_lost_motion";
    RecordProperty(of + "_worst_ratio", fmt::format("{:.3f}", worst[worst.size() / 2]));
    RecordProperty(of + "_rms_ratio", fmt::format("{:.3f}", rms[rms.size() / 2]));
    EXPECT_LE(worst[worst.size() / 2], 0.25) << of;
    EXPECT_LE(rms[rms.size() / 2], 0.15) << of;
  }
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
