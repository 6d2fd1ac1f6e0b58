// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// A reader of bytes from outside. It may refuse them with InputError; whatever else happens is a fault, also
/// a result that breaks what the reader promises (then std::abort).
struct FuzzEntry {
  std::string name;
  void (*run)(std::string_view bytes);
  int copies = 100;  ///< spoilt copies of every seed in the quick tests: fewer where one costs more
};

/// Every own reader, by what it links.
std::vector<FuzzEntry> YamlEntries();
std::vector<FuzzEntry> MeshEntries();
std::vector<FuzzEntry> CamEntries();
std::vector<FuzzEntry> ProgramEntries();
std::vector<FuzzEntry> VerifyEntries();
/// Programs that came through a reader and were replayed, so far.
int ProgramsReplayed();
std::vector<FuzzEntry> StepEntries();

inline void Demand(bool holds) {
  if (!holds) std::abort();
}

template <class Read>
void LetRefuse(Read read) {
  try {
    read();
  } catch (const InputError& error) {
    Demand(!error.problems().empty());
  }
}

}  // namespace millpose
