// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/work_folder.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/file.hpp"
#include "store/remove_folder.hpp"

namespace millpose {

namespace fs = std::filesystem;

fs::path WorkFolder::PathFor(const fs::path& out) {
  return out.parent_path() / fmt::format(".{}.init", out.filename().string());
}

WorkFolder::WorkFolder(const fs::path& out) : path_(PathFor(out)) {
  for (fs::path parent = path_.parent_path(); !Exists(parent); parent = parent.parent_path())
    made_.push_back(parent);
  folder_.emplace(path_, FolderUse::kResults);
}

WorkFolder::~WorkFolder() {
  if (stays_) return;
  try {
    RemoveOutputFolder(*folder_);
  } catch (const InputError&) {  // what cannot be removed stays; the files that count are not in it
  }
  std::error_code ignored;
  for (const fs::path& parent : made_) fs::remove(parent, ignored);  // only where nothing is in it
}

fs::path WorkFolder::Trial(int number) const { return path_ / fmt::format("trial_{}", number); }

}  // namespace millpose
