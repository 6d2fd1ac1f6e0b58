// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/external_axes.hpp"

#include <set>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kSameLength = 1e-6;  // mm
constexpr double kSameTurn = 1e-9;

/// From what a controller counts from, with the coupled axes at 0, to the base as it stands.
Pose Carried(const PostSettings& settings, const ExternalPosition& external) {
  const ExternalPosition coupled = CoupledPart(settings, external);
  return settings.X_WB.inverse() * settings.mechanism.Moved(Carries::kWorkpiece, coupled).inverse() *
         settings.mechanism.Moved(Carries::kRobot, coupled) * settings.X_WB;
}

}  // namespace

std::optional<size_t> AxisOf(const PostSettings& settings, const ControllerAxis& axis) {
  if (axis.axis.empty()) return std::nullopt;
  const std::vector<ExternalAxis>& axes = settings.mechanism.axes();
  const auto found = std::ranges::find(axes, axis.axis, &ExternalAxis::name);
  if (found == axes.end()) return std::nullopt;
  return static_cast<size_t>(found - axes.begin());
}

bool IsRotary(const PostSettings& settings, const ControllerAxis& axis) {
  const auto index = AxisOf(settings, axis);
  return (index ? settings.mechanism.axes()[*index].kind : axis.kind) == AxisKind::kRotary;
}

double ValueOf(const PostSettings& settings, const ControllerAxis& axis, const ExternalPosition& external) {
  const auto index = AxisOf(settings, axis);
  if (!index || external.empty()) return axis.constant;
  return external[*index] * (IsRotary(settings, axis) ? kDegPerRad : 1);
}

void SetValue(const PostSettings& settings, const ControllerAxis& axis, double value,
              ExternalPosition& external) {
  const auto index = AxisOf(settings, axis);
  if (index) external[*index] = value * (IsRotary(settings, axis) ? kRadPerDeg : 1);
}

ExternalPosition CoupledPart(const PostSettings& settings, const ExternalPosition& external) {
  ExternalPosition coupled(external.size(), 0);
  for (const ControllerAxis& axis : settings.controller_axes) {
    const auto index = AxisOf(settings, axis);
    if (index && axis.coupled) coupled[*index] = external[*index];
  }
  return coupled;
}

Pose AsCounted(const PostSettings& settings, const ExternalPosition& external, const Pose& X_BP) {
  return external.empty() ? X_BP : Carried(settings, external) * X_BP;
}

Pose FromCounted(const PostSettings& settings, const ExternalPosition& external, const Pose& counted) {
  return external.empty() ? counted : Carried(settings, external).inverse() * counted;
}

std::string UncoupledMove(const PostSettings& settings, const ExternalPosition& from,
                          const ExternalPosition& to) {
  for (const ControllerAxis& axis : settings.controller_axes) {
    const auto index = AxisOf(settings, axis);
    if (index && !axis.coupled && from[*index] != to[*index]) return axis.name;
  }
  return {};
}

std::string WhyNotAlongCuts(const PostSettings& settings, const std::string& controller,
                            const std::string& axis, bool joints) {
  const auto own = std::ranges::find(settings.controller_axes, axis, &ControllerAxis::axis);
  if (joints || own == settings.controller_axes.end() || own->coupled) return {};
  return fmt::format(
      "{1} does not count in axis {0} (controllers.{1}.external_axes: {2} is coupled: false), so that the "
      "tip "
      "would leave the part while it moves; allowed: constant, per_pass, programs without {1}, or coupled: "
      "true "
      "where the controller does count in it",
      axis, controller, own->name);
}

bool SameFrame(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm() <= kSameLength &&
         (a.linear() - b.linear()).cwiseAbs().maxCoeff() <= kSameTurn;
}

std::string WhyNotWithAxes(const PostSettings& settings, const std::string& controller) {
  const std::vector<ExternalAxis>& axes = settings.mechanism.axes();
  std::vector<std::string> names;
  for (const ExternalAxis& axis : axes) names.push_back(axis.name);
  const std::string key = fmt::format("controllers.{}.external_axes", controller);
  std::set<std::string> named;
  for (const ControllerAxis& axis : settings.controller_axes) {
    if (axis.axis.empty()) continue;
    if (!AxisOf(settings, axis)) {
      const std::string near = NearestName(axis.axis, names);
      return fmt::format(
          "{}: {} is given the axis '{}', which the cell's external_axes do not have; allowed: {}{}", key,
          axis.name, axis.axis, names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")),
          near.empty() ? "" : "; did you mean " + near + "?");
    }
    if (!named.insert(axis.axis).second)
      return fmt::format("{}: the axis '{}' is given twice", key, axis.axis);
  }
  for (const std::string& name : names)
    if (!named.contains(name))
      return fmt::format(
          "{}: the cell's axis '{}' is missing; expected: by which name the controller knows it and "
          "whether it counts in it, as {{name: …, axis: {}, coupled: …}}",
          key, name, name);
  return {};
}

std::vector<ExternalColumn> ExternalColumns(const PostSettings& settings) {
  std::vector<ExternalColumn> columns;
  for (const ControllerAxis& axis : settings.controller_axes) {
    std::string name = axis.name;
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    columns.push_back(
        {name + (IsRotary(settings, axis) ? "_deg" : "_mm"), AxisOf(settings, axis), axis.constant});
  }
  return columns;
}

}  // namespace millpose
