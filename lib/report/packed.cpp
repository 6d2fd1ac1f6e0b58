// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/packed.hpp"

#include <bit>
#include <vector>

namespace millpose {
namespace {

// Little-endian whatever the machine is.
template <typename Word>
std::string PackWords(size_t count, const auto& word) {
  std::vector<uint8_t> bytes(count * sizeof(Word));
  for (size_t i = 0; i < count; ++i) {
    const Word w = word(i);
    for (size_t b = 0; b < sizeof(Word); ++b)
      bytes[i * sizeof(Word) + b] = static_cast<uint8_t>(w >> (8 * b));
  }
  return Base64(bytes);
}

}  // namespace

std::string Base64(std::span<const uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  char* to = text.data();
  for (size_t i = 0; i < bytes.size(); i += 3, to += 4) {
    const size_t left = bytes.size() - i;
    const uint32_t triple = uint32_t{bytes[i]} << 16 | (left > 1 ? uint32_t{bytes[i + 1]} << 8 : 0) |
                            (left > 2 ? uint32_t{bytes[i + 2]} : 0);
    to[0] = kDigits[triple >> 18];
    to[1] = kDigits[triple >> 12 & 63];
    if (left > 1) to[2] = kDigits[triple >> 6 & 63];
    if (left > 2) to[3] = kDigits[triple & 63];
  }
  return text;
}

std::string PackFloats(std::span<const float> values) {
  return PackWords<uint32_t>(values.size(), [&](size_t i) { return std::bit_cast<uint32_t>(values[i]); });
}

std::string PackUint32(std::span<const uint32_t> values) {
  return PackWords<uint32_t>(values.size(), [&](size_t i) { return values[i]; });
}

std::string PackUint16(std::span<const uint16_t> values) {
  return PackWords<uint16_t>(values.size(), [&](size_t i) { return values[i]; });
}

}  // namespace millpose
