// SPDX-License-Identifier: GPL-3.0-or-later
// Changes of a YAML text that leave everything else as it was, comments included.
#pragma once

#include <string>

#include "base/yaml/value.hpp"

namespace millpose::yaml {

/// The text with `value` (flow style, one line) under `key` of the top level's `section`: in place of what
/// stands there, or as a key more, in the text's own line ends. What comes out says the same but for that
/// key. Throws InputError naming `name` when the section is missing, or when what is to be replaced does not
/// stand in one line.
std::string WithKey(const std::string& text, const std::string& name, const std::string& section,
                    const std::string& key, const std::string& value);

}  // namespace millpose::yaml
