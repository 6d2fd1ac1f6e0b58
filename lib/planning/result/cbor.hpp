// SPDX-License-Identifier: GPL-3.0-or-later
// CBOR (RFC 8949) item by item, as much of it as plans need: no tree of all values stands between them and
// their bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace millpose {

/// Appends items to a text. Lists and maps have definite lengths: their items follow.
class CborWriter {
 public:
  explicit CborWriter(std::string& out) : out_(out) {}

  void Map(size_t entries) { Head(5, entries); }
  void List(size_t items) { Head(4, items); }
  void Text(std::string_view text);
  void Integer(int64_t value);
  void Unsigned(uint64_t value) { Head(0, value); }
  void Bool(bool value) { out_ += static_cast<char>(value ? 0xf5 : 0xf4); }
  /// Exact: in four bytes where these hold the same value, else in eight.
  void Number(double value);

 private:
  void Head(int major, uint64_t value);
  void BigEndian(uint64_t value, int bytes);

  std::string& out_;
};

/// Reads items in their order. Each throws std::runtime_error for another kind of item, a value that is out
/// of range, and at the end of the bytes.
class CborReader {
 public:
  explicit CborReader(std::string_view bytes) : rest_(bytes) {}

  size_t Map() { return Count(5); }
  /// Items are at least a byte long each: more than there are bytes left is refused.
  size_t List() { return Count(4); }
  std::string_view Text();
  /// Whether the next item is this text; nothing is read.
  bool IsNext(std::string_view text) const;
  int64_t Integer();
  uint64_t Unsigned();
  bool Bool();
  /// A number of either kind.
  double Number();
  bool AtEnd() const { return rest_.empty(); }

 private:
  uint64_t Count(int major);
  uint64_t Head(int major);
  uint64_t Argument(int info);
  uint64_t BigEndian(int bytes);
  uint8_t Byte();

  std::string_view rest_;
};

}  // namespace millpose
