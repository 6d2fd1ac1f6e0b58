// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// Words of a CAM file that are no motion: those known to be harmless by count, and those not known, which
/// are refused together once the file has been read.
class WordTally {
 public:
  void CountHarmless(const std::string& word) { ++harmless_[word.substr(0, kShown)]; }
  /// Each kind of word is reported once, with the place of the first and how many there are.
  void AddUnknown(const std::string& word, const SourceLocation& place);
  /// Throws InputError when there are unknown words, or `more` that stopped the reading.
  void RefuseUnknown(const std::vector<Problem>& more) const;
  bool empty() const { return unknown_.empty(); }
  /// "skipped, as they say nothing about the motion: 12 PAINT, 1 PARTNO".
  void AddNote(std::vector<std::string>& notes) const;

 private:
  static constexpr size_t kShown = 40;  // characters
  struct Unknown {
    std::string word;
    SourceLocation place;
    size_t count = 0;
  };
  std::map<std::string, size_t> harmless_;
  std::vector<Unknown> unknown_;
};

}  // namespace millpose
