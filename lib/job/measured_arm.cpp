// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/measured_arm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "base/shown.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "machine/motion/line.hpp"

namespace millpose {
namespace {

constexpr size_t kMostSource = 400;  // bytes of a source that are shown

/// ": laser tracker, 60 poses" in one line; nothing where nobody says it.
std::string SourceText(std::string source) {
  std::ranges::replace(source, '\n', ' ');
  source.erase(source.find_last_not_of(' ') + 1);
  return source.empty() ? "" : ": " + Shown(source, kMostSource);
}

std::string SixText(const Vector6& values, double factor) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(fmt::format("{:.4g}", factor * value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string LabelledRow(const char* label, const std::string& text) {
  return fmt::format("{:<20}{}\n", label, text);
}

double LargestNorm(const std::vector<Eigen::Vector3d>& rows) {
  double largest = 0;
  for (const Eigen::Vector3d& row : rows) largest = std::max(largest, row.norm());
  return largest;
}

std::string CalibrationText(const MeasuredArm& measured) {
  const ArmSettings& arm = measured.arm;
  if (!arm.deviations)
    return LabelledRow("calibration", arm.absolute_accuracy ? "the controller's own (arm.absolute_accuracy)"
                                                            : "none: the arm counts as its sheet has it");
  const DeviationSettings& deviations = *arm.deviations;
  std::string text =
      LabelledRow("calibration", fmt::format("arm {}{}", MeasuredName(arm), SourceText(deviations.source)));
  text += LabelledRow(
      "deviations",
      fmt::format("frames shifted by up to {:.3f} mm and turned by up to {:.3f} mrad; at home the "
                  "flange is {:.3f} mm and {:.3f}° from where the controller has it",
                  measured.largest_shift, 1000 * measured.largest_turn, measured.home_shift,
                  RadToDeg(measured.home_turn)));
  if (const std::string joints = MeasuredJoints(deviations); !joints.empty()) {
    double largest = 0;
    for (const JointHarmonic& wave : deviations.gears) largest = std::max(largest, wave.amplitude);
    text += LabelledRow(
        "gear tables",
        largest > 0 ? fmt::format("{}; up to {:.3g} arcsec", joints, 3600 * RadToDeg(largest)) : joints);
  }
  if (!deviations.patterns.empty())
    text += LabelledRow("how sure",
                        fmt::format("by {} patterns (arm.deviations.patterns)", deviations.patterns.size()));
  else
    text += LabelledRow("how sure", deviations.uncertainty ? fmt::format("{:.3g} mm at the flange, 95 %",
                                                                         *deviations.uncertainty)
                                                           : "not stated");
  return text +
         LabelledRow("programs", fmt::format("for arm {} alone where a job has compensation.deviations: "
                                             "true; else deviations only count in the budget",
                                             arm.serial));
}

std::string GearsText(const ArmSettings& arm) {
  constexpr double kArcmin = 60 * kDegPerRad, kArcsec = 60 * kArcmin;
  std::string text = LabelledRow(
      "lost motion", arm.lost_motion
                         ? SixText(*arm.lost_motion, kArcmin) + " arcmin" + SourceText(arm.lost_motion_source)
                         : "not known");
  return text + LabelledRow("gear error", arm.gear_error ? SixText(arm.gear_error->amplitude, kArcsec) +
                                                               " arcsec" + SourceText(arm.gear_error->source)
                                                         : "not known");
}

std::string SpringsText(const MeasuredArm& measured) {
  constexpr double kNmPerRad = 1e-3;
  const ArmSettings& arm = measured.arm;
  std::string sure;
  if (!arm.stiffness_uncertainty.isZero(0.0))
    sure = fmt::format(" ± {} %", SixText(arm.stiffness_uncertainty, 100));
  std::string text = LabelledRow("joint stiffness", SixText(arm.stiffness, kNmPerRad) + " N·m/rad" + sure +
                                                        SourceText(arm.stiffness_source));
  for (const ComplianceSettings& spring : measured.compliances)
    text += LabelledRow("compliance",
                        fmt::format("{} on {}", Shown(spring.name), WordOf(kLinkWords, spring.link)));
  return text;
}

}  // namespace

MeasuredArm DescribeMeasured(const CellSettings& settings) {
  MeasuredArm measured{settings.arm, settings.compliances};
  if (!settings.arm.deviations) return measured;
  const DeviationSettings& deviations = *settings.arm.deviations;
  measured.largest_shift = LargestNorm(deviations.shifts);
  measured.largest_turn = LargestNorm(deviations.turns);
  const Arm arm = MakeArm(settings.arm);
  const Pose controller = TrueFlange(arm, ArmDeviations(), settings.home),
             own = TrueFlange(arm, MakeDeviations(deviations), settings.home);
  measured.home_shift = (own.translation() - controller.translation()).norm();
  measured.home_turn = AngleBetween(own.linear(), controller.linear());
  return measured;
}

std::string MeasuredJoints(const DeviationSettings& deviations) {
  std::array<int, 6> waves{};
  for (const JointHarmonic& wave : deviations.gears) ++waves[static_cast<size_t>(wave.joint) - 1];
  std::vector<std::string> parts;
  for (size_t i = 0; i < waves.size(); ++i)
    if (waves[i] > 0) parts.push_back(fmt::format("A{} ({})", i + 1, waves[i]));
  std::string text = parts.empty() ? "" : fmt::format("waves of {}", fmt::join(parts, ", "));
  for (const JointCoupling& pair : deviations.couplings)
    text += fmt::format("{}A{} with A{}", text.empty() ? "" : ", ", pair.joint, pair.follows);
  return text;
}

std::string MeasuredName(const ArmSettings& arm) {
  return fmt::format("{}, measured on {}", arm.serial, arm.deviations->date);
}

std::string ToText(const MeasuredArm& measured) {
  return CalibrationText(measured) + GearsText(measured.arm) + SpringsText(measured);
}

}  // namespace millpose
