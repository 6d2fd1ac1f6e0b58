// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_motion.hpp"

namespace millpose {

bool GcodeModes::TakeG(double g) {
  const auto is = [&](std::initializer_list<double> list) {
    return std::ranges::find(list, g) != list.end();
  };
  if (is({0, 1, 2, 3})) {
    motion = static_cast<int>(g);
  } else if (is({17, 18, 19})) {
    plane = static_cast<int>(g) - 17;
  } else if (is({20, 70, 700})) {
    inch = unit_stated = true;
    inch_feed = g != 70;
  } else if (is({21, 71, 710})) {
    inch = inch_feed = false;
    unit_stated = true;
  } else if (is({90, 91})) {
    incremental = g == 91;
  } else if (is({90.1, 91.1})) {
    absolute_centre = g == 90.1;
  } else if (is({93, 94, 95})) {
    feed_mode = static_cast<int>(g);
    feed_word.reset();
  } else {
    return false;
  }
  return true;
}

void GcodeModes::SetFeed() {
  if (!feed_word) return;
  const double unit = inch_feed ? 25.4 : 1;
  if (feed_mode == 93) {
    inverse_time = *feed_word / 60;
    feed = 0;
    feed_word.reset();  // holds for its block
  } else {
    feed = *feed_word * unit * (feed_mode == 95 ? revolutions : 1.0 / 60);
  }
}

bool GcodeMove::Put(const GcodeWord& word, bool vector_in_ijk) {
  const std::string& address = word.address;
  const auto put = [&](std::array<const GcodeWord*, 3>& words, std::string_view letters) {
    const size_t i = letters.find(address[0]);
    if (i == std::string::npos) return false;
    if (std::exchange(words[i], &word))
      throw InputError(word.place, address + " is there twice in the block");
    return true;
  };
  if (address.size() == 1)
    return put(linear, "XYZ") || put(rotary, "ABC") || put(vector_in_ijk ? vector : centre, "IJK");
  return address.size() == 2 && address[1] == '3' && put(vector, "ABC");
}

}  // namespace millpose
