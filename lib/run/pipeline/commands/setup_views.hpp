// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of a setup sheet: one for each station of the external axes.
#pragma once

#include <span>

#include "geometry/mesh/mesh.hpp"
#include "machine/collision/cell.hpp"
#include "report/setup_sheet.hpp"
#include "run/pipeline/commands/operation_json.hpp"

namespace millpose {

/// Of each setup; where the axes stand for the others, the sheet has in its table.
inline constexpr size_t kMostStationPictures = 12;

/// The part in its fixture as it stands for `operations`, which are all of one setup: one section where
/// nothing moves beside the arm, else one for each station in the order of the work, the first
/// kMostStationPictures of them. In colour is what is milled there, grey what is milled at the others.
std::vector<SheetSection> SetupViews(std::span<const OperationWithTree> operations, const Cell& cell,
                                     const Mesh& part, Language language);

}  // namespace millpose
