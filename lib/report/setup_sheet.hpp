// SPDX-License-Identifier: GPL-3.0-or-later
// The setup sheet: what a workshop needs on paper before a job is milled (docs/setup-sheet.md).
#pragma once

#include <string>
#include <vector>

#include "report/words/words.hpp"

namespace millpose {

struct SheetTable {
  std::vector<std::string> columns;            ///< heads, units in them
  std::vector<std::vector<std::string>> rows;  ///< as many cells as columns
  size_t names = 0;  ///< first columns of rows that hold names, which no language changes
};

/// A part of the sheet; what it has none of is left out.
struct SheetSection {
  std::string title;
  std::string note = {};                ///< one paragraph before the rest
  std::vector<std::string> list = {};   ///< findings, warnings
  std::vector<std::string> steps = {};  ///< to be ticked off, in their order
  SheetTable table = {};
  std::string picture = {};  ///< an SVG
  bool new_page = false;     ///< on paper
};

struct SetupSheet {
  std::string title, subtitle;
  std::vector<SheetSection> sections;
  std::vector<std::pair<std::string, std::string>> appendix;  ///< files by name, printed as they are
};

/// A page without scripts that prints on A4 with page numbers: a pure function of its arguments. The sheet is
/// in English and said in `language`; its pictures and its appendix stay as they are.
std::string SetupSheetHtml(const SetupSheet& sheet, Language language = Language::kEnglish);

}  // namespace millpose
