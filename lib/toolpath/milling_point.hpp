// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

namespace millpose {

enum class PointKind : uint8_t { kCut, kLeadIn, kLeadOut };

/// Which way the edge meets the material: from thin to thick chips (up, conventional), from thick to thin
/// (down, climb), on both sides, or not at all.
enum class CutSide : uint8_t { kAir, kUp, kDown, kSlot };

/// air | up | down | slot
inline const char* Name(CutSide side) {
  constexpr const char* kNames[] = {"air", "up", "down", "slot"};
  return kNames[static_cast<size_t>(side)];
}

/// What the cutter takes off at a point, and what that does to it (docs/engagement.md).
struct Engagement {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< mean over a revolution, on the tool, N
  double width = 0, depth = 0;                      ///< mm, across feed, along normal; a drill's D, a_p
  CutSide side = CutSide::kAir;
};

/// What the pass itself cuts open, as heights over the tip along the tool axis, mm: between them the cutter
/// stands in its own hole or kerf. Negative ones lie under the tip.
struct OwnCut {
  double top = 0;     ///< the cut begins here
  double out = -1e9;  ///< and ends here, where the tip comes out at the far side
};

/// One milling point. Vectors are unit vectors, lengths mm, in the frame of the list that holds it (P, the
/// workpiece, as strategies make it; W, the world, from the planner on).
struct MillingPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     ///< out of the material
  Eigen::Vector3d feed = Eigen::Vector3d::UnitX();       ///< direction of travel, in the tangent plane
  Eigen::Vector3d tool_axis = Eigen::Vector3d::UnitZ();  ///< from tip to holder
  double feed_rate = 0;                                  ///< mm/s
  double arc_length = 0;                                 ///< along its pass, mm
  PointKind kind = PointKind::kCut;
  int region = 0;
  int source_line = 0;    ///< of an imported tool path; 0 when made here
  double gouge = 0;       ///< how deep the cutter would go into the part, mm; above 0: not to be milled
  Engagement engagement;  ///< where the job says what is cut
  std::optional<OwnCut>
      own;  ///< for the gouge check alone; kept neither with plans nor when a point is moved
};

/// Whether two points ask for the same place and direction of the tool.
inline bool IsSamePlace(const MillingPoint& a, const MillingPoint& b) {
  return a.position == b.position && a.normal == b.normal && a.tool_axis == b.tool_axis;
}

/// Whether a closed pass may be left open where it is planned.
enum class RingOpening : uint8_t {
  kNone,      ///< it stays closed
  kAtStart,   ///< it begins and ends at its first point
  kAnywhere,  ///< where that costs least
};

/// A cut without lifting the tool. A closed pass ends where it starts: its first point is not repeated at its
/// end.
struct Pass {
  std::vector<MillingPoint> points;
  bool closed = false;
  /// Direction from which the rotation about the tool axis is counted, constant over the pass (unit vector,
  /// same frame as the points).
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();
  RingOpening opening = RingOpening::kNone;  ///< of a closed pass
  bool reversible = false;                   ///< may be milled from either end
  bool whole = false;  ///< milled with all its points or not at all: a hole is not begun half-way down
};

struct Toolpath {
  std::vector<Pass> passes;
  std::vector<std::string> notes;  ///< what the user should know of it, one sentence each
};

}  // namespace millpose
