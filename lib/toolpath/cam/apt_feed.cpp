// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_feed.hpp"

#include <optional>
#include <set>

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

AptSpindle AptFeed::TakeSpindle(const AptStatement& statement, double diameter) {
  constexpr double kFoot = 304.8, kMetre = 1000;
  static const std::set<std::string_view> harmless{"RPM",  "ON",   "OFF",    "LOW",  "MEDIUM", "HIGH",
                                                   "AUTO", "SYNC", "ORIENT", "LOCK", "NEUTRL", "NOMORE"};
  std::optional<double> value;
  AptSpindle spindle;
  double edge = 0;
  for (size_t i = 0; i < statement.minors.size(); ++i) {
    const AptWord& word = statement.minors[i];
    if (const auto number = ParseNumber(word.text)) {
      if (value || !(*number >= 0)) throw InputError(word.place, "SPINDL takes one speed, of 0 or more");
      value = number;
    } else if (word.text == "CLW" || word.text == "CCLW") {
      spindle.sense = word.text == "CLW" ? SpindleSense::kClockwise : SpindleSense::kCounterClockwise;
    } else if (word.text == "SFM" || word.text == "SMM") {
      edge = word.text == "SFM" ? kFoot : kMetre;
    } else if (word.text == "RANGE" || word.text == "MAXRPM") {
      ++i;  // with its number
    } else if (!word.text.empty() && !harmless.contains(word.text)) {
      throw InputError(word.place, fmt::format("SPINDL/\"{}\" is not known", word.text.substr(0, 40)));
    }
  }
  if (!value || !(*value > 0)) return spindle;
  if (edge > 0 && !(diameter > 0))
    throw InputError(statement.major.place,
                     "SPINDL gives the speed of the cutting edge, and no CUTTER before it says its diameter");
  revolutions_ = *value / 60;
  if (edge > 0) revolutions_ *= edge / (kPi * diameter);
  spindle.speed = revolutions_;
  return spindle;
}

}  // namespace millpose
