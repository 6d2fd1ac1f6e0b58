// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/edge_kernel.hpp"

#include <cmath>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kPerTurn = 1 / kTurn;
constexpr double kRound = 0x1.8p52;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[gnu::always_inline]] inline double Short(double angle, double per_turn) {
  // Adding 1.5·2⁵² rounds to a whole number; with per_turn = 0 nothing is taken away.
  const double turns = (angle * per_turn + kRound) - kRound;
  return angle - turns * kTurn;
}

}  // namespace

void JointRows::Add(const Joints& joints) {
  for (int i = 0; i < 6; ++i) q[i].push_back(joints[i]);
  ++size;
}

void JointRows::Finish() {
  for (auto& row : q) row.resize(size + kLanes, 0.0);
}

Joints JointRows::At(size_t node) const {
  return (Joints() << q[0][node], q[1][node], q[2][node], q[3][node], q[4][node], q[5][node]).finished();
}

double ShortWay(double angle) { return Short(angle, kPerTurn); }

double StepCost(const StepRule& rule, const Joints& from, const Joints& to) {
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double step = Short(to[i] - from[i], rule.modulo_turns ? kPerTurn : 0.0);
    if (std::fabs(step) > rule.max_step[i]) return kInfinity;
    sum += step * step;
  }
  return rule.motion_weight * sum;
}

void RelaxFrom(const StepRule& rule, const JointRows& nodes, const std::vector<double>& row, size_t first,
               size_t last, const Joints& to, BestPredecessor& best) {
  static const InstructionSet set = WidestInstructionSet();
  const double weight = rule.motion_weight, turn = rule.modulo_turns ? kPerTurn : 0.0;
  const double t0 = to[0], t1 = to[1], t2 = to[2], t3 = to[3], t4 = to[4], t5 = to[5];
  const double m0 = rule.max_step[0], m1 = rule.max_step[1], m2 = rule.max_step[2], m3 = rule.max_step[3],
               m4 = rule.max_step[4], m5 = rule.max_step[5];
  Lanes out;
  for (size_t block = first; block < last; block += kLanes) {
    const double *q0 = &nodes.q[0][block], *q1 = &nodes.q[1][block], *q2 = &nodes.q[2][block],
                 *q3 = &nodes.q[3][block], *q4 = &nodes.q[4][block], *q5 = &nodes.q[5][block];
    const double* costs = &row[block];
    ForEachLane(set, [&] [[gnu::always_inline]] (int l) {
      const double d0 = Short(t0 - q0[l], turn), d1 = Short(t1 - q1[l], turn), d2 = Short(t2 - q2[l], turn);
      const double d3 = Short(t3 - q3[l], turn), d4 = Short(t4 - q4[l], turn), d5 = Short(t5 - q5[l], turn);
      const double sum = ((((d0 * d0 + d1 * d1) + d2 * d2) + d3 * d3) + d4 * d4) + d5 * d5;
      const bool within = (std::fabs(d0) <= m0) & (std::fabs(d1) <= m1) & (std::fabs(d2) <= m2) &
                          (std::fabs(d3) <= m3) & (std::fabs(d4) <= m4) & (std::fabs(d5) <= m5);
      out.v[l] = within ? costs[l] + weight * sum : kInfinity;
    });
    const size_t used = last - block < kLanes ? last - block : kLanes;
    for (size_t l = 0; l < used; ++l) {
      if (out.v[l] < best.cost) best = {out.v[l], block + l};
    }
  }
}

}  // namespace millpose
