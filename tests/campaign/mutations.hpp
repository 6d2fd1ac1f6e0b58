// SPDX-License-Identifier: GPL-3.0-or-later
// Random changes of program texts: what transfers, edits by hand and misunderstandings make of them.
#pragma once

#include <string>

#include "base/random.hpp"
#include "tests/campaign/trace.hpp"

namespace millpose::campaign {

struct Mutant {
  Files files;
  std::string kind;  ///< "digit", "line dropped", "insert WAIT SEC 0.5", …
  std::string file;
  int line = 0;  ///< from 1
  std::string before, after;

  /// Whether it must pass where it changes nothing on the machine: numbers and looks. Statements that stand
  /// elsewhere or are new may be refused: readers know where each may stand.
  bool MustPass() const;
};

/// Statements of a controller that are inserted, and words that take the place of others.
struct Vocabulary {
  std::vector<std::string> statements;
  std::vector<std::pair<std::string, std::string>> words;
};
const Vocabulary& KrlVocabulary();
const Vocabulary& SinumerikVocabulary();
const Vocabulary& LinuxCncVocabulary();
const Vocabulary& UrScriptVocabulary();
const Vocabulary& FanucVocabulary();
const Vocabulary& RapidVocabulary();

/// One random change of one file, or two, or one all through it; `controller` says whose words it takes,
/// `other` is the same program of another plan.
Mutant Mutate(const Files& files, const Files& other, const std::string& controller, RandomStream& random);

}  // namespace millpose::campaign
