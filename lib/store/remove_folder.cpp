// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/remove_folder.hpp"

#include "base/folder.hpp"
#include "store/result_swap.hpp"

namespace millpose {

void RemoveOutputFolder(const OutputFolder& folder) {
  std::filesystem::path path = folder.folder().path();
  if (!path.has_filename()) path = path.parent_path();  // given with a slash behind
  const Folder parent(path.has_parent_path() ? path.parent_path() : ".");
  const std::string name = path.filename().string();
  const Folder own = parent.Below(name);
  for (const std::string& entry : own.Names())
    if (entry != kMark) own.RemoveAll(entry);
  parent.RemoveAll(name);
}

}  // namespace millpose
