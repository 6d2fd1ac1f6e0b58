// SPDX-License-Identifier: GPL-3.0-or-later
// What the error of the face chose for the pieces of a plan (docs/face-error.md).
#pragma once

#include <array>
#include <cstdint>

#include "base/enum_words.hpp"

namespace millpose {

/// What a piece leaves, over the places that count.
struct FaceChoiceFigures {
  double worst = 0;   ///< largest displacement, mm
  double sum = 0;     ///< of the places' largest displacements, mm
  double marks = 0;   ///< heights h·|n·J| of the steps where gears go over to their other flank, summed, mm
  double middle = 0;  ///< mean of the displacement in the middle of its bounds, signed, mm
  double step = 0;    ///< largest difference of `middle` from that of a piece cut beside it, mm
  int count = 0;      ///< places that count
  std::array<int, 6> crossings{};  ///< by gear of the arm
};

/// How a piece is milled.
enum class FaceWay : uint8_t {
  kPlanned,   ///< as its points' objective alone has it
  kFixed,     ///< at one rotation about the tool axis
  kSearched,  ///< as the search with the gears' flanks as state has it
};
inline constexpr EnumWords<FaceWay, 3> kFaceWayWords = {
    {{"planned", FaceWay::kPlanned}, {"fixed", FaceWay::kFixed}, {"searched", FaceWay::kSearched}}};

/// What was chosen for a piece, beside what it was before.
struct FaceChoice {
  int pass = 0, piece = 0;
  FaceWay way = FaceWay::kPlanned;
  FaceChoiceFigures before, after;
};

}  // namespace millpose
