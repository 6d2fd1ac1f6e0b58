// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/stations.hpp"

#include <ranges>

#include "base/units.hpp"
#include "machine/collision/station_path.hpp"

namespace millpose {
namespace {

constexpr double kArmStands = 1e-4;      // rad: six decimals of a degree
constexpr double kSameLength = 1e-3;     // mm: four decimals
constexpr double kSameTurn = 1.7453e-5;  // rad (0.001°)

bool IsRotary(const ExternalAxis& axis) { return axis.kind == AxisKind::kRotary; }
double SlackOf(const ExternalAxis& axis) { return IsRotary(axis) ? kSameTurn : kSameLength; }

std::string ValueText(const ExternalAxis& axis, double value) {
  return IsRotary(axis) ? fmt::format("{:.4f} deg", value * kDegPerRad) : fmt::format("{:.4f} mm", value);
}

std::string Text(const std::vector<ExternalAxis>& axes, const ExternalPosition& external) {
  std::vector<std::string> values;
  for (size_t k = 0; k < axes.size(); ++k)
    values.push_back(fmt::format("{} {}", axes[k].name, ValueText(axes[k], external[k])));
  return fmt::format("{}", fmt::join(values, ", "));
}

/// A place of the external axes: from motion `motion` on, after so many runs.
struct Station {
  ExternalPosition external;
  size_t motion = 0, runs = 0;
};

std::vector<Station> StationsOf(const Replayed& replayed) {
  std::vector<Station> stations;
  for (size_t i = 0; i < replayed.program.motions.size(); ++i) {
    if (i > 0 && (!MovesExternal(replayed.program, i) || CoordinatedMotions(replayed.program, i))) continue;
    const auto runs = std::ranges::count_if(replayed.runs, [i](const FeedRun& run) { return run.first < i; });
    stations.push_back({replayed.program.motions[i].external, i, static_cast<size_t>(runs)});
  }
  return stations;
}

}  // namespace

Pose BaseInWorld(const Cell& cell, const ExternalPosition& external) {
  if (external.empty()) return cell.X_WB;
  return Mechanism(cell.external_axes).Moved(Carries::kRobot, external) * cell.X_WB;
}

Pose BaseInPart(const Cell& cell, const ExternalPosition& external) {
  if (external.empty()) return cell.X_WP.inverse() * cell.X_WB;
  const Pose X_WP = Mechanism(cell.external_axes).Moved(Carries::kWorkpiece, external) * cell.X_WP;
  return X_WP.inverse() * BaseInWorld(cell, external);
}

bool CheckExternal(const Replayed& replayed, size_t i, const Cell& cell, std::vector<Finding>& findings) {
  const std::vector<ExternalAxis>& axes = cell.external_axes;
  const std::vector<Motion>& motions = replayed.program.motions;
  const auto report = [&](Cause cause, const std::string& message) {
    findings.push_back(At(replayed.program, i, cause, message));
    return false;
  };
  for (size_t k = 0; k < axes.size(); ++k) {
    const double value = motions[i].external[k];
    if (value >= axes[k].lower - SlackOf(axes[k]) && value <= axes[k].upper + SlackOf(axes[k])) continue;
    return report(Cause::kReach,
                  fmt::format("{} at {} leaves its limits {} to {}", axes[k].name, ValueText(axes[k], value),
                              ValueText(axes[k], axes[k].lower), ValueText(axes[k], axes[k].upper)));
  }
  if (!MovesExternal(replayed.program, i) || CoordinatedMotions(replayed.program, i)) return true;
  // Numbers that differ by their rounding name one place.
  const auto stands = [&](size_t k) {
    return std::abs(motions[i].external[k] - motions[i - 1].external[k]) <= SlackOf(axes[k]);
  };
  if (std::ranges::all_of(std::views::iota(size_t{0}, axes.size()), stands)) return true;
  const double turned = (replayed.replay.targets[i] - replayed.replay.targets[i - 1]).cwiseAbs().maxCoeff();
  if (turned > kArmStands)
    return report(Cause::kWay, fmt::format("the arm turns by {:.3f} deg of a joint while the external axes "
                                           "move; it must stand still",
                                           turned * kDegPerRad));
  if (!motions[i].exact || !motions[i - 1].exact)
    return report(Cause::kStop, "no stop where the external axes begin and end to move");
  return true;
}

bool CheckExternalSpeed(const Replayed& replayed, size_t i, double seconds, std::vector<Finding>& findings) {
  const MotionProgram& program = replayed.program;
  if (!CoordinatedMotions(program, i)) return false;
  for (size_t k = 0; k < program.external_axes.size(); ++k) {
    const ExternalAxis& axis = program.external_axes[k];
    const double speed =
        std::abs(program.motions[i].external[k] - program.motions[i - 1].external[k]) / seconds;
    if (speed <= axis.speed * kSpeedSlack) continue;
    findings.push_back(At(program, i, Cause::kJointSpeed,
                          fmt::format("{} would move at {}/s, it can do {}/s", axis.name,
                                      ValueText(axis, speed), ValueText(axis, axis.speed))));
    return true;
  }
  return false;
}

std::string ExternalJump(const Replayed& replayed, size_t i, double in, double out, double jump_time) {
  const std::vector<Motion>& motions = replayed.program.motions;
  for (size_t k = 0; k < replayed.program.external_axes.size(); ++k) {
    const ExternalAxis& axis = replayed.program.external_axes[k];
    const double jump = (motions[i + 1].external[k] - motions[i].external[k]) / out -
                        (motions[i].external[k] - motions[i - 1].external[k]) / in;
    if (std::abs(jump) > axis.acceleration * jump_time)
      return fmt::format(
          "{} would have to change its speed by {}/s at a corner that is passed without a stop", axis.name,
          ValueText(axis, std::abs(jump)));
  }
  return {};
}

void CompareStations(const Replayed& replayed, const Replayed& plan, const VerifyOptions& options,
                     std::vector<Finding>& findings) {
  const std::vector<ExternalAxis>& axes = plan.program.external_axes;
  if (axes.empty()) return;
  const std::vector<Station> given = StationsOf(replayed), wanted = StationsOf(plan);
  const auto same = [&](const Station& a, const Station& b) {
    for (size_t k = 0; k < axes.size(); ++k)
      if (std::abs(a.external[k] - b.external[k]) > SlackOf(axes[k])) return false;
    const Joints off = replayed.replay.targets[a.motion] - plan.replay.targets[b.motion];
    return a.runs == b.runs && off.cwiseAbs().maxCoeff() <= options.gap_tolerance;
  };
  for (size_t i = 0; i < std::max(given.size(), wanted.size()); ++i) {
    if (i < given.size() && i < wanted.size() && same(given[i], wanted[i])) continue;
    const auto name = [&](const std::vector<Station>& list) {
      return i < list.size() ? fmt::format("to {} after cut {}", Text(axes, list[i].external), list[i].runs)
                             : std::string("nowhere any more");
    };
    const size_t motion = i < given.size() ? given[i].motion : replayed.program.motions.size() - 1;
    findings.push_back(At(replayed.program, motion, Cause::kWay,
                          fmt::format("the external axes go {} here, planned: {}{}", name(given),
                                      name(wanted), i == 0 ? "" : ", the arm standing as planned")));
    return;
  }
}

std::optional<Interference> InterferenceOfMove(const Replayed& replayed, size_t i, const World& world,
                                               double resolution) {
  const std::vector<Motion>& motions = replayed.program.motions;
  return StationPath(world, replayed.replay.targets[i], resolution)
      .Between(motions[i - 1].external, motions[i].external);
}

}  // namespace millpose
