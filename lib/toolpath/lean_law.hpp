// SPDX-License-Identifier: GPL-3.0-or-later
// Which leans of the tool axis a milling point admits: docs/lean.md.
#pragma once

#include <memory>

#include "toolpath/lean_surface.hpp"

namespace millpose {

/// What bounds the leans of a job besides their ranges; mm, rad.
struct LeanRules {
  CutterShape cutter;
  double lead = 0, tilt = 0;                ///< nominal: as the tool path is laid
  bool lead_free = true, tilt_free = true;  ///< else it stays at its nominal value
  bool back_and_forth = false;              ///< every other pass runs the other way
  bool by_scallop = false;     ///< passes are laid nearer than `stepover` where the nominal lean needs that
  double stepover = 0;         ///< largest distance of neighbouring passes
  double scallop = 0;          ///< largest height of what they leave; 0: a ball, whose leans leave the same
  double min_speed_share = 0;  ///< of the cutting speed at the nominal lean, of a ball
  std::shared_ptr<const LeanSurface> surface;  ///< null: no part; then nothing bends and nothing gouges
};

/// Lead and tilt of an axis over a surface; unit vectors, rad.
struct Leans {
  double lead, tilt;
};
Leans LeansOf(const Eigen::Vector3d& axis, const Eigen::Vector3d& normal, const Eigen::Vector3d& feed);
/// The axis that leans by `lead` towards the feed, then by `tilt` to the feed's right.
Eigen::Vector3d AxisOf(const Leans& leans, const Eigen::Vector3d& normal, const Eigen::Vector3d& feed);

/// The bound at one point.
class LeanBound {
 public:
  LeanBound(const LeanRules& rules, const Eigen::Vector3d& contact, const Eigen::Vector3d& normal,
            const Eigen::Vector3d& feed);

  /// Whether the cutter leaves no more standing than it may towards either neighbour and, of a ball, cuts
  /// fast enough. The nominal lean is admitted whatever it leaves: the tool path is laid at it.
  bool Admits(const Eigen::Vector3d& axis) const;

 private:
  const LeanRules* rules_;
  Eigen::Vector3d normal_, feed_;
  double bend_ = 0, left_ = 0, right_ = 0;  ///< ways up to which the outline may rise no higher
  double least_radius_ = 0;                 ///< of the contact about the axis, mm
};

}  // namespace millpose
