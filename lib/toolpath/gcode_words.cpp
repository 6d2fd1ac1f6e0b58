// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/gcode_words.hpp"

#include <algorithm>
#include <iterator>

namespace millpose {
namespace {

// Exact stop, path control, blending, length compensation, spindle modes, zero offsets, soft limits.
constexpr double kHarmless[] = {5.1,   8.0,   9.0,   40.0,  43.0,  44.0,  49.1,  50.0,  54.0,  54.1,  55.0,
                                56.0,  57.0,  58.0,  59.0,  59.1,  59.2,  59.3,  60.0,  61.0,  61.1,  62.0,
                                63.0,  64.0,  69.0,  80.0,  96.0,  97.0,  98.0,  99.0,  290.0, 450.0, 451.0,
                                500.0, 601.0, 602.0, 603.0, 640.0, 641.0, 642.0, 643.0, 644.0, 645.0};
// Splines, threads, cutter radius compensation, polar coordinates, scaling, mirrors, coordinate shifts,
// tilted planes, macros, canned cycles, tool vectors in I, J, K.
constexpr double kRefused[] = {2.1,  2.2,  3.1,  3.2,  5.0,   5.2,   6.0,   6.2,   7.1,  10.0, 12.0, 12.1,
                               13.0, 16.0, 33.0, 33.1, 34.0,  35.0,  38.2,  41.0,  41.1, 42.0, 42.1, 43.5,
                               47.0, 48.0, 51.0, 51.1, 52.0,  65.0,  66.0,  66.1,  67.0, 68.0, 68.2, 68.3,
                               68.4, 73.0, 74.0, 75.0, 76.0,  81.0,  82.0,  83.0,  84.0, 85.0, 86.0, 87.0,
                               88.0, 89.0, 92.0, 92.1, 110.0, 111.0, 112.0, 331.0, 332.0};

constexpr std::string_view kHarmlessNames[] = {
    "BRISK",       "BRISKA",    "CDOF",         "CDON",    "COMPCAD",   "COMPCURV",  "COMPOF",   "COMPON",
    "COMPSURF",    "CP",        "CPRECOF",      "CPRECON", "CUT2D",     "CUT2DF",    "CUT3DC",   "CYCLE832",
    "DIAM90",      "DIAMOF",    "DIAMON",       "DRIVE",   "DYNFINISH", "DYNNORM",   "DYNPOS",   "DYNROUGH",
    "DYNSEMIFIN",  "EXTERN",    "FFWOF",        "FFWON",   "FGROUP",    "FLIN",      "FNORM",    "FCUB",
    "GROUP_BEGIN", "GROUP_END", "GROUP_ADDEND", "KONT",    "MSG",       "NORM",      "ORIAXES",  "ORICONCCW",
    "ORIEULER",    "ORIPLANE",  "ORIRPY",       "ORISOF",  "ORISON",    "ORIVECT",   "ORIWKS",   "RTLIOF",
    "RTLION",      "SETAL",     "SOFT",         "SOFTA",   "SPATH",     "STARTFIFO", "STOPFIFO", "STOPRE",
    "UPATH",       "WAITM",     "WALIMOF",      "WALIMON", "WORKPIECE", "SPCOF"};

constexpr std::string_view kRefusedNames[] = {
    "ASPLINE", "BSPLINE", "CSPLINE", "POLY",  "CIP",    "CT",      "PTP",      "PTPG0",
    "ORIMKS",  "MIRROR",  "AMIRROR", "SCALE", "ASCALE", "OFFN",    "TRANSMIT", "TRACYL",
    "TRAANG",  "MCALL",   "EXTCALL", "CALL",  "REPEAT", "REPEATB", "TOROT",    "PAROT"};

}  // namespace

GcodeMeaning MeaningOfG(double number) {
  if (std::ranges::find(kHarmless, number) != std::end(kHarmless) || (number >= 505 && number <= 599))
    return GcodeMeaning::kHarmless;
  return std::ranges::find(kRefused, number) != std::end(kRefused) ? GcodeMeaning::kRefused
                                                                   : GcodeMeaning::kUnknown;
}

GcodeMeaning MeaningOfName(std::string_view name) {
  if (std::ranges::find(kHarmlessNames, name) != std::end(kHarmlessNames)) return GcodeMeaning::kHarmless;
  return std::ranges::find(kRefusedNames, name) != std::end(kRefusedNames) ? GcodeMeaning::kRefused
                                                                           : GcodeMeaning::kUnknown;
}

}  // namespace millpose
