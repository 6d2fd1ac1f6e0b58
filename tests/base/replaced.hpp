// SPDX-License-Identifier: GPL-3.0-or-later
// Texts changed for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace millpose {

/// `text` with `to` where `from` first stands; a failure where it stands nowhere.
inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// The same wherever it stands, if anywhere.
inline std::string Everywhere(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace millpose
