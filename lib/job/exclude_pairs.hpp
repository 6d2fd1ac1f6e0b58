// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include "job/config/cell_settings.hpp"

namespace millpose {

/// Looks for bodies on neighbouring links (at most two joints apart) that touch in every one of 200 poses
/// within the limits: their shapes overlap by construction, and no pose would ever be free. With
/// auto_excluded_pairs they become excluded_pairs of the cell (and the key is off afterwards); else a warning
/// proposes them. Does nothing for a cell without that key whose arm did not come from a URDF (`from_urdf`).
/// Throws InputError for bodies that cannot be built.
void ExcludeTouchingNeighbours(const std::map<std::string, std::string>& body_bytes, bool from_urdf,
                               CellSettings* cell);

}  // namespace millpose
