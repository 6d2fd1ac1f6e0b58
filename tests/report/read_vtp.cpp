// SPDX-License-Identifier: GPL-3.0-or-later
#include "read_vtp.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>

namespace millpose::test {
namespace {

std::string Attribute(const std::string& tag, const std::string& name) {
  const size_t at = tag.find(' ' + name + "=\"");
  if (at == std::string::npos) return "";
  const size_t begin = at + name.size() + 3;
  return tag.substr(begin, tag.find('"', begin) - begin);
}

std::string FromBase64(const std::string& text) {
  std::string bytes;
  unsigned bits = 0, value = 0;
  for (const char c : text) {
    if (c == '=') break;
    const unsigned digit = c >= 'a'   ? static_cast<unsigned>(c - 'a') + 26
                           : c >= 'A' ? static_cast<unsigned>(c - 'A')
                           : c >= '0' ? static_cast<unsigned>(c - '0') + 52
                           : c == '+' ? 62
                                      : 63;
    value = (value << 6 | digit) & 0xffff;
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>(value >> (bits -= 8) & 0xff);
  }
  return bytes;
}

/// The numbers of an array of eight bytes each.
template <class T>
std::vector<double> Numbers(const std::string& text) {
  const auto word = [](const std::string& bytes, size_t i) {
    uint64_t value = 0;
    std::memcpy(&value, bytes.data() + 8 * i, 8);
    return value;
  };
  const uint64_t blocks = word(FromBase64(text.substr(0, 12)), 0);
  const size_t header_text = (8 * (3 + blocks) + 2) / 3 * 4;
  const std::string header = FromBase64(text.substr(0, header_text)),
                    data = FromBase64(text.substr(header_text));
  const uint64_t size = word(header, 1), last = word(header, 2);
  std::vector<double> numbers;
  size_t at = 0;
  for (uint64_t block = 0; block < blocks; ++block) {
    uLongf length = block + 1 == blocks && last > 0 ? last : size;
    std::vector<T> values(length / sizeof(T));
    const uint64_t packed = word(header, 3 + block);
    EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(values.data()), &length,
                         reinterpret_cast<const Bytef*>(data.data()) + at, packed),
              Z_OK);
    EXPECT_EQ(length, values.size() * sizeof(T));
    numbers.insert(numbers.end(), values.begin(), values.end());
    at += packed;
  }
  EXPECT_EQ(at, data.size());
  return numbers;
}

}  // namespace

VtpArrays ReadVtp(const std::string& xml) {
  VtpArrays arrays;
  std::vector<std::string> open;
  std::string parent;
  for (size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const size_t end = xml.find('>', at);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.starts_with("?")) continue;
    if (tag.starts_with("/")) {
      EXPECT_FALSE(open.empty());
      EXPECT_EQ(open.back(), tag.substr(1));
      open.pop_back();
      continue;
    }
    open.push_back(tag.substr(0, tag.find(' ')));
    if (open.back() == "Piece")
      for (const char* name : {"NumberOfPoints", "NumberOfVerts", "NumberOfLines"})
        arrays.attributes[name] = Attribute(tag, name);
    if (open.back() != "DataArray") continue;
    const std::string name = open[open.size() - 2] + "/" + Attribute(tag, "Name");
    const std::string text = xml.substr(end + 2, xml.find('\n', end + 2) - end - 2);
    arrays.values[name] = Attribute(tag, "type") == "Int64" ? Numbers<int64_t>(text) : Numbers<double>(text);
  }
  EXPECT_TRUE(open.empty());
  return arrays;
}

}  // namespace millpose::test
