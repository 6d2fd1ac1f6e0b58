// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/arm_bodies.hpp"

#include "base/trig.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {

ArmBodies::ArmBodies(const Cell& cell) : cell_(cell) {
  const Arm& arm = cell.arm;
  const double links = ArmLength(arm);
  for (const Body& body : cell.bodies) {
    const bool on_tool = body.mount == Mount::kTool;
    if (!on_tool && body.mount != Mount::kLink) continue;
    const Pose X_LG = on_tool ? cell.X_FT * body.X_MG : body.X_MG;
    balls_.push_back({on_tool ? 6 : static_cast<size_t>(body.link), X_LG.translation(), Radius(body.shape)});
    reach_ = std::max(reach_, links + balls_.back().centre.norm() + balls_.back().radius);
  }
}

bool ArmBodies::MovesFurther(const Joints& q, const Joints& p, double distance) const {
  if ((q - p).cwiseAbs().sum() * reach_ <= distance) return false;  // a bound that settles nearly all
  const LinkPoses X_q = LinkFrames(cell_.arm, q), X_p = LinkFrames(cell_.arm, p);
  std::array<double, 7> turned{};
  for (size_t link = 0; link < 7; ++link) turned[link] = AngleBetween(X_q[link].linear(), X_p[link].linear());
  for (const Ball& ball : balls_) {
    const double moved = (X_q[ball.link] * ball.centre - X_p[ball.link] * ball.centre).norm();
    if (moved + turned[ball.link] * ball.radius > distance) return true;
  }
  return false;
}

}  // namespace millpose
