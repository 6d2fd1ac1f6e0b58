// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/urscript/urscript_rounding.hpp"

#include "program/urscript/urscript.hpp"

namespace millpose {
namespace {

constexpr double kStep = 1e-4;  // mm, of the text's last digit

/// The largest distance at which the chord of the blend stays this near to the corner: it misses it by half
/// of the distance times the bend.
double MostFor(const Corner& corner, const PathTolerance& tolerance) {
  double most = kBlendShare / 2 * corner.shorter;
  if (corner.bend > 0) most = std::min(most, 2 * tolerance.position / corner.bend);
  if (corner.twist > 0) most = std::min(most, 2 * tolerance.angle / corner.twist);
  return std::floor(most / kStep) * kStep;
}

}  // namespace

void ChooseBlends(MotionProgram& program, const PostSettings& settings) {
  PathTolerance tolerance = settings.tolerance;
  if (settings.max_corner) tolerance.position = kWrittenShare * *settings.max_corner;
  program.blend_is_distance = true;
  program.corner_assumption = kUrScriptCorner;
  std::vector<Motion>& motions = program.motions;
  for (size_t i = 0; i < motions.size(); ++i) {
    Motion& motion = motions[i];
    motion.blend = 0;
    const bool corner = i > 0 && i + 1 < motions.size() && motion.type == MotionType::kLinear &&
                        motions[i + 1].type == MotionType::kLinear && !motion.exact;
    if (corner)
      motion.blend = MostFor(CornerBetween(motions[i - 1].X_PT, motion.X_PT, motions[i + 1].X_PT), tolerance);
    motion.exact = motion.blend <= 0;
  }
}

}  // namespace millpose
