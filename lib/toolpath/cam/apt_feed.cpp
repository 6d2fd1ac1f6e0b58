// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_feed.hpp"

#include <optional>

#include "base/text.hpp"
#include "base/units.hpp"

namespace millpose {

bool AptFeed::Take(const AptStatement& statement, double unit) {
  constexpr double kInch = 25.4;
  std::optional<double> value;
  double factor = unit / 60;
  bool per_revolution = false;
  const AptWord* inverse = nullptr;
  for (const AptWord& word : statement.minors) {
    const std::string& text = word.text;
    if (const auto number = ParseNumber(text); number && !value) {
      value = number;
    } else if (text == "MMPM" || text == "IPM" || text == "PERMIN") {
      factor = (text == "IPM" ? kInch : text == "MMPM" ? 1.0 : unit) / 60;
    } else if (text == "MMPR" || text == "IPR" || text == "PERREV") {
      factor = text == "IPR" ? kInch : text == "MMPR" ? 1.0 : unit;
      per_revolution = true;
    } else if (text == "RAPID") {
      return false;
    } else if (text == "INVERS") {
      inverse = &word;
    } else if (text != "AUTO" && text != "ON" && text != "OFF") {
      throw InputError(word.place, fmt::format("FEDRAT/\"{}\" is not known", text.substr(0, 40)));
    }
  }
  if (inverse != nullptr) {
    // With a number it is a time of each motion; alone (or AUTO, ON, OFF) it only asks a postprocessor for
    // G93.
    if (value)
      throw InputError(inverse->place,
                       "FEDRAT/INVERS with a value is not read: let the CAM system write feeds per minute or "
                       "per revolution (MMPM, IPM, MMPR, IPR)");
    return true;
  }
  if (!value || !(*value > 0)) throw InputError(statement.major.place, "FEDRAT needs a feed above 0");
  feed_ = *value * factor;
  per_revolution_ = per_revolution;
  return true;
}

void AptFeed::TakeSpindle(const AptStatement& statement, double diameter) {
  constexpr double kFoot = 304.8, kMetre = 1000;
  std::optional<double> value;
  double edge = 0;
  for (const AptWord& word : statement.minors) {
    if (const auto number = ParseNumber(word.text); number && !value) value = number;
    if (word.text == "SFM") edge = kFoot;
    if (word.text == "SMM") edge = kMetre;
  }
  if (!value || !(*value > 0)) return;
  revolutions_ = *value / 60;
  if (edge > 0) revolutions_ *= diameter > 0 ? edge / (kPi * diameter) : 0;
}

}  // namespace millpose
