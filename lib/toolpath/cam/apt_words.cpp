// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_words.hpp"

#include <set>

#include "base/text.hpp"
#include "toolpath/cam/gcode_words.hpp"

namespace millpose {
namespace {

const std::set<std::string_view> kMotions{"GOTO",   "FROM",   "GODLTA", "RAPID", "CIRCLE",
                                          "MOVARC", "INDIRV", "NURBS",  "CYCLE"};

const std::set<std::string_view> kStates{"FEDRAT", "SPINDL", "CUTTER", "TLDATA", "TLAXIS", "MSYS",   "UNITS",
                                         "UNIT",   "ORIGIN", "TRANS",  "LOADTL", "TOOLNO", "TURRET", "LOAD"};

// Texts, displays, auxiliary functions, tolerances of the processor, modes of a postprocessor's output.
const std::set<std::string_view> kHarmlessWords{
    "ARCSLP", "AUTOPS", "AUXFUN",      "CHANNEL",  "CLEARP", "CLPRNT", "COOLNT", "CUTCOM", "DELAY",
    "DISPLY", "END",    "FINI",        "HEAD",     "HEADER", "INSERT", "INTOL",  "ISN",    "LEADER",
    "LINTOL", "MACHIN", "MCHTOL",      "MODE",     "MULTAX", "NOPOST", "OFSTNO", "OPSKIP", "OPSTOP",
    "OUTTOL", "PAINT",  "PARTNO",      "PLABEL",   "PPRINT", "PREFUN", "PROGRM", "REMARK", "REWIND",
    "SELECT", "SEQNO",  "SLOWDN",      "STOP",     "TIME",   "TMARK",  "TOLER",  "TPRINT", "TRACUT",
    "UNLOAD", "VERIFY", "END-OF-PATH", "TOOL PATH"};

const std::set<std::string_view> kSurfaceMotions{"TLON",  "TLLFT",  "TLRGT", "TLONPS", "TLOFPS",
                                                 "GOFWD", "GOBACK", "GOLFT", "GORGT",  "GODOWN",
                                                 "GOUP",  "GO",     "GOCLER"};

// Raw text for the machine: spindle, coolant, tool, number of the block, comments. An M code is harmless
// where no control reads motion in it.
bool IsHarmlessInsert(std::string_view text) {
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == ';') return true;
    if (c == '(') {
      const size_t end = text.find(')', i);
      if (end == std::string_view::npos) return true;
      i = end + 1;
    } else if (c == ' ' || c == '\t') {
      ++i;
    } else if (std::string_view("MSTNDH").find(c) != std::string_view::npos) {
      size_t end = i + 1;
      while (end < text.size() && ((text[end] >= '0' && text[end] <= '9') || text[end] == '.')) ++end;
      const auto number = ParseNumber(text.substr(i + 1, end - i - 1));
      if (!number || (c == 'M' && !IsKnownM(*number))) return false;
      i = end;
    } else {
      return false;
    }
  }
  return true;
}

std::string TextOf(const AptStatement& statement) {
  std::string text = statement.major.text.substr(FirstWord(statement.major).size());
  for (const AptWord& word : statement.minors) text += " " + word.text;
  return text;
}

}  // namespace

std::string FirstWord(const AptWord& major) {
  if (major.text.starts_with("TOOL PATH")) return "TOOL PATH";
  return major.text.substr(0, major.text.find_first_of(", \t"));
}

AptMeaning MeaningOf(const AptStatement& statement) {
  if (kMotions.contains(statement.major.text)) return AptMeaning::kMotion;
  if (kStates.contains(statement.major.text)) return AptMeaning::kState;
  const std::string word = FirstWord(statement.major);
  if (word == "RETRCT" || word == "GOHOME") return AptMeaning::kLeaves;
  if (kSurfaceMotions.contains(word)) return AptMeaning::kSurfaceMotion;
  // Free text may follow without a slash: "PPRINT OPERATION 1".
  return kHarmlessWords.contains(word) ? AptMeaning::kHarmless : AptMeaning::kUnknown;
}

void CheckHarmless(const AptStatement& statement) {
  const std::string word = FirstWord(statement.major);
  const std::string first = statement.minors.empty() ? "" : statement.minors[0].text;
  const SourceLocation& place = statement.major.place;
  if (word == "MODE" && !first.empty() && first != "MILL")
    throw InputError(place, fmt::format("MODE/{} is not read; read is MODE/MILL", first.substr(0, 40)));
  if (word == "CUTCOM" && first != "OFF" && first != "NOMORE")
    throw InputError(
        place,
        "CUTCOM shifts the path at the machine: let the CAM system write the way of the cutter's "
        "centre, with CUTCOM/OFF or without the word");
  if (word == "TRACUT" && (statement.minors.empty() || statement.minors.back().text != "NOMORE"))
    throw InputError(place, "TRACUT is not read: let the CAM system write the points as they are milled");
  if (word == "PREFUN") {
    const auto number = ParseNumber(first);
    if (!number || MeaningOfG(*number) != GcodeMeaning::kHarmless)
      throw InputError(place,
                       fmt::format("PREFUN/{}: G{} may change the path and is not read", first, first));
  }
  if (word == "INSERT" && !IsHarmlessInsert(TextOf(statement)))
    throw InputError(place,
                     "INSERT holds text for the machine that may change the path; read are M, S, T, D and H "
                     "words and comments");
}

}  // namespace millpose
