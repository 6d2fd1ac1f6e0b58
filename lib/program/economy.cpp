// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/economy.hpp"

#include "base/error.hpp"
#include "program/controller_axes.hpp"
#include "program/pose_line.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr size_t kLongest = 512;  // points that one motion may stand for: bounds the work

/// Points of a cut that may be left out: blended, between two others at one feed.
bool MayGo(const std::vector<Motion>& motions, size_t i) {
  return i > 0 && i + 1 < motions.size() && motions[i].type == MotionType::kLinear && !motions[i].exact &&
         motions[i].point >= 0 && motions[i + 1].type == MotionType::kLinear &&
         motions[i + 1].feed == motions[i].feed && motions[i + 1].point >= 0;
}

/// Whether the straight motion from pose `a` to pose `b` passes the targets first..last−1 within tolerance,
/// in order.
bool Passes(const Pose& a, const Pose& b, const std::vector<Motion>& motions, size_t first, size_t last,
            const EconomyOptions& options) {
  const PoseLine line(a, b);
  const Eigen::Vector3d along = line.to() - line.from();
  double before = 0;
  for (size_t i = first; i < last; ++i) {
    const Eigen::Vector3d offset = motions[i].X_PT.translation() - line.from();
    const double share = line.length() > 0 ? offset.dot(along) / along.squaredNorm() : -1;
    if (share < before || share > 1) return false;
    before = share;
    const Pose pose = line.At(share);
    if ((pose.translation() - motions[i].X_PT.translation()).norm() > options.position_tolerance)
      return false;
    if (AngleBetween(pose.linear(), motions[i].X_PT.linear()) > options.angle_tolerance) return false;
  }
  return true;
}

}  // namespace

EconomyResult Economise(const MotionProgram& program, const EconomyOptions& options) {
  const std::vector<Motion>& motions = program.motions;
  EconomyResult result;
  result.program = program;
  result.program.motions.clear();
  std::vector<size_t> place(motions.size() + 1);  // new index of each old motion, or of the next that remains
  for (size_t i = 0; i < motions.size();) {
    size_t end = i;  // the motion that stands for i..end
    if (i > 0) {
      while (end - i < kLongest && MayGo(motions, end) &&
             Passes(motions[i - 1].X_PT, motions[end + 1].X_PT, motions, i, end + 1, options)) {
        ++end;
      }
    }
    for (size_t k = i; k <= end; ++k) place[k] = result.program.motions.size();
    result.saved += static_cast<int>(end - i);
    if (i > 0 && motions[end].point >= 0 && options.spacing > 0) {
      const double step = (motions[end].X_PT.translation() - motions[i - 1].X_PT.translation()).norm();
      if (step < options.spacing) ++result.near;
    }
    result.program.motions.push_back(motions[end]);
    i = end + 1;
  }
  place[motions.size()] = result.program.motions.size();
  for (ProgramEvent& event : result.program.events) event.before_motion = place[event.before_motion];
  return result;
}

MotionProgram Lifted(const MotionProgram& program, const Arm& arm, double offset) {
  MotionProgram lifted = program;
  std::vector<Problem> problems;
  for (Motion& motion : lifted.motions) {
    if (motion.point < 0) continue;
    motion.X_PT = motion.X_PT * Eigen::Translation3d(0, 0, offset);
    const Pose X_BF = program.X_BP.value() * motion.X_PT * program.X_FT.value().inverse();
    const auto q = InverseNear(arm, X_BF, Status(arm, *motion.q), *motion.q);
    if (q) {
      motion.q = q;
    } else {
      problems.push_back(
          {Place{}, fmt::format("dry run: pass {} point {} is out of reach when lifted by {} mm", motion.pass,
                                motion.point, offset)});
    }
  }
  if (!problems.empty()) throw InputError(problems);
  return lifted;
}

}  // namespace millpose
