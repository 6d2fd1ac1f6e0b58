// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/file_root.hpp"
#include "job/config/cell_settings.hpp"

namespace millpose {

/// Replaces the URDF or the D-H table that a cell names by what it says: lengths, signs, offsets, limits and
/// speeds of the arm, and a body of class link for every collision shape, named after its link. Where the
/// URDF's base or flange is not the closed form's, what hangs on them is moved over. Paths of the cell are
/// relative to `folder`; the URDF is read within `root`. Of a table there are no bodies, limits and speeds.
/// Does nothing without either. Throws InputError with the place in the URDF or the cell.
void ResolveUrdf(const std::filesystem::path& folder, const FileRoot& root, CellSettings* cell);

}  // namespace millpose
