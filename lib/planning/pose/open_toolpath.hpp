// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <map>

#include "planning/pose/freedom.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

/// A tool path of which a job leaves something to the pose search.
struct OpenToolpath : ToolpathOptions {
  std::map<std::string, FreedomPointer> freedoms;  ///< that it opens, by name

  /// The freedom called `name`; null where the job does not open it.
  const Freedom* Find(const std::string& name) const {
    const auto found = freedoms.find(name);
    return found == freedoms.end() ? nullptr : found->second.get();
  }
  bool Leans() const {
    return std::ranges::any_of(freedoms, [](const auto& freedom) { return freedom.second->IsLean(); });
  }
};

}  // namespace millpose
