// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

enum class PlyFormat : uint8_t { kAscii, kLittleEndian, kBigEndian };
enum class PlyType : uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

/// Bytes of a binary value.
int SizeOf(PlyType type);

struct PlyProperty {
  std::string name;
  bool list = false;
  PlyType count_type = PlyType::kUint8;  ///< of a list
  PlyType type = PlyType::kFloat;
};

struct PlyElement {
  std::string name;
  long long count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t size = 0;  ///< bytes up to the first value
  int lines = 0;    ///< lines up to there
};

/// Reads the header and checks each count against the bytes that follow it. Throws InputError with line and
/// column.
PlyHeader ReadPlyHeader(std::string_view bytes, const std::string& name);

}  // namespace millpose
