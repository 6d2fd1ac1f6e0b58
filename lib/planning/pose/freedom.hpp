// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "machine/robot/arm.hpp"
#include "toolpath/cutter.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

struct LeanRules;

/// Values of a candidate's freedoms, one entry per Freedom of the problem: the rotation about the tool axis,
/// then those that a job opens, such as lead and tilt.
using FreedomValues = std::vector<double>;

/// How the cutter meets the surface at a milling point; W, unit vectors.
struct CutterContact {
  Eigen::Vector3d place, normal, feed;
  CutterShape cutter;
};

/// The tool before it is turned about its own axis; W, axis from tip to holder.
struct ToolStance {
  Eigen::Vector3d tip, axis;
};

/// A coordinate in which a milling point may be taken differently without changing the cut. An implementation
/// is a file in freedoms/, which ends with its FreedomEntry (freedom_entry.hpp), and its name in
/// freedom_entry.cpp.
class Freedom {
 public:
  virtual ~Freedom() = default;
  virtual std::string Name() const = 0;
  /// Range of values, rad or mm; a periodic freedom's ends are the same pose.
  virtual double Lower() const = 0;
  virtual double Upper() const = 0;
  virtual bool Periodic() const = 0;
  /// Grid step that searches take; 0: their own.
  virtual double Step() const { return 0; }
  /// The value at which the tool path was laid.
  virtual double Nominal() const { return 0; }
  /// Whatever else it depends on.
  virtual std::vector<double> Parameters() const { return {}; }
  /// True for the rotation about the tool axis by the value itself, which the scorer has a fast way for.
  virtual bool IsToolRotation() const { return false; }
  /// True where it moves the tool over the contact, by Lean; else it turns the tool about its axis, by Apply.
  /// Axes start along the normal and lean by one such freedom after the other.
  virtual bool IsLean() const { return false; }
  virtual ToolStance Lean(const CutterContact& contact, const ToolStance& from, double value) const;
  /// Says in the rules of leans what of the tool path it leaves open.
  virtual void Open(LeanRules&) const {}
  /// The tool pose after moving by `value` from X_WT.
  virtual Pose Apply(const Pose& X_WT, double value) const;
};

using FreedomPointer = std::shared_ptr<const Freedom>;

/// The freedom that every job has.
FreedomPointer RotationAboutTool();

/// The tool pose of a stance where the rotation is 0: z along the tool axis, x along
/// `rotation_reference` projected into the plane normal to the tool axis (design.md, conventions). When the
/// reference is within 1° of the axis, the world axis least aligned with the tool axis serves instead.
Pose NominalToolPose(const ToolStance& stance, const Eigen::Vector3d& rotation_reference);
/// That of the point as it stands.
inline Pose NominalToolPose(const MillingPoint& point, const Eigen::Vector3d& rotation_reference) {
  return NominalToolPose(ToolStance{point.position, point.tool_axis}, rotation_reference);
}

}  // namespace millpose
