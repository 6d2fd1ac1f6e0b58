// SPDX-License-Identifier: GPL-3.0-or-later
// The built-in materials by name, and by the other names that shops call them (docs/process-force.md).
#pragma once

#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// Another name of a material of CuttingMaterials(): a number of a standard, a trade name.
struct MaterialAlias {
  std::string alias;
  std::string name;  ///< of the table
};

const std::vector<MaterialAlias>& MaterialAliases();

/// `name` as materials are compared: without case, blanks, hyphens, underscores and "EN AW", "EN AC" in
/// front.
std::string MaterialKey(const std::string& name);

/// The material with that name or alias; null when there is none.
const CuttingMaterial* FindCuttingMaterial(const std::string& name);

/// What is wrong with a `name` that FindCuttingMaterial() does not know: what is allowed and the nearest name
/// or alias, or, of a composite, why there is no value.
std::string UnknownMaterial(const std::string& name);

}  // namespace millpose
