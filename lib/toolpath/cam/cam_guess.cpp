// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/cam_guess.hpp"

#include <algorithm>
#include <vector>

namespace millpose {
namespace {

constexpr size_t kLooked = 20'000;  // bytes

std::string UpperStart(std::string_view bytes) {
  std::string text(bytes.substr(0, kLooked));
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

// Whether a line begins with the word, blanks and a line number aside.
bool HasLine(const std::string& text, std::string_view word) {
  for (size_t at = 0; at < text.size();) {
    size_t begin = text.find_first_not_of(" \t0123456789", at);
    if (begin != std::string::npos && std::string_view(text).substr(begin).starts_with(word)) return true;
    begin = text.find_first_of("\r\n", at);
    if (begin == std::string::npos) return false;
    at = begin + 1;
  }
  return false;
}

struct Sign {
  std::vector<std::string_view> all;  ///< lines begin with each of these
  std::string_view what;
};

const std::vector<Sign>& Signs() {
  static const std::vector<Sign> signs{{{"&ACCESS"}, "a KRL program (KUKA)"},
                                       {{"DEF ", "LIN "}, "a KRL program (KUKA)"},
                                       {{"DEF ", "SLIN "}, "a KRL program (KUKA)"},
                                       {{"DEF ", "PTP {"}, "a KRL program (KUKA)"},
                                       {{"DEF ", "PTP HOME"}, "a KRL program (KUKA)"},
                                       {{"DEFDAT "}, "a KRL data list (KUKA)"},
                                       {{"MODULE ", "PROC "}, "a RAPID program (ABB)"},
                                       {{"BEGIN PGM "}, "a Heidenhain program in conversational form"},
                                       {{"/PROG"}, "a TP program (Fanuc robot)"},
                                       {{"/JOB"}, "an INFORM program (Yaskawa)"},
                                       {{"ISO-10303-21"}, "a STEP model"},
                                       {{"SOLID ", "FACET "}, "an STL mesh"},
                                       {{"PLY", "FORMAT "}, "a PLY mesh"},
                                       {{"V ", "F "}, "an OBJ mesh"},
                                       {{"SECTION", "HEADER"}, "a DXF drawing"},
                                       {{"<?XML"}, "an XML file"},
                                       {{"<HTML"}, "an HTML page"},
                                       {{"<!DOCTYPE"}, "an HTML page"},
                                       {{"{"}, "a JSON file"},
                                       {{"PK\x03\x04"}, "a ZIP archive"},
                                       {{"%PDF"}, "a PDF file"}};
  return signs;
}

}  // namespace

std::optional<std::string> GuessFormat(std::string_view bytes) {
  const std::string text = UpperStart(bytes);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return "an empty file";
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    return "a text in UTF-16: save it as ASCII or UTF-8";
  if (HasLine(text, "GOTO")) return std::nullopt;
  for (const Sign& sign : Signs())
    if (std::ranges::all_of(sign.all, [&](std::string_view word) { return HasLine(text, word); }))
      return std::string(sign.what);
  if (text.find('\0') != std::string::npos) return "a binary file";
  if (HasLine(text, "GOLFT") || HasLine(text, "GORGT") || HasLine(text, "GOFWD"))
    return "an APT part program, which an APT processor has to turn into CLDATA first";
  return std::nullopt;
}

}  // namespace millpose
