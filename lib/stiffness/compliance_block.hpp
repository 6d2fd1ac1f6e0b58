// SPDX-License-Identifier: GPL-3.0-or-later
// Compliance and its indices for a block of poses, one per lane.
#pragma once

#include "base/lanes.hpp"

namespace millpose {

/// Linear compliance c of a block, mm/N, base frame, symmetric.
struct ComplianceBlock {
  Lanes xx, yy, zz, xy, xz, yz;
};

}  // namespace millpose
