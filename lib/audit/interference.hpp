// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "audit/setup.hpp"

namespace millpose::audit {

/// Two bodies that touch, and at which angles.
struct Contact {
  std::string first, second;
  Angles angles;
};

/// Two bodies that are nearer than the cell asks for.
struct Near {
  std::string first, second;
  double distance, wanted;  ///< mm
};

/// Where the external axes stand: mm or rad, one for each.
using Position = std::vector<Real>;

/// Straight in joint space.
struct Motion {
  Angles from, to;
  bool cutting = false;  ///< the cutter may be in the workpiece with its cutting length
  /// The external axes go evenly from one to the other meanwhile; empty: they stand where they are.
  Position external_from = {}, external_to = {};
};

/// Looks at poses and motions with plain FCL collision of full triangle meshes. What it finds touching
/// touches; clearances are looked at apart.
class Judge {
 public:
  explicit Judge(const Setup& setup);
  ~Judge();

  /// The external axes stand at `position` from now on; at 0 before. Empty: as the setup has it.
  void Stand(const Position& position);

  /// Pairs that come nearer than their clearance less `slack` (mm) at positions on the even move of the
  /// external axes from one to another, the arm standing still: each with its least distance, 0 where they
  /// touch. No point travels more than `travel` mm from one position to the next. Also of bodies that stand
  /// still otherwise. The axes stand at `to` then.
  std::vector<Near> Moving(const Position& from, const Position& to, const Angles& angles, double slack,
                           double travel);

  /// The first pair that touches; with `inside`, also bodies wholly inside another. `cutting`: the cutter may
  /// be in the workpiece with its cutting length.
  std::optional<Contact> At(const Angles& angles, bool cutting, bool inside);

  /// Looks at poses on a motion so that no point of what moves travels more than `travel` mm from one to the
  /// next; both ends included. Where external axes move, also at bodies that stand still otherwise; they
  /// stand at the motion's end then.
  std::optional<Contact> Between(const Motion& motion, double travel);

  /// Pairs that come nearer than `share` of their clearance less `slack` (mm) at such poses: each with its
  /// least distance.
  std::vector<Near> TooNear(const Motion& motion, double share, double slack, double travel);

  /// Distance of the bodies of these names at a pose, mm, up to `bound`; 0 when they touch or one is inside
  /// the other. While cutting, the part of the cutter that may be in the workpiece is left out against it.
  Real Distance(const std::string& first, const std::string& second, const Angles& angles, bool cutting,
                Real bound);

  /// Radius of the largest of the spheres around the bodies of that name, mm.
  Real Radius(const std::string& name) const;

  long long poses() const;  ///< looked at so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace millpose::audit
