// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/machine_zeros.hpp"

#include <algorithm>

namespace millpose {

void MachineZeros::Take(const std::string& word, const std::vector<double>& numbers,
                        const SourceLocation& place, bool moving) {
  ++count_;
  std::vector<double>& last = last_[word];
  last.resize(6, 0);
  std::vector<double> given = numbers;
  given.resize(6, 0);
  const bool zero = std::ranges::all_of(given, [](double v) { return v == 0; });
  const bool changes = moving && given != last, shifts = word == "TRANS" && !zero;
  last = given;
  if (!changes && !shifts) return;
  used_key_ = used_key_ || options_.frame.has_value();
  if (options_.frame == CamFrame::kAsGiven) return;
  throw InputError(
      place, fmt::format("{} {}: whether the points behind it are the workpiece's as they are written is not "
                         "known. Let the CAM system write one file for each system, or state "
                         "toolpath.cam.frame: as_given when it only moves the machine's zero",
                         word, changes ? "changes between points" : "shifts the points at the machine"));
}

}  // namespace millpose
