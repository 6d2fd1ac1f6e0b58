// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "robot/arm.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// Values of a candidate's freedoms, one entry per Freedom of the problem (today one: rotation about the tool
/// axis).
using FreedomValues = std::vector<double>;

/// A coordinate in which a milling point may be taken differently without changing the cut.
class Freedom {
 public:
  virtual ~Freedom() = default;
  virtual std::string Name() const = 0;
  /// Range of values, rad or mm; a periodic freedom's ends are the same pose.
  virtual double Lower() const = 0;
  virtual double Upper() const = 0;
  virtual bool Periodic() const = 0;
  /// True for the rotation about the tool axis by the value itself, which the scorer has a fast way for.
  virtual bool IsToolRotation() const { return false; }
  /// The tool pose after moving by `value` from X_WT.
  virtual Pose Apply(const Pose& X_WT, double value) const = 0;
};

struct FreedomEntry {
  std::string name;
  std::function<std::unique_ptr<Freedom>()> make;
};

/// All freedoms; programs that link the library may add theirs.
Registry<FreedomEntry>& Freedoms();

/// The freedom registered under `name`; InputError with the nearest name when there is none.
std::unique_ptr<Freedom> MakeFreedom(const std::string& name);

/// The tool pose at which all freedoms are 0: tip at the point, z along the tool axis, x along
/// `rotation_reference` projected into the plane normal to the tool axis (design.md, conventions). When the
/// reference is within 1° of the axis, the world axis least aligned with the tool axis serves instead.
Pose NominalToolPose(const MillingPoint& point, const Eigen::Vector3d& rotation_reference);

}  // namespace millpose
