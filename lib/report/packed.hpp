// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as base64 of little-endian typed arrays: a quarter of the size of decimal text, and no parsing.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace millpose {

std::string Base64(std::span<const uint8_t> bytes);

/// IEEE floats; NaN stays NaN (the page reads it as "no value").
std::string PackFloats(std::span<const float> values);
std::string PackUint32(std::span<const uint32_t> values);
std::string PackUint16(std::span<const uint16_t> values);

}  // namespace millpose
