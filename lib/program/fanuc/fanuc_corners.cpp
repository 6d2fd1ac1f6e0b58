// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/fanuc/fanuc_corners.hpp"

#include <limits>

#include "machine/motion/corner.hpp"
#include "program/controller_axes.hpp"

namespace millpose {
namespace {

double LengthOf(const MotionProgram& program, size_t i) {
  return (program.motions[i].X_PT.translation() - program.motions[i - 1].X_PT.translation()).norm();
}

bool IsCorner(const MotionProgram& program, size_t i) {
  const std::vector<Motion>& motions = program.motions;
  return i > 0 && i + 1 < motions.size() && motions[i].type == MotionType::kLinear && !motions[i].exact &&
         motions[i + 1].type == MotionType::kLinear;
}

/// mm: half of the shorter motion, beyond which CRy does not reach.
double HalfOfShorter(const MotionProgram& program, size_t i) {
  // Where a joint motion came before, its end is not known as a pose.
  const double before = program.motions[i - 1].type == MotionType::kLinear
                            ? LengthOf(program, i)
                            : std::numeric_limits<double>::infinity();
  return std::min(before, LengthOf(program, i + 1)) / 2;
}

/// mm that the tool goes while the ramps of two motions overlap.
double ReachOfCnt(const MotionProgram& program, size_t i, const FanucOptions& options) {
  return std::max(program.motions[i].feed, program.motions[i + 1].feed) * *options.acceleration_time;
}

/// How much direction (no unit) and turn per way (rad/mm) change within reach of corner `i`, on both sides of
/// it: the hull of what is cut off misses the path by half of the reach times these at most.
Corner ChangesWithin(const MotionProgram& program, size_t i, double reach) {
  const std::vector<Motion>& motions = program.motions;
  Corner sum = CornerBetween(motions[i - 1].X_PT, motions[i].X_PT, motions[i + 1].X_PT);
  const auto add = [&](size_t k) {
    const Corner corner = CornerBetween(motions[k - 1].X_PT, motions[k].X_PT, motions[k + 1].X_PT);
    sum.bend += 2 * corner.bend;  // with several, twice
    sum.twist += 2 * corner.twist;
  };
  bool several = false;
  double away = LengthOf(program, i);
  for (size_t k = i - 1; IsCorner(program, k) && away < reach; away += LengthOf(program, k), --k) {
    add(k);
    several = true;
  }
  away = LengthOf(program, i + 1);
  for (size_t k = i + 1; IsCorner(program, k) && away < reach; ++k, away += LengthOf(program, k)) {
    add(k);
    several = true;
  }
  if (several) {
    const Corner own = CornerBetween(motions[i - 1].X_PT, motions[i].X_PT, motions[i + 1].X_PT);
    sum.bend += own.bend;
    sum.twist += own.twist;
  }
  return sum;
}

bool Stays(const Corner& changes, double reach, const PathTolerance& tolerance) {
  return reach / 2 * changes.bend <= tolerance.position && reach / 2 * changes.twist <= tolerance.angle;
}

/// The widest CRy, in whole millimetres, or its half of a shorter motion; 0: none.
double ReachOfRegion(const MotionProgram& program, size_t i, const PathTolerance& tolerance) {
  const double half = HalfOfShorter(program, i);
  const Corner corner = ChangesWithin(program, i, 0);
  for (double reach = half < 1 ? half : std::min(std::floor(half), 1000.0); reach > 0;
       reach = half < 1 ? 0 : std::floor(reach / 2))
    if (Stays(corner, reach, tolerance)) return reach;
  return 0;
}

}  // namespace

std::string FanucCornerAssumption(const FanucOptions& options, const PostSettings& settings) {
  if (!settings.max_corner) return {};
  if (options.acceleration_time)
    return fmt::format(
        "at CNTn two motions overlap for {} ms at most (the cell's acceleration_time_ms), and the path stays "
        "within "
        "the hull of what the tool goes in that time before and behind a corner",
        Short(*options.acceleration_time * 1000, 1));
  if (options.corner_region)
    return "CRy begins and ends within y mm of the corner, at most half of the shorter motion, and stays in "
           "the "
           "triangle that it cuts off";
  return {};
}

void ChooseFanucCorners(MotionProgram& program, const FanucOptions& options, const PostSettings& settings) {
  program.blend_is_distance = true;
  program.corner_assumption = FanucCornerAssumption(options, settings);
  PathTolerance tolerance = settings.tolerance;
  if (settings.max_corner) tolerance.position = kWrittenShare * *settings.max_corner;
  for (size_t i = 0; i < program.motions.size(); ++i) {
    Motion& motion = program.motions[i];
    motion.blend = motion.angle_blend = 0;
    if (program.corner_assumption.empty() || !IsCorner(program, i)) continue;
    if (!options.acceleration_time) {
      motion.blend = ReachOfRegion(program, i, tolerance);
      continue;
    }
    const double reach = ReachOfCnt(program, i, options);
    if (Stays(ChangesWithin(program, i, reach), reach, tolerance)) motion.blend = reach;
  }
}

std::string FanucTermination(const Motion& motion, const FanucOptions& options) {
  if (motion.exact) return "FINE";
  if (motion.blend <= 0) return "CNT0";
  return options.acceleration_time ? "CNT100" : fmt::format("CR{:.0f}", std::ceil(motion.blend - 1e-9));
}

void SettleFanucCorners(MotionProgram& program, const FanucOptions& options) {
  for (size_t i = 0; i < program.motions.size(); ++i) {
    Motion& motion = program.motions[i];
    if (motion.blend <= 0) continue;
    if (i + 1 == program.motions.size() || i == 0 || program.motions[i + 1].type != MotionType::kLinear)
      continue;
    motion.blend = options.acceleration_time ? ReachOfCnt(program, i, options)
                                             : std::min(motion.blend, HalfOfShorter(program, i));
  }
}

}  // namespace millpose
