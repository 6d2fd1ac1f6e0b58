// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/units.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

enum class LeadShape : uint8_t {
  kNone,
  kNormal,  ///< straight down along the normal
  kRamp,    ///< straight, forwards and down under an angle
  kArc,     ///< a quarter circle in the plane of feed and normal, tangent to the pass
  kAlong,   ///< in: to and fro along the pass itself, ever deeper; out: straight up along the normal
};

/// What is added at the ends of each pass; mm, rad. With a lead, a closed pass is opened where it starts: it
/// runs on over its start by the overrun before it is left. Without one, closed passes stay as they are.
struct PassEnds {
  double overrun = 0;  ///< straight on beyond both ends, so that the cutter leaves the material
  LeadShape lead = LeadShape::kNone;
  double lead_length = 10;           ///< normal and ramp: its length; arc: its radius; along: its height
  double ramp_angle = DegToRad(15);  ///< ramp and along: against the tangent plane
};

/// Adds overrun and leads to both ends of the passes, as points of kind kLeadIn and kLeadOut that keep
/// normal, tool axis and feed rate of the end they belong to; `spacing` (mm) is the largest distance of the
/// new points. Arc lengths count from the new start. A pass that is entered along itself cannot be turned
/// round any more, and a closed one is opened where it begins. Throws InputError for one that is shorter than
/// `least_along` (mm): a cutter that does not cut over its centre would leave a core standing.
void AddPassEnds(const PassEnds& ends, double spacing, Toolpath& toolpath, double least_along = 0);

/// Depth of cut: the tool path is repeated at offsets along the normals.
struct Layers {
  double total = 0;      ///< material above the surface, mm; 0: one layer on the surface
  double per_layer = 1;  ///< largest depth of one layer, mm
  double allowance = 0;  ///< left on the surface, mm
  double finishing = 0;  ///< depth of the last layer, of the total, mm; 0: as the others
};

/// Offsets of the layers from the surface, from the outermost to the last, in even steps down to the last; at
/// least one.
std::vector<double> LayerOffsets(const Layers& layers);

/// The layers in the order of LayerOffsets, each with all passes. Offset along the normals,
/// so creases and concave places tighter than the offset are not looked at.
Toolpath Layered(const Toolpath& toolpath, const Layers& layers);

}  // namespace millpose
