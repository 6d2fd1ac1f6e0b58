// SPDX-License-Identifier: GPL-3.0-or-later
// The summary that an engineer signs: a plan, or all operations of a job, on two pages
// (docs/summary-sheet.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/path_curves.hpp"
#include "report/setup_sheet.hpp"
#include "report/words/words.hpp"

namespace millpose {

/// A source of the face's error; µm at its largest, none where nothing states it.
struct SummarySource {
  std::string name;
  std::optional<double> um = {};
};

/// A program file; one that is not written has no hash.
struct SummaryProgram {
  std::string controller, file, read_back, hash;
};

/// In English, of any length: SummarySheetHtml shortens it.
struct SummarySheet {
  std::string job, subtitle;
  std::string verdict;                                     ///< done | FINDINGS | INCOMPLETE
  std::vector<std::string> why;                            ///< sentences, of the verdict
  std::vector<std::pair<std::string, std::string>> tiles;  ///< what it is, and its figure
  SheetTable operations;
  std::string error_of;                ///< the operation whose sources these are; empty: the job has one
  std::vector<SummarySource> sources;  ///< empty: no face is cut
  std::vector<PathCurves> courses = {};
  std::vector<std::string> findings = {}, warnings = {};
  std::vector<SummaryProgram> programs = {};
  std::string seal = {};  ///< the sentence that names the hash of all files
};

/// How much of each list the pages hold.
struct SummaryRoom {
  static constexpr size_t kWhyLines = 7, kOperations = 8, kSources = 5;  ///< page 1
  static constexpr size_t kSecondPage = 40;     ///< page 2: lines of findings and warnings, rows of programs
  static constexpr size_t kLeastPrograms = 12;  ///< of them kept for programs
};

/// Two pages A4 without scripts, for any sheet: what does not fit is counted and said to be in report.html.
/// The sheet is in English and said in `language`. A pure function of its arguments.
std::string SummarySheetHtml(const SummarySheet& sheet, Language language = Language::kEnglish);

}  // namespace millpose
