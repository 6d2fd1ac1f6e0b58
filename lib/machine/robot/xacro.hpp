// SPDX-License-Identifier: GPL-3.0-or-later
// What of xacro needs no evaluation; for urdf.cpp alone, since types of tinyxml2 stay inside it.
#pragma once

#include <string>

#include "machine/robot/urdf.hpp"

namespace tinyxml2 {
class XMLDocument;
}

namespace millpose {

/// Whether any element is xacro's.
bool IsXacro(const tinyxml2::XMLDocument& document);

/// Expands plain properties (`${name}`), macros without parameters and includes by path, in place. Throws
/// InputError for anything else, with its line: expressions, parameters, conditions, `$(find …)`; and for
/// includes that go round.
void ExpandXacro(tinyxml2::XMLDocument& document, const std::string& file, const XacroInclude& include);

}  // namespace millpose
