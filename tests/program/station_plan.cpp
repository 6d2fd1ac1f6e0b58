// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/station_plan.hpp"

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"
#include "program/krl/krl.hpp"
#include "program/rapid/rapid.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

const Vector3d kTableAxis(2476, 30, 600);

ExternalAxis Rail() {
  return {.name = "rail",
          .direction = Vector3d::UnitY(),
          .lower = -500,
          .upper = 4000,
          .speed = 1000,
          .acceleration = 500,
          .compliance = {}};
}

ExternalAxis Table() {
  return {.name = "table",
          .kind = AxisKind::kRotary,
          .carries = Carries::kWorkpiece,
          .direction = Vector3d::UnitZ(),
          .origin = kTableAxis,
          .lower = -kPi,
          .upper = kPi,
          .speed = 0.5,
          .acceleration = 0.5,
          .compliance = {}};
}

/// The way between two pieces by home, where the external axes move.
void GoByHome(const PlanResult& plan, const ExternalPosition& from, const ExternalPosition& to,
              LinkMove& gap) {
  const Joints between = plan.gaps.front().joints[1];
  if (gap.from_pass < 0)
    gap.external = ExternalMove{from, to, 0, 1};
  else if (gap.to_pass < 0)
    gap.external = ExternalMove{from, to, static_cast<int>(gap.joints.size()) - 1, 1};
  else {
    gap.joints = {gap.joints.front(), between, plan.home, between, gap.joints.back()};
    gap.external = ExternalMove{from, to, 2, 1};
  }
}

}  // namespace

PlanResult StationPlan(const std::string& axes, const SampleShape& shape) {
  PlanResult plan = SamplePlan(shape);
  const bool rail = axes != "table", table = axes != "rail";
  std::vector<ExternalPosition> stations(4);  // home, of the passes, home
  const auto add = [&](const ExternalAxis& axis, double first, double second) {
    plan.external_axes.push_back(axis);
    const std::array<double, 4> values = {0, first, second, 0};
    for (size_t i = 0; i < 4; ++i) stations[i].push_back(values[i]);
  };
  if (rail) add(Rail(), 100, 400);
  if (table) add(Table(), 5 * kRadPerDeg, 35 * kRadPerDeg);
  for (size_t i = 0; i < 2; ++i) plan.passes[i].external = stations[i + 1];
  for (size_t i = 0; i < 3; ++i) GoByHome(plan, stations[i], stations[i + 1], plan.gaps[i]);
  return plan;
}

namespace {

/// Where joints that are planned at one position of the external axes are at another, the tool standing still
/// on the part.
Joints CarriedJoints(const PlanResult& plan, const Joints& q, const ExternalPosition& from,
                     const ExternalPosition& to) {
  const Pose X_PT =
      PartAt(plan, from).inverse() * BaseAt(plan, from) * ForwardFlange(plan.arm, q) * plan.X_FT;
  const Pose X_BF = BaseAt(plan, to).inverse() * PartAt(plan, to) * X_PT * plan.X_FT.inverse();
  const auto moved = InverseNear(plan.arm, X_BF, Status(plan.arm, q), q);
  if (!moved) throw std::logic_error("out of reach");
  return *moved;
}

/// Brings a point's vectors to where tool and part are.
void CarryVectors(const Pose& X_WT, const Pose& moved, MillingPoint& point) {
  point.position = X_WT.translation();
  for (Eigen::Vector3d* direction : {&point.normal, &point.feed, &point.tool_axis})
    *direction = moved.linear() * *direction;
}

}  // namespace

PlanResult RidePlan(const std::string& axes, const SampleShape& shape) {
  PlanResult plan = StationPlan(axes, shape);
  const std::vector<double> ways = axes == "rail"    ? std::vector<double>{60}
                                   : axes == "table" ? std::vector<double>{-8 * kRadPerDeg}
                                                     : std::vector{60, -8 * kRadPerDeg};
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    PassResult& pass = plan.passes[p];
    const ExternalPosition begin = pass.external;
    ExternalPosition at = begin;
    for (size_t i = 0; i < pass.points.size(); ++i) {
      for (size_t k = 0; k < at.size(); ++k)
        at[k] = begin[k] + ways[k] * static_cast<double>(i) / static_cast<double>(pass.points.size() - 1);
      PlannedPoint& point = pass.points[i];
      point.q = CarriedJoints(plan, point.q, begin, at);
      CarryVectors(BaseAt(plan, at) * ForwardFlange(plan.arm, point.q) * plan.X_FT,
                   PartAt(plan, at) * PartAt(plan, begin).inverse(), point.point);
      point.external = at;
    }
    LinkMove& leaving = plan.gaps[p + 1];
    leaving.joints.front() = CarriedJoints(plan, leaving.joints.front(), begin, at);
    leaving.external->from = at;
  }
  return plan;
}

KrlCellNumbers KrlNumbers(const PlanResult& plan, bool coupled) {
  KrlCellNumbers numbers;
  if (!coupled || plan.external_axes.front().name != "rail") {  // the robot's foot is the world
    numbers.ersysroot.setZero();
    numbers.carriage.setZero();
  }
  const Vector3d base = numbers.ersysroot + numbers.carriage;
  numbers.root = kTableAxis - plan.X_WB.translation() + base;
  return numbers;
}

RapidOptions RapidStations(const PlanResult& plan, bool coupled) {
  RapidOptions options;
  options.base_frame.position = Vector3d(100, -200, 650);
  options.activate_units = {"TRACK1"};
  if (coupled && plan.external_axes.back().name == "table") {
    RapidWorkUnit unit;
    unit.name = "STN1";
    unit.frame.position = kTableAxis - plan.X_WB.translation() + options.base_frame.position;
    options.work_unit = unit;
  }
  return options;
}

StationPost::StationPost(const std::string& variant, const PlanResult& plan, bool coupled)
    : settings(SampleSettings(variant)) {
  const bool krl = ControllerOf(variant) == "krl", cnc = ControllerOf(variant) == "linuxcnc",
             rapid = ControllerOf(variant) == "rapid";
  const bool counts = coupled && variant != "linuxcnc";  // whose joints count from nothing
  const bool fanuc = ControllerOf(variant) == "fanuc";
  const std::vector<std::string> names = krl     ? std::vector<std::string>{"E1", "E2"}
                                         : fanuc ? std::vector<std::string>{"E1", "GP2_J1"}
                                         : cnc   ? std::vector<std::string>{"U", "V"}
                                         : rapid ? RapidAxisNames()
                                                 : std::vector<std::string>{"RAIL_AX", "TAB_AX"};
  settings.mechanism = Mechanism(plan.external_axes);
  settings.X_WB = plan.X_WB;
  for (size_t i = 0; i < plan.external_axes.size(); ++i)
    settings.controller_axes.push_back({names[i], plan.external_axes[i].name, {}, 0, counts});
  if (rapid) {
    post = std::make_unique<RapidPost>(RapidStations(plan, coupled));
    return;
  }
  if (!krl) {
    post = SamplePost(variant);
    return;
  }
  const KrlCellNumbers numbers = KrlNumbers(plan, coupled);
  KrlOptions options;
  const bool rail = plan.external_axes.front().name == "rail",
             table = plan.external_axes.back().name == "table";
  if (coupled && rail) {
    options.ersysroot = KrlRail{{numbers.ersysroot, Vector3d::Zero()}, FrameAxis::kY};
    options.robroot = PoseSettings{numbers.carriage, Vector3d::Zero()};
  }
  if (coupled && table)
    options.external_base = KrlTable{2, {numbers.root, Vector3d::Zero()}, {Vector3d(0, 0, 40), {}}};
  if (options.external_base) options.external_base->flange.abc = Vector3d::Zero();
  post = std::make_unique<KrlPost>(options);
}

ProgramFiles StationPost::Write(const MotionProgram& program, const Arm& arm) const {
  return post->Write(Prepared(program, *post, settings, arm), arm, settings);
}

}  // namespace millpose
