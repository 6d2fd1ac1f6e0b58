// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/freedom_entry.hpp"

namespace millpose {

/// Defined in freedoms/<name>.cpp.
FreedomEntry RotationEntry(), LeadEntry(), TiltEntry();

Registry<FreedomEntry>& Freedoms() {
  static Registry<FreedomEntry> freedoms{"freedom", {RotationEntry(), LeadEntry(), TiltEntry()}};
  return freedoms;
}

std::vector<FreedomPointer> FreedomsOf(const OpenToolpath& toolpath) {
  std::vector<FreedomPointer> freedoms;
  for (const FreedomEntry& entry : Freedoms().entries()) {
    const auto opened = toolpath.freedoms.find(entry.name);
    if (entry.always) freedoms.push_back(entry.always);
    if (opened != toolpath.freedoms.end()) freedoms.push_back(opened->second);
  }
  return freedoms;
}

std::string LeanKeys() {
  std::vector<std::string> keys;
  for (const FreedomEntry& entry : Freedoms().entries())
    if (entry.leans) keys.push_back(entry.key->info.key);
  std::string all = keys[0];
  for (size_t k = 1; k < keys.size(); ++k) all += (k + 1 < keys.size() ? ", " : " or ") + keys[k];
  return all;
}

}  // namespace millpose
