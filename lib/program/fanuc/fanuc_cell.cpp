// SPDX-License-Identifier: GPL-3.0-or-later
// What the controller is like in a cell: how it moves, what is taken for granted, what is checked by hand.
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/fanuc/fanuc.hpp"
#include "program/fanuc/fanuc_corners.hpp"

namespace millpose {
namespace {

/// "X 1.000 Y 2.000 Z 3.000 W 0.000 P 90.000 R 0.000", as the pendant shows a frame.
std::string PendantText(const Pose& pose) {
  const std::array<double, 6> numbers = FanucNumbers(pose);
  std::string text;
  for (size_t i = 0; i < 6; ++i)
    text += fmt::format("{}{} {}", i > 0 ? " " : "", "XYZWPR"[i], Fixed(numbers[i], kFanucDecimals));
  return text;
}

std::string TurnAxesText(const FanucOptions& options) {
  return fmt::format("J{}", fmt::join(options.turn_axes, ", J"));
}

}  // namespace

// No manual at hand says how L turns the tool: evenly about one axis, or Z of UTOOL swivels evenly and the
// tool turns evenly about it. Motions are so short that both will do.
std::vector<LineModel> FanucPost::Lines(const PostSettings& settings) const {
  const Eigen::Vector3d direction = settings.R_TC() * Eigen::Vector3d::UnitZ();
  return {[direction](const Pose& from, const Pose& to) { return ProgrammedLine(from, to, direction); },
          [](const Pose& from, const Pose& to) { return ProgrammedLine(from, to); }};
}

// Speeds are whole numbers, never above the planned feed.
void FanucPost::Round(MotionProgram& program, const Arm&, const PostSettings& settings) const {
  for (Motion& motion : program.motions)
    if (motion.type == MotionType::kLinear) motion.feed = FanucSpeedOf(motion.feed).feed();
  ChooseFanucCorners(program, options_, settings);
}

std::string FanucPost::WhyNotIn(const PostSettings& settings) const {
  const bool held = options_.position_register == 0;
  if (held && settings.several_tools)
    return "controllers.fanuc.tool_frame: has one number for all of the cell's tools; give "
           "position_register: "
           "programs then set UTOOL themselves";
  for (const FanucAxis& axis : FanucAxes(settings)) {
    const auto index = AxisOf(settings, *axis.axis);
    if (axis.group == 2 && axis.axis->coupled)
      return fmt::format(
          "controllers.fanuc.external_axes: {} is coupled: true; expected: false, as coordinated motion of "
          "groups "
          "(COORD) is not written: the axis then moves between cuts",
          axis.axis->name);
    if (axis.axis->coupled && index && settings.mechanism.axes()[*index].carries != Carries::kRobot)
      return fmt::format(
          "controllers.fanuc.external_axes: {} is coupled: true, but carries the part; expected: false, "
          "or an axis that carries the robot (integrated rail)",
          axis.axis->name);
    if (held && index && !axis.axis->coupled)
      return fmt::format(
          "controllers.fanuc: position_register is missing; needed, since the part stands elsewhere in the "
          "robot's base at each place of {}, so that programs must set UFRAME",
          axis.axis->name);
  }
  return {};
}

std::vector<std::string> FanucPost::Assumptions(const PostSettings& settings) const {
  std::vector<std::string> assumed = {
      fmt::format("the world's origin is {} mm above the robot's base on axis 1 (the cell's world_height_mm)",
                  Short(*options_.world_height, kFanucDecimals)),
      fmt::format(
          "CONFIG counts full turns of {} (the cell's turn_axes, $SCR_GRP[1].$TURN_AXIS); N is J5 < 0, U the "
          "elbow up, T the wrist in front of axis 1",
          TurnAxesText(options_))};
  if (std::string corner = FanucCornerAssumption(options_, settings); !corner.empty())
    assumed.push_back(std::move(corner));
  if (!settings.axis_couplings || settings.axis_couplings->empty())
    assumed.emplace_back(
        "J3 counts from the upper arm: it changes on the pendant when J2 alone is jogged in space");
  return assumed;
}

std::vector<std::pair<std::string, std::string>> FanucPost::BeforeFirstRun(
    const PostSettings& settings) const {
  const bool held = options_.position_register == 0;
  const auto frame = [&](const char* what, int number, const char* line) {
    return held ? fmt::format("{}[{}] at the controller holds {}", what, number, line)
                : fmt::format("programs overwrite {}[{}] and PR[{}]: nothing else uses them", what, number,
                              options_.position_register);
  };
  return {{"user frame",
           frame("UFRAME", options_.user_frame, "base_pose of the head: X, Y, Z, and W = C, P = B, R = A")},
          {"tool frame", frame("UTOOL", options_.tool_frame, "utool of the head")},
          {"world",
           fmt::format(
               "with UFRAME 0 and UTOOL 0 jog all joints to 0: POSN shows W 180, P -90, R 0, and Z counts "
               "from {} mm above the foot",
               Short(options_.world_height.value_or(0), kFanucDecimals))},
          {"J3",
           "jog J2 alone: where axis_couplings names axis 3, J3 stays on the pendant and the forearm keeps "
           "its lean"},
          {"CONFIG",
           fmt::format(
               "bring the arm to the first cut's point by its joints in points.csv: POSN shows the CONFIG "
               "of that position; $SCR_GRP[1].$TURN_AXIS names {}",
               TurnAxesText(options_))},
          {"load", "PAYLOAD is that of spindle and tool"},
          {"texts", TextsToTry(settings)},
          {"first entry",
           "step to it in T1, compare the joints with points.csv; then a dry run (dry_run_offset_mm)"}};
}

FrameTexts FanucPost::Frames(const PostSettings& settings) const {
  return {fmt::format("{} as UTOOL[{}]", settings.tool_name, options_.tool_frame),
          fmt::format("workpiece in the controller's world, as UFRAME[{}]", options_.user_frame),
          {{"utool", PendantText(FanucTool(settings, settings.X_FT))}}};
}

}  // namespace millpose
