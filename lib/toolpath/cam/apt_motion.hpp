// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "toolpath/cam/apt_circle.hpp"
#include "toolpath/cam/apt_comments.hpp"
#include "toolpath/cam/apt_cycle.hpp"
#include "toolpath/cam/apt_nurbs.hpp"
#include "toolpath/cam/section_tracker.hpp"

namespace millpose {

/// The system that coordinates of CLDATA are given in, and their unit.
struct AptSystem {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< mm
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double unit = 1;  ///< mm

  /// UNITS/MM, INCHES, CM.
  void TakeUnits(const AptStatement& statement);
  /// What a comment states.
  void TakeFrame(const AptFrame& frame);
  bool IsMoved() const { return !origin.isZero(1e-9) || !rotation.isIdentity(1e-9); }
  /// MSYS: origin, X axis, Y axis of the system that all further coordinates are given in.
  void TakeMsys(const AptStatement& statement);
  Eigen::Vector3d Placed(const Eigen::Vector3d& p) const { return origin + rotation * (unit * p); }
  /// Three numbers of a statement from `first` on as a unit vector. Throws InputError.
  Eigen::Vector3d Direction(const std::vector<double>& v, size_t first, const AptStatement& statement) const;
};

/// Where the tool of a CLDATA file is and how it stands; appends its way to a path.
class AptMotion {
 public:
  AptMotion(const CamReadOptions& options, const SenderRules& rules, SectionTracker& sections, CamPath& path)
      : options_(options), rules_(rules), sections_(sections), path_(path) {}

  void SetAxis(const Eigen::Vector3d& axis) { axis_ = axis; }
  const Eigen::Vector3d& axis() const { return axis_; }
  /// The next motion is a rapid; every other one after it is a cut again.
  void SetRapid() { rapid_ = true; }
  /// The tool left the part for a place that only the machine knows, or is another one.
  void SetFresh();
  void SetFeed(double feed) { feed_ = feed; }
  /// INDIRV: the direction of the next motion at its start.
  void SetTangent(const Eigen::Vector3d& tangent) { tangent_ = tangent; }
  void SetCircle(const AptCircle& circle);
  void SetCycle(std::optional<AptCycle> cycle);

  bool in_cycle() const { return cycle_.has_value(); }
  bool HasPoint() const { return !path_.points.empty(); }
  const Eigen::Vector3d& at() const { return at_; }
  /// Straight, on the circle that was set, or into the hole of the cycle; the axis turns to `axis` on the
  /// way.
  void MoveTo(const Eigen::Vector3d& to, const Eigen::Vector3d& axis, const SourceLocation& place);
  /// Along the spline whose control points are given in the part.
  void Follow(const AptNurbs& nurbs, const std::vector<Eigen::Vector3d>& control);
  /// Throws InputError when a circle is left over.
  void CheckEnd() const;
  size_t circles() const { return circles_; }
  size_t splines() const { return splines_; }
  size_t holes() const { return holes_; }

 private:
  void Append(const std::vector<Eigen::Vector3d>& way, const Eigen::Vector3d& axis_before,
              const SourceLocation& place);
  void AddPoint(const Eigen::Vector3d& position, const Eigen::Vector3d& axis, bool rapid,
                const SourceLocation& place);
  AptCycle CycleAt(const Eigen::Vector3d& point);
  void Drill(const Eigen::Vector3d& point, const SourceLocation& place);

  const CamReadOptions& options_;
  const SenderRules& rules_;
  SectionTracker& sections_;
  CamPath& path_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero(), axis_ = Eigen::Vector3d::UnitZ();
  double feed_ = 0;  // mm/s
  bool rapid_ = false, fresh_ = false;
  std::optional<AptCircle> circle_;
  std::optional<AptCycle> cycle_;
  Eigen::Vector3d before_cycle_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> tangent_;
  Eigen::Vector3d arriving_ = Eigen::Vector3d::Zero();  // direction of the cut before; zero: none
  size_t circles_ = 0, splines_ = 0, holes_ = 0;
};

}  // namespace millpose
