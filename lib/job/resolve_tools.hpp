// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/file_root.hpp"
#include "job/config/cell_settings.hpp"

namespace millpose {

/// Puts the tools of the file that a cell names (`tools_file`) in its place, so that from here on, and in
/// what is written of the cell, they are the cell's own. The file is relative to `folder` and read within
/// `root`. Does nothing for a cell that names none. Throws InputError with the place in the tools file, or
/// that of the key where there is no such file.
void ResolveTools(const std::filesystem::path& folder, const FileRoot& root, CellSettings* cell);

}  // namespace millpose
