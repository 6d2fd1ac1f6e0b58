// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose calibrate --map`: one measured part corrects the next (docs/error-map.md).
#pragma once

#include "planning/compensation/error_field.hpp"
#include "run/pipeline/commands/calibrate_part.hpp"

namespace millpose {

struct MappedPart {
  FittedErrors fitted;             ///< of all readings, both parts' where there are two
  std::optional<Repeats> repeats;  ///< of the first part's field on the second part
  double share = 1;                ///< of the field that the map takes out
  double largest = 0;              ///< mm, that the map takes out anywhere, a former map's included
  double largest_sd = 0;           ///< mm, of the field at any cut point
  double farthest = 0;             ///< mm, of a reading from the nearest cut point
  bool corrected_before = false;   ///< the measured part was milled by a map already
  std::string csv;                 ///< the map
  std::string verdict;             ///< one or two sentences

  /// Whether there is something to correct.
  bool usable = false;
};

/// The map of a plan's measured part; `second`: readings of another part that was milled by the same
/// programs. Throws InputError as CalibratePart() does, for a plan without cut points and for readings of
/// another face.
MappedPart MapPart(const CalibrateArguments& arguments, const std::optional<std::filesystem::path>& second);

}  // namespace millpose
