// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/verify/same_motions.hpp"

#include "base/units.hpp"
#include "machine/motion/line.hpp"

namespace millpose {
namespace {

/// The targets of a program's motions with feed, as tool poses in the base.
std::vector<Pose> Places(const MotionProgram& program, const PlanResult& plan) {
  std::vector<Pose> places;
  for (const Motion& motion : program.motions) {
    places.push_back(motion.q ? ForwardFlange(plan.arm, *motion.q) * program.X_FT.value_or(plan.X_FT)
                              : program.X_BP.value() * motion.X_PT);
  }
  return places;
}

/// Whether every place of `a` lies on one of the straight lines between places of `b`.
bool Covers(const std::vector<Pose>& b, const std::vector<Pose>& a) {
  return std::all_of(a.begin(), a.end(), [&](const Pose& pose) {
    for (size_t i = 1; i < b.size(); ++i) {
      const Eigen::Vector3d from = b[i - 1].translation(), along = b[i].translation() - from;
      const double squared = along.squaredNorm();
      const double s =
          squared > 0 ? std::clamp((pose.translation() - from).dot(along) / squared, 0.0, 1.0) : 0.0;
      const Eigen::Quaterniond first(b[i - 1].linear()), last(b[i].linear());
      const bool near = (from + s * along - pose.translation()).norm() < 0.02;
      if (near && AngleBetween(first.slerp(s, last).toRotationMatrix(), pose.linear()) < 0.02 * kRadPerDeg)
        return true;
    }
    return false;
  });
}

/// Whether every joint target of `a` lies within the joint tolerance of verification of the joint motions of
/// `b`.
bool CoversJoints(const MotionProgram& b, const MotionProgram& a) {
  std::vector<Joints> way;
  for (const Motion& motion : b.motions)
    if (motion.q) way.push_back(*motion.q);
  return std::all_of(a.motions.begin(), a.motions.end(), [&](const Motion& motion) {
    if (!motion.q) return true;
    for (size_t i = 1; i < way.size(); ++i) {
      const Joints along = way[i] - way[i - 1];
      const double squared = along.squaredNorm();
      const double s =
          squared > 0 ? std::clamp((*motion.q - way[i - 1]).dot(along) / squared, 0.0, 1.0) : 0.0;
      if ((way[i - 1] + s * along - *motion.q).cwiseAbs().maxCoeff() < 0.05 * kRadPerDeg) return true;
    }
    return false;
  });
}

/// The places of straight motions; joint motions are compared as such.
std::vector<Pose> StraightPlaces(const MotionProgram& program, const PlanResult& plan) {
  const std::vector<Pose> all = Places(program, plan);
  std::vector<Pose> places;
  for (size_t i = 0; i < all.size(); ++i)
    if (!program.motions[i].q || program.motions[i].duration > 0) places.push_back(all[i]);
  return places;
}

}  // namespace

bool SameMotions(const MotionProgram& a, const MotionProgram& b, const PlanResult& plan) {
  const std::vector<Pose> places = Places(a, plan), others = Places(b, plan);
  const bool paired = a.motions.size() == b.motions.size();  // else one has a point that the other passes
  for (size_t i = 0; paired && i < a.motions.size(); ++i) {
    const Motion &x = a.motions[i], &y = b.motions[i];
    // A motion that hardly moves is the same whatever its kind.
    const bool stands = i > 0 && (places[i].translation() - places[i - 1].translation()).norm() < 0.1;
    if (stands && x.type != y.type) continue;
    if (x.type != y.type || x.exact != y.exact || x.q.has_value() != y.q.has_value()) return false;
    if (x.q && (*x.q - *y.q).cwiseAbs().maxCoeff() > 1e-3) return false;
    if (y.feed > x.feed * 1.001 || y.feed < x.feed * 0.5) return false;
    if (y.duration > x.duration * 2 || y.duration < x.duration * 0.999) return false;
  }
  return Covers(places, StraightPlaces(b, plan)) && Covers(others, StraightPlaces(a, plan)) &&
         CoversJoints(a, b) && CoversJoints(b, a);
}

}  // namespace millpose
