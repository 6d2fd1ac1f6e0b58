// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_words.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace millpose {
namespace {

// Exact stop, path control, blending, length compensation, spindle modes, zero offsets, soft limits.
constexpr double kHarmlessG[] = {5.1,   8.0,   9.0,   40.0,  43.0,  43.1,  44.0,  49.1,  50.0,  54.0,  54.1,
                                 55.0,  56.0,  57.0,  58.0,  59.0,  59.1,  59.2,  59.3,  60.0,  61.0,  61.1,
                                 62.0,  63.0,  64.0,  64.1,  69.0,  97.0,  103.0, 154.0, 187.0, 290.0, 450.0,
                                 451.0, 500.0, 601.0, 602.0, 603.0, 640.0, 641.0, 642.0, 643.0, 644.0, 645.0};
// Splines, threads, cutter radius compensation, polar coordinates, scaling, mirrors, coordinate shifts,
// tilted planes, macros, fixed points.
constexpr double kRefused[] = {2.1,  2.2,  3.1,  3.2,  5.2,  6.0,   6.2,   7.1,   10.0,  12.0, 12.1, 13.0,
                               16.0, 33.0, 33.1, 34.0, 35.0, 38.2,  41.0,  41.1,  42.0,  42.1, 47.0, 48.0,
                               51.0, 51.1, 52.0, 65.0, 66.0, 66.1,  67.0,  68.0,  68.2,  68.3, 68.4, 75.0,
                               92.0, 92.1, 92.2, 92.3, 96.0, 110.0, 111.0, 112.0, 331.0, 332.0};

constexpr std::string_view kHarmlessNames[] = {
    "BRISK",        "BRISKA",  "CDOF",      "CDON",      "COMPCAD",  "COMPCURV", "COMPOF",      "COMPON",
    "COMPSURF",     "CP",      "CPRECOF",   "CPRECON",   "CUT2D",    "CUT2DF",   "CUT3DC",      "CYCLE832",
    "DIAMOF",       "DRIVE",   "DYNFINISH", "DYNNORM",   "DYNPOS",   "DYNROUGH", "DYNSEMIFIN",  "EXTERN",
    "FFWOF",        "FFWON",   "FGROUP",    "FLIN",      "FNORM",    "FCUB",     "GROUP_BEGIN", "GROUP_END",
    "GROUP_ADDEND", "KONT",    "MSG",       "NORM",      "ORIAXES",  "SAVE",     "ORIEULER",    "ORIPLANE",
    "ORIRPY",       "ORISOF",  "ORISON",    "ORIVECT",   "ORIWKS",   "RTLIOF",   "RTLION",      "SETAL",
    "SOFT",         "SOFTA",   "SPATH",     "STARTFIFO", "STOPFIFO", "STOPRE",   "UPATH",       "WAITM",
    "WALIMOF",      "WALIMON", "WORKPIECE", "SPCOF",     "DISPLOF",  "SBLOF"};

constexpr std::string_view kRefusedNames[] = {
    "ASPLINE", "BSPLINE", "CSPLINE", "POLY",  "CIP",    "CT",      "PTP",      "PTPG0",
    "ORIMKS",  "MIRROR",  "AMIRROR", "SCALE", "ASCALE", "OFFN",    "TRANSMIT", "TRACYL",
    "TRAANG",  "LEAD",    "EXTCALL", "CALL",  "REPEAT", "REPEATB", "TOROT",    "PAROT"};

}  // namespace

GcodeMeaning MeaningOfG(double number) {
  if (std::ranges::find(kHarmlessG, number) != std::end(kHarmlessG) || (number >= 505 && number <= 599))
    return GcodeMeaning::kHarmless;
  return std::ranges::find(kRefused, number) != std::end(kRefused) ? GcodeMeaning::kRefused
                                                                   : GcodeMeaning::kUnknown;
}

bool IsKnownM(double number) {
  static const std::set<double> known{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 13, 14, 17,
                                      19, 29, 30, 40, 41, 42, 43, 44, 45, 48, 49, 50, 51, 52, 53,
                                      60, 61, 62, 63, 64, 65, 66, 67, 68, 70, 88, 89, 99};
  return known.contains(number);
}

GcodeMeaning MeaningOfName(std::string_view name) {
  if (std::ranges::find(kHarmlessNames, name) != std::end(kHarmlessNames)) return GcodeMeaning::kHarmless;
  return std::ranges::find(kRefusedNames, name) != std::end(kRefusedNames) ? GcodeMeaning::kRefused
                                                                           : GcodeMeaning::kUnknown;
}

GcodeMeaning MeaningOfAddress(std::string_view address) {
  static const std::set<std::string_view> harmless{"D",    "H",    "SPOS",    "CTOL", "OTOL", "ATOL",  "FRC",
                                                   "FRCM", "ADIS", "ADISPOS", "OVR",  "FB",   "FGREF", "ACC"};
  static const std::set<std::string_view> refused{
      "U",    "V",   "W",   "A2",   "B2", "C2",  "A4", "B4", "C4", "A5",   "B5",   "C5", "AP", "RP", "RND",
      "RNDM", "CHF", "CHR", "STAT", "TU", "ANG", "A6", "B6", "C6", "LEAD", "TILT", ",R", ",C", ",A"};
  const std::string_view name = address.substr(0, address.find('['));
  if (harmless.contains(name)) return GcodeMeaning::kHarmless;
  return refused.contains(name) ? GcodeMeaning::kRefused : GcodeMeaning::kUnknown;
}

std::string_view ParametersOfG(double number) {
  static const std::map<double, std::string_view> letters{{5, "P"},   {5.1, "PQR"}, {8, "P"},      {30, "P"},
                                                          {43, "P"},  {54.1, "P"},  {61.1, "PRK"}, {64, "PQ"},
                                                          {103, "P"}, {154, "P"},   {187, "PE"}};
  const auto found = letters.find(number);
  return found == letters.end() ? std::string_view() : found->second;
}

std::string_view ParametersOfM(double number) {
  if (number == 19) return "PRQ";
  if (number >= 61 && number <= 68) return "PQEL";
  return number >= 100 && number <= 199 ? "PQ" : "";  // LinuxCNC: the user's own
}

HeidenhainMeaning MeaningOfHeidenhainG(double number) {
  static const std::set<double> iso{0, 1, 2, 3, 17, 18, 19, 40, 70, 71, 90, 91};
  static const std::set<double> skips{30, 31, 38, 51, 98, 99, 247}, resets{28, 73, 80};
  if (iso.contains(number)) return HeidenhainMeaning::kAsIso;
  if (skips.contains(number)) return HeidenhainMeaning::kSkipsBlock;
  if (resets.contains(number)) return HeidenhainMeaning::kReset;
  return number == 54 ? HeidenhainMeaning::kShift : HeidenhainMeaning::kRefused;
}

}  // namespace millpose
