// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer's entry for one reader: MILLPOSE_FUZZ_ENTRY of MILLPOSE_FUZZ_GROUP().
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/entries.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::vector<millpose::FuzzEntry> group = millpose::MILLPOSE_FUZZ_GROUP();
  static const auto entry = std::ranges::find(group, MILLPOSE_FUZZ_ENTRY, &millpose::FuzzEntry::name);
  entry->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
