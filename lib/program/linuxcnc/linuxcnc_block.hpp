// SPDX-License-Identifier: GPL-3.0-or-later
// A block of RS-274/NGC as LinuxCNC takes it: its words, each once.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "program/scanner.hpp"

namespace millpose {

inline constexpr bool kLinuxCncBlanks = true;  ///< count for nothing, also within numbers

/// What one block programs. Every letter but G and M stands once.
struct LinuxCncBlock {
  std::map<char, double> words;  ///< all but G and M
  std::vector<double> g, m;
  bool calls = false;  ///< a program of the plant

  /// Adds the code of a G word (an M word) that was read from `start` on; Fail()s on one that this reader
  /// does not know, or a second one of its modal group.
  void AddG(const LineScanner& scan, size_t start, double code);
  void AddM(const LineScanner& scan, size_t start, double code);
  /// Takes a word of one of `letters` with its number; false when another comes next.
  bool AcceptWord(LineScanner& scan, std::string_view letters);

  bool Has(char letter) const { return words.contains(letter); }
  bool HasG(double code) const { return std::ranges::find(g, code) != g.end(); }
  bool HasM(double code) const { return std::ranges::find(m, code) != m.end(); }
  std::optional<double> Word(char letter) const {
    const auto found = words.find(letter);
    return found == words.end() ? std::nullopt : std::optional(found->second);
  }
};

/// Takes O<name> CALL [1] [2], or a user's M101: the name, and its arguments behind `arguments`.
std::optional<std::string> AcceptLinuxCncCall(LineScanner& scan, std::string& arguments);

}  // namespace millpose
