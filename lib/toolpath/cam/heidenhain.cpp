// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/heidenhain.hpp"

#include <algorithm>

#include "toolpath/cam/gcode_words.hpp"

namespace millpose {

bool Heidenhain::TakeBlock(const GcodeBlock& block, const GcodeMove& empty) {
  for (const GcodeWord& word : block.words) {
    if (word.address != "G") continue;
    const HeidenhainMeaning meaning = MeaningOfHeidenhainG(value_of_(word));
    if (value_of_(word) == 247) TakePreset(block);
    if (meaning == HeidenhainMeaning::kSkipsBlock) return true;
    if (meaning == HeidenhainMeaning::kReset) {
      const bool sets = std::ranges::any_of(
          block.words, [&](const GcodeWord& other) { return other.address != "G" && value_of_(other) != 0; });
      const bool mirrors = value_of_(word) == 28 && block.words.size() > 1;
      if (sets || mirrors)
        throw InputError(word.place, fmt::format("G{} is read only where it switches off", value_of_(word)));
      return true;
    }
    if (meaning != HeidenhainMeaning::kShift) continue;
    GcodeMove shift = empty;
    for (const GcodeWord& other : block.words)
      if (const size_t i = std::string_view("XYZ").find(other.address); i != std::string_view::npos)
        shift.linear[i] = &other;
      else if (other.address != "G")
        throw InputError(other.place, "a datum shift takes X, Y and Z alone");
    motion_.ShiftDatum(shift);
    return true;
  }
  return false;
}

// G247 chooses the preset that coordinates are counted from: where another one lies only the control knows.
void Heidenhain::TakePreset(const GcodeBlock& block) {
  std::string preset;
  for (const GcodeWord& word : block.words)
    if (word.address != "G") preset += fmt::format(" {}={}", word.address, value_of_(word));
  if (preset_ && *preset_ != preset)
    throw InputError(
        block.words[0].place,
        fmt::format("G247 chooses preset{} behind{}: where the two lie to each other is known to the "
                    "control alone; let the CAM system write one file for each",
                    preset, *preset_));
  preset_ = preset;
}

bool Heidenhain::TakeG(const GcodeWord& word) const {
  const double g = value_of_(word);
  if (MeaningOfHeidenhainG(g) == HeidenhainMeaning::kRefused)
    throw InputError(word.place,
                     fmt::format("G{} of Heidenhain's DIN/ISO is not read: let the CAM system write "
                                 "G00, G01, G02 and G03",
                                 g));
  return g == 40;
}

bool Heidenhain::TakeM(double m, const SourceLocation& place, GcodeMove& move) {
  if (m == 89 || m == 99) throw InputError(place, fmt::format("M{} calls a cycle, which is not read", m));
  if (m == 91 || m == 92) {
    move.machine = true;
  } else if (m == 140) {
    move.reference = true;
  } else if (m == 128 || m == 129) {
    motion_.SetTipProgramming(m == 128);
  } else if (m == 136 || m == 137) {
    modes_.feed_mode = m == 136 ? 95 : 94;
  } else {
    // Shorter way of rotary axes, display, look ahead, feed of rotary axes.
    return m == 94 || m == 107 || m == 108 || m == 116 || m == 117 || m == 120 || m == 126 || m == 127;
  }
  return true;
}

void Heidenhain::TakePole(GcodeMove& move) {
  if (move.HasCentre()) {
    if (!pole_) pole_ = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const GcodeWord*& word = move.centre[static_cast<size_t>(i)];
      if (!word) continue;
      const bool step = modes_.incremental && word->kind != GcodeWord::Kind::kAbsolute;
      (*pole_)[i] = value_of_(*word) * modes_.Unit() + (step ? motion_.at()[i] : 0);
      word = nullptr;
    }
  }
  if (modes_.motion > 1 && !move.radius && move.HasLinear()) {
    if (!pole_) throw InputError(move.place, "an arc needs its pole (I, J, K) or its radius (R)");
    move.pole = pole_;
  }
}

}  // namespace millpose
