// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/resolve_tools.hpp"

#include <utility>

#include "base/error.hpp"
#include "job/config/config.hpp"

namespace millpose {

void ResolveTools(const std::filesystem::path& folder, const FileRoot& root, CellSettings* cell) {
  if (cell->tools_file.empty()) return;
  const std::filesystem::path file = (folder / cell->tools_file).lexically_normal();
  if (!std::filesystem::exists(file))
    throw InputError(
        SourceLocation{cell->file, cell->tools_line},
        fmt::format("tools_file: there is no file {}; expected: a tools file (millpose_tools: 1)",
                    file.string()));
  cell->tools = ParseTools(root.Read(file), file.string()).tools;
  cell->tool = cell->tools.front();
  cell->tools_file.clear();
}

}  // namespace millpose
