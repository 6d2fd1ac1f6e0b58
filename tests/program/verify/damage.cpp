// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/verify/damage.hpp"

#include <fmt/format.h>

#include <map>
#include <regex>
#include <sstream>

namespace millpose {
namespace {

using Lines = std::vector<std::string>;
using Edit = std::function<std::optional<std::string>(const std::string&)>;

const std::string kCut = "^ *(N[0-9]+ )?(S?LIN |G9 G1 |G1 )";
const std::string kEntry = "(PTP \\{X|STAT=)";
const std::string kOutput = "(TRIGGER .*OUT\\[5\\]|A_OUT\\[5\\]|M6[23] P5)";
const std::string kNumber = "(-?[0-9]+(?:\\.[0-9]*)?)";

Lines Split(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string Join(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

/// Index of the `nth` (from 0; negative from the end) line that matches.
std::optional<size_t> Find(const Lines& lines, const std::string& pattern, int nth = 0) {
  const std::regex regex(pattern);
  std::vector<size_t> found;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (std::regex_search(lines[i], regex)) found.push_back(i);
  }
  const int index = nth < 0 ? static_cast<int>(found.size()) + nth : nth;
  if (index < 0 || index >= static_cast<int>(found.size())) return std::nullopt;
  return found[static_cast<size_t>(index)];
}

/// Edits the lines from the nth match on.
Edit AtLine(const std::string& pattern, int nth, const std::function<bool(Lines&, size_t)>& edit) {
  return [=](const std::string& text) -> std::optional<std::string> {
    Lines lines = Split(text);
    const auto line = Find(lines, pattern, nth);
    if (!line || !edit(lines, *line)) return std::nullopt;
    return Join(lines);
  };
}

/// The nth line that matches put `by` lines further on.
Edit Move(const std::string& pattern, int nth, int by) {
  return AtLine(pattern, nth, [=](Lines& lines, size_t i) {
    const auto line = lines.begin() + static_cast<long>(i);
    std::rotate(line, line + 1, line + 1 + by);
    return true;
  });
}

Edit Drop(const std::string& pattern, int nth) {
  return AtLine(pattern, nth, [](Lines& lines, size_t i) {
    lines.erase(lines.begin() + static_cast<long>(i));
    return true;
  });
}

/// Replaces the first match of `from` in the nth line with `pattern`.
Edit ReplaceIn(const std::string& pattern, int nth, const std::string& from, const std::string& to) {
  return AtLine(pattern, nth, [=](Lines& lines, size_t i) {
    const std::string before = lines[i];
    lines[i] = std::regex_replace(before, std::regex(from), to, std::regex_constants::format_first_only);
    return lines[i] != before;
  });
}

Edit ReplaceAll(const std::string& from, const std::string& to) {
  return [=](const std::string& text) -> std::optional<std::string> {
    const std::string after = std::regex_replace(text, std::regex(from), to);
    return after == text ? std::nullopt : std::optional(after);
  };
}

/// Changes the number after `word` in the nth line with `pattern`.
Edit Number(const std::string& pattern, int nth, const std::string& word,
            const std::function<double(double)>& change) {
  return AtLine(pattern, nth, [=](Lines& lines, size_t i) {
    std::smatch match;
    if (!std::regex_search(lines[i], match, std::regex("(" + word + ")" + kNumber))) return false;
    const double value = std::stod(match[match.size() - 1]);
    const double changed = change(value);
    if (changed == value) return false;
    lines[i] = match.prefix().str() + match[1].str() + fmt::format("{:.6f}", changed) + match.suffix().str();
    return true;
  });
}

std::function<double(double)> Plus(double by) {
  return [=](double value) { return value + by; };
}
std::function<double(double)> Times(double by) {
  return [=](double value) { return value * by; };
}
double Negative(double value) { return -value; }

/// Flips bit `bit` (from the right) of 'B…' after `word` in the first entry.
Edit FlipBit(int nth, const std::string& word, int bit) {
  return AtLine(kEntry, nth, [=](Lines& lines, size_t i) {
    std::smatch match;
    if (!std::regex_search(lines[i], match, std::regex(word + "'B([01]+)'"))) return false;
    const size_t place = static_cast<size_t>(match.position(1) + match.length(1) - 1 - bit);
    lines[i][place] = lines[i][place] == '0' ? '1' : '0';
    return true;
  });
}

Edit ReverseBits(const std::string& word) {
  return AtLine(kEntry, 0, [=](Lines& lines, size_t i) {
    std::smatch match;
    if (!std::regex_search(lines[i], match, std::regex(word + "'B([01]+)'"))) return false;
    const std::string before = lines[i];
    std::reverse(lines[i].begin() + match.position(1),
                 lines[i].begin() + match.position(1) + match.length(1));
    return lines[i] != before;
  });
}

Edit Swap(const std::string& pattern, int first, int second) {
  return [=](const std::string& text) -> std::optional<std::string> {
    Lines lines = Split(text);
    const auto a = Find(lines, pattern, first), b = Find(lines, pattern, second);
    if (!a || !b) return std::nullopt;
    std::swap(lines[*a], lines[*b]);
    return Join(lines);
  };
}

/// The lines of pass 0 and pass 1 (entry to retract) exchanged, or pass 1 left out.
Edit Passes(bool exchange) {
  return [=](const std::string& text) -> std::optional<std::string> {
    Lines lines = Split(text);
    const auto a0 = Find(lines, "PASS 0 PIECE"), b0 = Find(lines, "PASS 1 PIECE"),
               b1 = Find(lines, "PASS 2 PIECE");
    if (!a0 || !b0 || !b1) return std::nullopt;
    const auto at = [&](size_t i) { return lines.begin() + static_cast<long>(i); };
    if (exchange) {
      std::rotate(at(*a0), at(*b0), at(*b1));
    } else {
      lines.erase(at(*b0), at(*b1));
    }
    return Join(lines);
  };
}

Edit ReverseCuts() {
  return AtLine(kCut, 1, [](Lines& lines, size_t i) {
    std::reverse(lines.begin() + static_cast<long>(i), lines.begin() + static_cast<long>(i) + 4);
    return true;
  });
}

}  // namespace

std::string WithWholeLines(const std::string& text) {
  static const std::regex motion(R"(^(LIN|PTP) \{([^}]*)\}(.*)$)"), word(R"(\b([XYZABC]) (-?[0-9.]+),?)");
  Lines lines = Split(text);
  std::map<char, double> words;
  for (std::string& line : lines) {
    std::smatch match;
    if (!std::regex_match(line, match, motion)) continue;
    const std::string fields = match[2], rest = std::regex_replace(fields, word, "");
    if (fields.starts_with("A1")) {
      words.clear();
      continue;
    }
    for (std::sregex_iterator it(fields.begin(), fields.end(), word), end; it != end; ++it)
      words[(*it)[1].str()[0]] = std::stod((*it)[2]);
    if (match[1] != "LIN") continue;
    std::vector<std::string> whole;
    for (const char name : std::string("XYZABC"))
      whole.push_back(fmt::format("{} {:.{}f}", name, words.at(name), name < 'X' ? 6 : 4));
    line =
        fmt::format("LIN {{{}{}{}}}{}", fmt::join(whole, ","), rest.empty() ? "" : ",", rest, match[3].str());
  }
  return Join(lines);
}

std::vector<TextEdit> Damages() {
  std::vector<TextEdit> edits = {
      {"wait for an input", "K", ReplaceAll("\n(PTP \\{X)", "\nWAIT FOR $$IN[3]\n$1")},
      {"pass marks removed", "KSL", ReplaceAll("\n(;|MSG)[^\n]*PASS[^\n]*", "")},
      {"wait", "K", ReplaceAll("\n(PTP \\{X)", "\nWAIT SEC 0.5\n$1")},
      {"wait", "S", ReplaceAll("\n(G0 )", "\nG4 F0.5\n$1")},
      {"wait", "L", ReplaceAll("\n(G0 )", "\nG4 P0.5\n$1")},
      {"sign of A on a cut", "KSL", Number(kCut, 2, "\\bA(2=)?[ =]?", Negative)},
      {"sign of B on a cut", "KSL", Number(kCut, 2, "\\bB(2=)?[ =]?", Negative)},
      {"sign of C on a cut", "KSL", Number(kCut, 2, "\\bC(2=)?[ =]?", Negative)},
      {"sign of X on a cut", "KSL", Number(kCut, 2, "\\bX ?", Negative)},
      {"sign of Y on a cut", "KSL", Number(kCut, 2, "\\bY ?", Negative)},
      {"cut line dropped", "KSL", Drop(kCut, 2)},
      {"curved cut line dropped", "KSL", Drop(kCut, -6)},
      {"cut line doubled", "KSL",
       AtLine(kCut, 3,
              [](Lines& lines, size_t i) {
                lines.insert(lines.begin() + static_cast<long>(i), lines[i]);
                return true;
              })},
      {"cut lines swapped", "KSL", Swap(kCut, 2, 3)},
      {"curved cut lines swapped", "KSL", Swap(kCut, -5, -6)},
      {"cut lines reversed", "KSL", ReverseCuts()},
      {"0.05 mm in X of a point", "KSC", Number(kCut, 2, "\\bX ?", Plus(0.05))},
      {"0.05 mm in Y of a point", "KSC", Number(kCut, 2, "\\bY ?", Plus(0.05))},
      {"0.05 mm in Z of a point", "KSC", Number(kCut, 2, "\\bZ ?", Plus(-0.05))},
      {"0.05 degrees in C of a point", "KSC", Number(kCut, 3, "\\bC(2=)?[ =]?", Plus(0.05))},
      {"0.05 degrees in B of a point", "KSC", Number(kCut, 3, "\\bB(2=)?[ =]?", Plus(0.05))},
      {"0.01 degrees in a joint of a point", "L", Number(kCut, 2, "\\bX", Plus(0.01))},
      {"0.05 degrees in the last joint of a point", "L", Number(kCut, 2, "\\bC", Plus(0.05))},
      {"A and C exchanged", "K", ReplaceAll(",A ([-0-9.]+),B ([-0-9.]+),C ([-0-9.]+)", ",A $3,B $2,C $1")},
      {"A and C exchanged", "S",
       ReplaceAll("(A2?=)([-0-9.]+) (B2?=[-0-9.]+) (C2?=)([-0-9.]+)", "$1$5 $3 $4$2")},
      {"decimals cut to 1", "KSL", ReplaceAll("(\\.[0-9])[0-9]+", "$1")},
      {"comma for a point", "KSL", ReplaceIn(kCut, 2, "([0-9])\\.([0-9])", "$1,$2")},
      {"number lost", "KSL", ReplaceIn(kCut, 2, "([XY]) ?-?[0-9.]+", "$1")},
      {"word lost", "L", ReplaceIn(kCut, 3, " Y[-0-9.]+", "")},
      {"approach lost", "KSL", Drop(kCut, 0)},
      {"retract lost", "KSL",
       AtLine("END.*PASS", 0,
              [](Lines& lines, size_t i) {
                lines.erase(lines.begin() + static_cast<long>(i) - 1);
                return true;
              })},
      // The last cut is the last motion: the planned stop behind it is missed where nothing follows.
      {"retract and way home lost", "KSL",
       AtLine("END.*PASS", -1,
              [](Lines& lines, size_t i) {
                const std::regex motion("^ *(N[0-9]+ )?(S?PTP |S?LIN |G9 |G0 |G1 |.*STAT=)");
                lines.erase(lines.begin() + static_cast<long>(i) - 1);
                for (size_t k = lines.size(); k-- > i;)
                  if (std::regex_search(lines[k], motion)) lines.erase(lines.begin() + static_cast<long>(k));
                return true;
              })},
      {"entry lost", "KS", Drop(kEntry, 1)},
      {"entry lost", "L", Drop("^G0 ", 3)},
      {"way-point dropped", "KSL", Drop("^(PTP \\{A1|G0 )", 1)},
      {"A1 of a way-point", "KSL", Number("^(PTP \\{A1|G0 )", 1, "(A1[ =]|X)", Plus(1))},
      {"sign of a way-point's angle", "KSL", Number("^(PTP \\{A1|G0 )", 1, "(A2[ =]|Y)", Negative)},
      {"way-points swapped", "KSL", Swap("^(PTP \\{A1|G0 )", 0, 1)},
      {"base moved", "K", Number("BASE", 0, "X ", Plus(1))},
      {"base turned", "K", Number("BASE", 0, "A ", Plus(0.1))},
      {"base lost", "K", Drop("BASE = ", 0)},
      {"base moved", "S", Number("P_UIFR", 0, "CTRANS\\(X,", Plus(1))},
      {"base turned", "S", Number("P_UIFR", 0, "CROT\\(X,", Plus(0.1))},
      {"base lost", "S", Drop("P_UIFR", 0)},
      {"base and tool exchanged", "K",
       [](const std::string& text) -> std::optional<std::string> {
         std::string after = std::regex_replace(text, std::regex("\\$BASE"), "$$NEW");
         after = std::regex_replace(after, std::regex("\\$TOOL"), "$$BASE");
         return std::regex_replace(after, std::regex("\\$NEW"), "$$TOOL");
       }},
      {"tool moved by 0.05 mm", "K", Number("TOOL = ", 0, "Z ", Plus(0.05))},
      {"tool turned", "K", Number("TOOL = ", 0, "C ", Plus(180))},
      {"tool lost", "K", Drop("TOOL = ", 0)},
      {"another tool", "S", ReplaceAll("SPINDLE_D20", "SPINDLE_D10")},
      {"feed in mm for m", "K", Number("VEL.CP", 0, "= ", Times(1000))},
      {"feed in m for mm", "S", Number("F80", 0, "F", Times(0.001))},
      {"feed doubled", "K", Number("VEL.CP", 0, "= ", Times(2))},
      {"feed doubled", "L", Number(" F[0-9]", 1, " F", Times(2))},
      {"feed doubled from the first", "S", Number(" F[0-9]", 0, " F", Times(2))},
      {"feed lost", "K", Drop("VEL.CP", 0)},
      {"feed lost", "SL", ReplaceIn(" F[0-9]", 0, " F[0-9.]+", "")},
      {"exact stop in a cut", "K", ReplaceIn("C_DIS$", 1, " C_DIS", "")},
      {"exact stop in a cut", "S", ReplaceIn("^G1 ", 1, "^G1", "G9 G1")},
      {"exact stops from here on", "L", Drop("^G64", 0)},
      {"rounding by 3 mm", "K", ReplaceAll("APO.CDIS = [0-9.]+", "APO.CDIS = 3")},
      {"rounding left at its default", "K", Drop("APO.CDIS", 0)},
      {"rounding tolerance lost", "S", Drop("CYCLE832", 0)},
      {"rounding tolerance switched off", "S", ReplaceAll("_FINISH", "_OFF")},
      {"rounding without a tolerance", "L", ReplaceAll("G64 P[0-9.]+ Q0", "G64")},
      {"rounding by 3 mm", "S", ReplaceAll("CYCLE832\\(0.0100", "CYCLE832(3")},
      {"rounding without bounds", "L", ReplaceAll("G64 P[0-9.]+", "G64 P1")},
      {"spindle not switched on", "KSL", Drop("(OUT\\[1\\]=TRUE|M3$)", 0)},
      {"spindle not switched off", "KSL", Drop("(OUT\\[1\\]=FALSE|M5$)", 0)},
      {"spindle slower", "KSL", ReplaceAll("7000", "700")},
      {"spindle off too early", "KSL",
       [](const std::string& text) -> std::optional<std::string> {
         Lines lines = Split(text);
         const auto off = Find(lines, "(OUT\\[1\\]=FALSE|M5$)"), cut = Find(lines, kCut, 3);
         if (!off || !cut) return std::nullopt;
         const std::string line = lines[*off];
         lines.erase(lines.begin() + static_cast<long>(*off));
         lines.insert(lines.begin() + static_cast<long>(*cut), line);
         return Join(lines);
       }},
      {"output not switched", "KSL", Drop(kOutput, 0)},
      {"output left on", "KSL", Drop(kOutput, 1)},
      {"output's state inverted", "K", ReplaceIn(kOutput, 0, "TRUE", "FALSE")},
      {"output's state inverted", "S", ReplaceIn(kOutput, 0, "=1$", "=0")},
      {"output's state inverted", "L", ReplaceIn(kOutput, 0, "M62", "M63")},
      {"another output", "KSL", ReplaceIn(kOutput, 0, "(OUT.|P)5", "$016")},
      {"output later", "KSL", Move(kOutput, 0, 2)},
      {"output delayed", "K", ReplaceIn(kOutput, 0, "DELAY=0", "DELAY=20")},
      {"end lost", "KSL", Drop("^(END|M30|M2)$", -1)},
      {"text cut off", "KSL",
       [](const std::string& text) { return std::optional(text.substr(0, text.size() * 2 / 3)); }},
      {"passes in another order", "KSL", Passes(true)},
      {"pass lost", "KSL", Passes(false)},
      {"straight for joint motion", "K", ReplaceIn("^PTP \\{X", 1, "^PTP", "LIN")},
      {"joint for straight motion", "K", ReplaceIn("^LIN .*C_DIS", 1, "^LIN(.*) C_DIS", "PTP$1")},
      {"joint for straight motion", "SL", ReplaceIn("^G1 ", 1, "^G1", "G0")},
      {"straight for joint motion", "S", ReplaceIn(kEntry, 1, "^G0(.*) PTP", "G1$1 CP")},
      {"straight for joint motion", "L", ReplaceIn("^G0 ", 3, "^G0", "G1")},
      {"PTP not ended by CP", "S", ReplaceAll(" CP\n", "\n")},
      {"transformation not switched on", "S", Drop("^TRAORI", 0)},
      {"transformation not switched off", "S", Drop("^TRAFOOF", -1)},
      {"per minute for inverse time", "L", ReplaceAll("G93", "G94")},
      {"incremental", "SL", ReplaceAll("G90", "G91")},
      {"inches", "SL", ReplaceAll("G(21|710)", "G20")},
      {"frame and orientation not selected", "S", Drop("^G505", 0)},
      {"frame not selected again", "S", ReplaceIn("^G505", 1, "G505 ", "")},
      {"another frame", "S", ReplaceIn("^G505", 0, "G505", "G54")},
      {"orientation in another frame", "S", ReplaceIn("^G505", 0, " ORIWKS", "")},
      {"orientation by axes", "S", ReplaceIn("^G505", 0, "ORIVECT", "ORIAXES")},
      {"frames act on joints", "S", ReplaceIn("^G0 SUPA", 1, "SUPA ", "")},
      {"tolerance of the orientation left to the machine", "S", ReplaceAll("_ORI_FINISH", "_FINISH")},
      {"no tool length", "S", ReplaceIn("^G1 ", 1, "^G1", "D0 G1")},
      {"dwell in a cut", "S", ReplaceIn("^G1 ", 1, "^", "G4 F1\n")},
      {"dwell in a cut", "L", ReplaceIn("^G1 ", 1, "^", "G4 P1\n")},
      {"stop in a cut", "SL", ReplaceIn("^G1 ", 1, "^", "M0\n")},
      {"points merged", "L", ReplaceAll(" Q0", " Q0.1")},
      {"code between comments", "L", ReplaceIn("^G1 ", 1, "^", "(a) G4 P1 (b)\n")},
      {"units, plane and distances not stated", "SL", Drop("^G(17|21)", 0)},
      {"offsets not cleared", "L", Drop("^G10 L2", 0)},
      {"another coordinate system", "L", ReplaceAll("G59.3", "G54")},
      {"defaults not stated", "K", Drop("BAS \\(#INITMOV", 0)},
      {"joint motions as fast as they can", "K", Drop("BAS \\(#VEL_PTP", 0)},
      {"joint motions faster", "K", ReplaceAll("#VEL_PTP,[0-9]+", "#VEL_PTP,90")},
      {"status removed", "K", ReplaceAll(",S 'B[01]+'", "")},
      {"turn removed", "K", ReplaceAll(",T 'B[01]+'", "")},
      {"status and turn removed", "K", ReplaceAll(",S 'B[01]+',T 'B[01]+'", "")},
      {"status and turn removed", "S", ReplaceAll(" STAT='B[01]+' TU='B[01]+'", "")},
      {"status inverted", "KS", ReplaceAll("(S |STAT=)'B010'", "$1'B101'")},
      {"turn reversed", "KS", ReverseBits("(?:T |TU=)")},
  };
  for (int bit = 0; bit < 6; ++bit) {
    if (bit < 3) edits.push_back({fmt::format("status bit {}", bit), "KS", FlipBit(0, "(?:S |STAT=)", bit)});
    edits.push_back({fmt::format("turn bit {}", bit), "KS", FlipBit(1, "(?:T |TU=)", bit)});
  }
  return edits;
}

std::vector<TextEdit> HarmlessEdits() {
  return {
      {"comment added", "KSL", ReplaceAll("\n((LIN|G1|G9) [^\n]*)\n", "\n; checked by hand\n$1\n")},
      {"comment behind a block", "KSL", ReplaceIn(kCut, 2, "$", " ; here")},
      {"comment in a block", "L", ReplaceIn(kCut, 2, "^G1", "G1 (checked by hand)")},
      {"comment after a block", "L", ReplaceIn(kCut, 2, "$", " (here)")},
      {"comments removed", "KSL", ReplaceAll("\n; (?!PASS|END OF)[^\n]*", "")},
      {"blank lines", "KSL", ReplaceAll("\n", "\n\n")},
      {"indented", "KSL", ReplaceAll("\n(LIN|G1|PTP|G0)", "\n\t  $1")},
      {"CRLF", "KSL", ReplaceAll("\n", "\r\n")},
      {"trailing spaces", "KSL", ReplaceAll("\n", "  \n")},
      {"a remark and blank lines at the end", "KSL",
       [](const std::string& text) { return std::optional(text + "\n; checked\n\n"); }},
      {"spaces within comments", "KSL", ReplaceAll("\n; ([a-z]+):", "\n;  $1:")},
      {"block numbers", "SL",
       [](const std::string& text) {
         Lines lines = Split(text);
         int number = 10;
         for (std::string& line : lines) {
           if (!line.empty() && (line[0] == 'G' || line[0] == 'T'))
             line = fmt::format("N{} {}", number += 10, line);
         }
         return std::optional(Join(lines));
       }},
      {"5th decimal", "KS", Number(kCut, 2, "\\bX ?", Plus(0.00004))},
      {"6th decimal", "L", Number(kCut, 2, "\\bX", Plus(0.000004))},
      {"lower feed", "K", Number("VEL.CP", 0, "= ", Times(0.8))},
      {"lower feed", "S", Number("F80", 0, "F", Times(0.8))},
      {"lower feed", "L", Number(" F[0-9]", 2, " F", Times(0.8))},
      {"lower case", "K", ReplaceAll("\nLIN", "\nlin")},
      {"lower case", "SL", ReplaceAll("\nG1", "\ng1")},
      {"numbers without trailing zeros", "KSL",
       ReplaceAll("((?:LIN \\{|G1 )X ?-?[0-9]+\\.[0-9]+?)0+\\b", "$1")},
  };
}

}  // namespace millpose
