// SPDX-License-Identifier: GPL-3.0-or-later
// What the words of G-code mean for the path of the tip. docs/cam-import.md.
#pragma once

#include <string_view>

namespace millpose {

enum class GcodeMeaning : uint8_t {
  kUnknown,
  kHarmless,  ///< says nothing about the path
  kRefused,   ///< changes the path in a way that is not read
};

/// Of a G number that GcodeReader does not treat itself.
GcodeMeaning MeaningOfG(double number);
/// Whether an M code is one that machines agree on, and no motion: spindle, coolant, stops, tool change, …
bool IsKnownM(double number);
/// Of a name, alone or with parentheses. Unknown names may be subprograms.
GcodeMeaning MeaningOfName(std::string_view name);
/// Of an address besides those of motion, feed, speed and tool: "H", "FGREF[C]".
GcodeMeaning MeaningOfAddress(std::string_view address);

/// The letters of the numbers that a G or M code takes besides coordinates: "PQ" of G64.
std::string_view ParametersOfG(double number);
std::string_view ParametersOfM(double number);

/// Heidenhain's DIN/ISO gives some G numbers a meaning of its own.
enum class HeidenhainMeaning : uint8_t {
  kAsIso,
  kSkipsBlock,  ///< blank form, tool definition, label, preset: the block's coordinates are no motion
  kShift,       ///< G54: datum shift
  kReset,       ///< G28, G73, G80: switches a transformation off when no value but 0 stands with it
  kRefused,
};
HeidenhainMeaning MeaningOfHeidenhainG(double number);

}  // namespace millpose
