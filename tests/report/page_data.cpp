// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/page_data.hpp"

#include <cstring>

namespace millpose {

const Panel& SmallPanel() {
  static const Panel panel =
      MakePanel({.passes = 4, .points = 20}, "</script><script>alert(1)</script> & \"ü\" \xff");
  return panel;
}
const std::string& SmallPage() {
  static const std::string page = ReportHtml(SmallPanel().Input());
  return page;
}

/// The text between `open` and the next `close`.
std::string Between(const std::string& text, const std::string& open, const std::string& close) {
  const size_t from = text.find(open);
  if (from == std::string::npos) return {};
  const size_t start = from + open.size();
  return text.substr(start, text.find(close, start) - start);
}

Json DataOf(const std::string& page) {
  return Json::parse(Between(page, "<script type=\"application/json\" id=\"plan-data\">", "</script>"));
}

std::vector<uint8_t> Decoded(const std::string& text) {
  static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  int held = 0;
  for (char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<uint32_t>(kDigits.find(c));
    held += 6;
    if (held >= 8) bytes.push_back(static_cast<uint8_t>(bits >> (held -= 8)));
  }
  return bytes;
}

std::vector<float> Floats(const Json& text) {
  const std::vector<uint8_t> bytes = Decoded(text.get<std::string>());
  std::vector<float> values(bytes.size() / 4);
  std::memcpy(values.data(), bytes.data(), 4 * values.size());
  return values;
}
std::vector<uint32_t> Uint32s(const Json& text) {
  const std::vector<uint8_t> bytes = Decoded(text.get<std::string>());
  std::vector<uint32_t> values(bytes.size() / 4);
  std::memcpy(values.data(), bytes.data(), 4 * values.size());
  return values;
}

}  // namespace millpose
