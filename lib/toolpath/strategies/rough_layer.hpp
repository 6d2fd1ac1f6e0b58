// SPDX-License-Identifier: GPL-3.0-or-later
// The cuts of one layer, entries and ways between them (docs/rough.md).
#pragma once

#include <stop_token>

#include "toolpath/strategies/rough_march.hpp"

namespace millpose {

/// How a place is come to.
enum class RoughMotion : uint8_t {
  kEntry,  ///< down into material, on a helix or a ramp
  kCut,
  kAir,  ///< in the layer's floor, where nothing stands
};

struct RoughVertex {
  Eigen::Vector3d place;  ///< of the tip; z along the tool axis, mm
  RoughMotion motion = RoughMotion::kCut;
};

struct RoughLayerOptions {
  RoughMarchOptions march;
  CutterShape cutter;
  bool centre_cutting = false;
  double ramp = 0;   ///< rad
  double chord = 0;  ///< mm
  double floor = 0;  ///< height of the tip, mm
  double above = 0;  ///< the highest that stands after the layer before, mm
};

struct RoughLayer {
  std::vector<std::vector<RoughVertex>> passes;  ///< straight from place to place
  double left = 0;                               ///< area that the cutter reaches and that stands, mm²
  Eigen::Vector2d left_at = Eigen::Vector2d::Zero();
  bool without_entry = false;  ///< some of it for want of room to go down
};

/// Clears a layer: where material is open to a side from there, else from an entry within; each cut from the
/// next place that the tool can come to without meeting material. `tops`: how high material stands by cell,
/// mm. Throws Interrupted.
RoughLayer RoughLayerOf(RoughMaterial material, const RoughRoom& room, const std::vector<float>& tops,
                        const RoughLayerOptions& options, const std::stop_token& stop);

}  // namespace millpose
