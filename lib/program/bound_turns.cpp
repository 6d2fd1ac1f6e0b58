// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/bound_turns.hpp"

#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr int kMostParts = 64;  // of one motion

double Deviation(const Pose& from, const Pose& to, const std::vector<LineModel>& lines) {
  double most = 0;
  for (const LineModel& line : lines) most = std::max(most, TurnDeviation(line(from, to), from, to));
  return most;
}

/// Into how many equal parts a motion must be divided; beyond kMostParts verification says what is left.
int PartsOf(const Pose& from, const Pose& to, const TurnBound& bound) {
  if (Deviation(from, to, bound.lines) <= bound.angle_tolerance) return 1;
  const PoseLine line(from, to);
  for (int parts = 2; parts < kMostParts; ++parts) {
    bool near = true;
    for (int i = 0; i < parts && near; ++i)
      near = Deviation(line.At(static_cast<double>(i) / parts), line.At(static_cast<double>(i + 1) / parts),
                       bound.lines) <= bound.angle_tolerance;
    if (near) return parts;
  }
  return kMostParts;
}

/// The points that divide motion `i`; none where the arm does not reach one of them.
std::vector<Motion> MotionsBetween(const MotionProgram& program, size_t i, int parts, const Arm& arm) {
  std::vector<Motion> points;
  const Motion &from = program.motions[i - 1], &to = program.motions[i];
  const PoseLine line(from.X_PT, to.X_PT);
  for (int k = 1; k < parts; ++k) {
    const double share = static_cast<double>(k) / parts;
    Motion& point = points.emplace_back(to);
    point.X_PT = line.At(share);
    point.exact = false;
    point.point = -1;
    const Pose X_BP = FrameAt(program, i, share);
    if (to.X_BP_begin) {
      point.X_BP = X_BP;
      if (k > 1) point.X_BP_begin = points[points.size() - 2].X_BP;
      point.external = ExternalOf(program, i, share);
    }
    const Pose X_BF = X_BP * point.X_PT * program.X_FT->inverse();
    point.q = InverseNear(arm, X_BF, Status(arm, *to.q), *from.q + share * (*to.q - *from.q));
    if (!point.q) return {};
  }
  return points;
}

}  // namespace

int BoundTurns(MotionProgram& written, std::vector<size_t>& origin, const Arm& arm, const TurnBound& bound) {
  std::vector<Motion> motions;
  std::vector<size_t> origins, place;  // place: where what came before each motion comes now
  int inserted = 0;
  for (size_t i = 0; i < written.motions.size(); ++i) {
    place.push_back(motions.size());
    const Motion& motion = written.motions[i];
    const bool single = i > 0 && motion.type == MotionType::kLinear && origin[i] == origin[i - 1] + 1;
    if (single) {
      const Motion& from = written.motions[i - 1];
      const int parts = PartsOf(from.X_PT, motion.X_PT, bound);
      for (Motion& point : MotionsBetween(written, i, parts, arm)) {
        motions.push_back(std::move(point));
        origins.push_back(origin[i]);
        ++inserted;
      }
    }
    const bool divided = motion.X_BP_begin && motions.size() > place.back();
    motions.push_back(motion);
    if (divided) motions.back().X_BP_begin = motions[motions.size() - 2].X_BP;
    origins.push_back(origin[i]);
  }
  place.push_back(motions.size());
  for (ProgramEvent& event : written.events) event.before_motion = place[event.before_motion];
  written.motions = std::move(motions);
  origin = std::move(origins);
  return inserted;
}

}  // namespace millpose
