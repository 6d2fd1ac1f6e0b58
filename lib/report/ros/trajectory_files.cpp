// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/trajectory_files.hpp"

#include <fmt/ranges.h>

#include <iterator>

#include "base/text.hpp"
#include "program/make_timeline.hpp"

namespace millpose {
namespace {

constexpr EnumWords<RunPart, 7> kPartWords = {{{"cut", RunPart::kCut},
                                               {"lead", RunPart::kLead},
                                               {"approach", RunPart::kApproach},
                                               {"retract", RunPart::kRetract},
                                               {"way", RunPart::kLinkMove},
                                               {"missing", RunPart::kMissing},
                                               {"external", RunPart::kExternal}}};

bool IsLinear(const std::vector<ExternalAxis>& axes, size_t joint) {
  return joint >= 6 && axes[joint - 6].kind == AxisKind::kLinear;
}

/// In rad and m.
std::vector<std::string> InRosUnits(const Eigen::VectorXd& values, const std::vector<ExternalAxis>& axes) {
  std::vector<std::string> texts;
  for (size_t k = 0; k < static_cast<size_t>(values.size()); ++k)
    texts.push_back(
        ShortestNumber(values[static_cast<Eigen::Index>(k)] / (IsLinear(axes, k) ? kMetre : 1) + 0.0));
  return texts;
}

struct WholeTime {
  long long seconds, nanoseconds;
};
WholeTime Whole(double time) {
  constexpr long long kPerSecond = 1'000'000'000;
  const long long all = std::llround(time * 1e9);
  return {all / kPerSecond, all % kPerSecond};
}

}  // namespace

std::string TrajectoryYaml(const std::vector<TrajectoryInstant>& run, const std::vector<ExternalAxis>& axes,
                           const RosNames& names, const std::vector<std::string>& head) {
  std::string text;
  for (const std::string& line : head) text += "# " + line + "\n";
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: {}\njoint_names: [{}]\npoints:\n",
                 kRosWorld, fmt::join(names.joints, ", "));
  for (const TrajectoryInstant& at : run) {
    const WholeTime time = Whole(at.time);
    fmt::format_to(out,
                   "- positions: [{}]\n  velocities: [{}]\n  time_from_start: {{sec: {}, nanosec: {}}}\n",
                   fmt::join(InRosUnits(at.position, axes), ", "), fmt::join(InRosUnits(at.rate, axes), ", "),
                   time.seconds, time.nanoseconds);
  }
  return text;
}

std::string TrajectoryTable(const std::vector<TrajectoryInstant>& run, const PlanResult& plan,
                            const MotionProgram& program, const RosNames& names) {
  const std::vector<ExternalAxis>& axes = program.external_axes;
  std::string text = "t_s";
  for (const char* per : {"", "_s"})
    for (size_t k = 0; k < names.joints.size(); ++k)
      text += fmt::format(",{}_{}{}", names.joints[k], IsLinear(axes, k) ? "m" : "rad", per);
  text += ",part,pass,point\n";
  const auto out = std::back_inserter(text);
  for (const TrajectoryInstant& at : run) {
    const Motion& motion = program.motions[at.motion];
    const WholeTime time = Whole(at.time);
    fmt::format_to(out, "{}.{:09},{},{},{},{},{}\n", time.seconds, time.nanoseconds,
                   fmt::join(InRosUnits(at.position, axes), ","), fmt::join(InRosUnits(at.rate, axes), ","),
                   at.motion == 0 ? "way" : WordOf(kPartWords, PartOf(plan, program, at.motion)),
                   motion.pass < 0 ? "" : fmt::format("{}", motion.pass),
                   !at.at_end || motion.point < 0 ? "" : fmt::format("{}", motion.point));
  }
  return text;
}

}  // namespace millpose
