// SPDX-License-Identifier: GPL-3.0-or-later
// What moves beside the arm: a rail or lift that carries the robot, a table that carries the part.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/enum_words.hpp"
#include "machine/robot/arm.hpp"

namespace millpose {

enum class AxisKind : uint8_t { kLinear, kRotary };
inline constexpr EnumWords<AxisKind, 2> kAxisKindWords = {
    {{"linear", AxisKind::kLinear}, {"rotary", AxisKind::kRotary}}};

enum class Carries : uint8_t { kRobot, kWorkpiece };
inline constexpr EnumWords<Carries, 2> kCarriesWords = {
    {{"robot", Carries::kRobot}, {"workpiece", Carries::kWorkpiece}}};

/// An axis beside the arm's six. It stands still in cuts unless a job lets it move (docs/external-axes.md).
struct ExternalAxis {
  std::string name;
  AxisKind kind = AxisKind::kLinear;
  Carries carries = Carries::kRobot;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, in W, with all axes at 0
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< a place on a rotary axis, W, mm, with all at 0
  double lower = 0, upper = 0;                           ///< mm or rad
  double home = 0;                     ///< mm or rad: where it stands when programs start and end
  double speed = 0, acceleration = 0;  ///< mm/s or rad/s, and per s
  /// mm/N along a linear axis, rad/(N·mm) about a rotary one; empty: taken as stiff.
  std::optional<double> compliance;
};

inline constexpr size_t kMostExternalAxes = 3;

/// Where the external axes stand: one value for each, mm or rad; empty where there are none.
using ExternalPosition = std::vector<double>;

/// The external axes of a cell in order: of those that carry the same, each carries the ones behind it.
class Mechanism {
 public:
  Mechanism() = default;
  explicit Mechanism(std::vector<ExternalAxis> axes) : axes_(std::move(axes)) {}

  const std::vector<ExternalAxis>& axes() const { return axes_; }
  /// Where the axes stand when programs start and end.
  ExternalPosition Home() const;
  /// By what motion, in W, that which `carried` names has moved from where it stands with all axes at 0: a
  /// body's pose X_WG becomes Moved(…) · X_WG. One value of `position` for each axis.
  Pose Moved(Carries carried, const ExternalPosition& position) const;
  /// The same of what axis `axis` itself carries: a carriage or a table.
  Pose MovedWith(size_t axis, const ExternalPosition& position) const;
  /// Direction of axis `axis` and a place on it, in W, with the axes at `position`.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> LineOf(size_t axis, const ExternalPosition& position) const;

 private:
  std::vector<ExternalAxis> axes_;
};

}  // namespace millpose
