// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/word_tally.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace millpose {
namespace {

constexpr size_t kMostListed = 50;  // kinds of words

}  // namespace

void WordTally::AddUnknown(const std::string& word, const SourceLocation& place) {
  const std::string shown = word.substr(0, kShown);
  const auto found = std::ranges::find(unknown_, shown, &Unknown::word);
  if (found != unknown_.end()) {
    ++found->count;
  } else if (unknown_.size() < kMostListed) {
    unknown_.push_back({shown, place, 1});
  }
}

void WordTally::RefuseUnknown(const std::vector<Problem>& more) const {
  if (unknown_.empty() && more.empty()) return;
  std::vector<Problem> problems;
  for (const Unknown& unknown : unknown_)
    problems.push_back(
        {unknown.place,
         fmt::format(
             "\"{}\" is not known ({} in the file), and a word that is not known may change the path: "
             "take it out if it says nothing about the motion",
             unknown.word, unknown.count)});
  problems.insert(problems.end(), more.begin(), more.end());
  throw InputError(problems);
}

void WordTally::AddNote(std::vector<std::string>& notes) const {
  if (harmless_.empty()) return;
  std::string list;
  size_t listed = 0;
  for (const auto& [word, count] : harmless_)
    if (++listed <= kMostListed) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, word);
  if (listed > kMostListed) list += fmt::format(", {} further kinds of words", listed - kMostListed);
  notes.push_back("skipped, as they say nothing about the motion: " + list);
}

}  // namespace millpose
