// SPDX-License-Identifier: GPL-3.0-or-later
#include "identify_lost_motion.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/loose_file.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

double Arcmin(double radians) { return 60 * RadToDeg(radians); }

}  // namespace

LostMotionEstimates EstimateLostMotion(const MeasurementsSettings& settings, const ArmSettings& cell,
                                       const Arm& arm) {
  if (!cell.gear_couplings.empty())
    throw InputError(
        {settings.file},
        "two_way: the cell's arm.gear_couplings turn several gears with one axis; allowed: an arm "
        "without them");
  std::vector<TwoWayReading> readings;
  for (const TwoWaySettings& from : settings.two_way) {
    const bool pushed = from.push.has_value();
    readings.push_back({from.joint - 1, from.joints, from.measured_point.value_or(settings.measured_point),
                        from.direction, pushed ? from.pushed_against : from.from_below,
                        pushed ? from.pushed_along : from.from_above, from.push.value_or(0)});
  }
  return FitLostMotion(arm, readings);
}

bool AllDetermined(const MeasurementsSettings& settings, const LostMotionEstimates& found) {
  return std::ranges::all_of(settings.two_way, [&](const TwoWaySettings& reading) {
    return found[static_cast<size_t>(reading.joint) - 1].determined;
  });
}

void PrintLostMotion(const LostMotionEstimates& found) {
  fmt::print("joint   lost motion      95 % interval            half the difference   readings\n");
  for (size_t j = 0; j < found.size(); ++j) {
    const LostMotionEstimate& joint = found[j];
    if (joint.determined)
      fmt::print("A{}     {:>10.3g} {:>12.3g} .. {:<8.3g} arcmin {:>12.4g} mm {:>13} in {} poses\n", j + 1,
                 Arcmin(joint.width), Arcmin(joint.lower), Arcmin(joint.upper), joint.half_difference,
                 joint.readings, joint.poses);
    else
      fmt::print("A{}      no number: {}\n", j + 1, joint.reason);
  }
}

nlohmann::ordered_json LostMotionJson(const LostMotionEstimates& found) {
  using Tree = nlohmann::ordered_json;
  Tree joints = Tree::array();
  for (size_t j = 0; j < found.size(); ++j) {
    const LostMotionEstimate& joint = found[j];
    const auto number = [&](double value) { return joint.determined ? Tree(value) : Tree(nullptr); };
    joints.push_back({{"joint", j + 1},
                      {"determined", joint.determined},
                      {"reason", joint.determined ? Tree(nullptr) : Tree(joint.reason)},
                      {"lost_motion_arcmin", number(Arcmin(joint.width))},
                      {"lower_95_arcmin", number(Arcmin(joint.lower))},
                      {"upper_95_arcmin", number(Arcmin(joint.upper))},
                      {"half_difference_mm", number(joint.half_difference)},
                      {"readings", joint.readings},
                      {"poses", joint.poses}});
  }
  return joints;
}

void WriteLostMotion(const std::string& cell_file, const std::string& measurements, const ArmSettings& cell,
                     const LostMotionEstimates& found) {
  Vector6 width = cell.lost_motion.value_or(Vector6::Zero());
  std::string kept;
  for (int j = 0; j < 6; ++j) {
    const LostMotionEstimate& joint = found[static_cast<size_t>(j)];
    if (joint.determined)
      width[j] = joint.width;
    else
      kept += fmt::format(" A{}", j + 1);
  }
  if (!kept.empty() && !cell.lost_motion)
    throw InputError({cell_file},
                     fmt::format("--write-cell: no number for{}, and the cell states none; allowed: "
                                 "readings of every joint, or arm.lost_motion_arcmin in the cell",
                                 kept));
  std::string source = "millpose identify " + std::filesystem::path(measurements).filename().string();
  if (!kept.empty()) source += fmt::format(", but as before ({}):{}", cell.lost_motion_source, kept);
  EditLooseFile(cell_file,
                [&](const std::string& text) { return ReplaceLostMotion(text, cell_file, width, source); });
  std::fputs(fmt::format("millpose: {} updated{}\n", cell_file, kept.empty() ? "" : "; kept:" + kept).c_str(),
             stderr);
}

}  // namespace millpose
