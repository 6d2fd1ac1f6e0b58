// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/units.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

/// A closed border of the region, or a stretch of it; the cutter runs where the region is not.
struct TrimBorder {
  std::optional<Eigen::Vector3d> near;   ///< the border that comes nearest to it, mm
  std::vector<Eigen::Vector3d> between;  ///< none, or two places near the ends of the stretch by `near`
};

/// Which side of a line the cutter runs on, seen against the tool axis along the line's own way.
enum class LineSide : uint8_t { kLeft, kRight, kInside, kOutside };

struct TrimLine {
  std::vector<Eigen::Vector3d> points;  ///< on the surface, P, mm; straight between them
  bool closed = false;
  LineSide side = LineSide::kLeft;
  bool blank = false;  ///< the mesh is uncut along the line: what the cutter takes there is no gouge
};

/// What is left standing to hold the piece.
struct TrimTabs {
  std::optional<int> count;             ///< evenly along the contour, or
  std::vector<Eigen::Vector3d> places;  ///< near these, mm
  double width = 0;                     ///< along the contour, mm
  double height = 0;                    ///< over the part's far side, mm
};

enum class TrimEntry : uint8_t {
  kHelix,   ///< down along the lead-in's circle
  kPlunge,  ///< straight down where the lead-in begins
};

/// An edge or closed contour, cut through.
struct Trim final : Strategy {
  std::optional<TrimBorder> border;
  std::optional<TrimLine> line;
  bool climb = true;
  double through = 0;                 ///< of the part, along the tool axis, mm
  double overcut = 0;                 ///< beyond it, mm
  std::optional<double> per_depth;    ///< largest depth of a round, mm; one round by default
  double allowance = 0;               ///< left on the edge, mm
  std::optional<double> lead_radius;  ///< of lead-in and lead-out, mm; 0.8 of the cutter's by default
  double overlap = 2;                 ///< by which a closed contour runs on over its start, mm
  TrimEntry entry = TrimEntry::kHelix;
  double ramp = DegToRad(3);             ///< of helix and tabs' ends, rad
  std::optional<Eigen::Vector3d> start;  ///< a closed contour begins near it, mm
  std::optional<TrimTabs> tabs;

  std::string Name() const override { return "trim"; }
  bool NeedsPart() const override { return border.has_value(); }
  bool IsPrescribed() const override { return true; }
  bool HasMillingForce() const override { return false; }
  bool MillsWithSide() const override { return true; }
  std::vector<std::string> WithoutEffect() const override;
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;

  /// mm, given or by the cutter.
  double LeadRadius(double cutter_radius) const { return lead_radius.value_or(0.8 * cutter_radius); }
};

}  // namespace millpose
