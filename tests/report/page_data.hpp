// SPDX-License-Identifier: GPL-3.0-or-later
// What report.html carries, read back.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/report/panel_plan.hpp"

namespace millpose {

using Json = nlohmann::json;

/// A panel whose job has a hostile name, and its page.
const Panel& SmallPanel();
const std::string& SmallPage();

/// The text between `open` and the next `close`.
std::string Between(const std::string& text, const std::string& open, const std::string& close);

/// The data of a page's scripts.
Json DataOf(const std::string& page);

/// Base64 as bytes, and these as numbers of 32 bits.
std::vector<uint8_t> Decoded(const std::string& text);
std::vector<float> Floats(const Json& text);
std::vector<uint32_t> Uint32s(const Json& text);

}  // namespace millpose
