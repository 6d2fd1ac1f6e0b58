// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/zero_offset.hpp"

namespace millpose {
namespace {

// "G58 X10": a shift of the frame on SINUMERIK, elsewhere an offset and a motion to X10.
void RefuseShift(const std::string& name, const SourceLocation& place, const SenderRules& rules) {
  if (rules.g58_shifts)
    throw InputError(
        place, name + " with coordinates shifts the frame and is not read: let the CAM system write TRANS");
  if (rules.sender == CamSender::kPlain)
    throw InputError(place, fmt::format("{} with coordinates is a zero offset and a motion, or (SINUMERIK) a "
                                        "shift of the frame: state toolpath.cam.sender: {}",
                                        name, SenderKeys(true)));
}

}  // namespace

bool IsZeroOffset(double g) { return (g >= 54 && g < 60) || g == 154 || g == 500 || (g >= 505 && g <= 599); }

std::string ZeroOffsetOf(const GcodeWord& word, const GcodeMove& move, bool moves, const SenderRules& rules,
                         const GcodeMotion::ValueOf& value_of) {
  const double g = value_of(word);
  std::string name = fmt::format("G{}", g);
  if (g == 54.1 || g == 154) {
    const GcodeWord* number = move.Parameter('P');
    if (!number) throw InputError(word.place, name + " needs the number of its offset (P)");
    name += fmt::format(" P{}", value_of(*number));
  }
  if ((g == 58 || g == 59) && move.HasLinear() && !moves) RefuseShift(name, word.place, rules);
  return name;
}

}  // namespace millpose
