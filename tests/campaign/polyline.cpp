// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.hpp"
#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

constexpr double kStep = 1, kTurnStep = 0.5 * kRadPerDeg;
constexpr size_t kLookAhead = 48;

double AngleOf(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

Eigen::Vector3d RotationVector(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::Quaterniond d = b * a.conjugate();
  if (d.w() < 0) d.coeffs() *= -1;
  const double sine = d.vec().norm();
  return sine > 0 ? Eigen::Vector3d(d.vec() / sine * 2 * std::atan2(sine, d.w())) : Eigen::Vector3d::Zero();
}

}  // namespace

Polyline Sampled(const std::vector<Step>& steps, const Joints& start, const Machine& machine) {
  Polyline line;
  Joints q = start;
  Pose at = ForwardFlange(machine.arm, start) * machine.X_FT;
  line.samples.push_back({at.translation(), Eigen::Quaterniond(at.linear()), 0});
  for (size_t i = 0; i < steps.size(); ++i) {
    const Step& step = steps[i];
    const Eigen::Quaterniond from(at.linear()), to(step.X_BT.linear());
    const Eigen::Vector3d way = step.X_BT.translation() - at.translation();
    const double turned = AngleOf(from, to);
    const int count =
        std::clamp(static_cast<int>(std::ceil(std::max(way.norm() / kStep, turned / kTurnStep))), 1, 200);
    const bool even =
        i > 0 && step.straight && step.angles && steps[i - 1].angles;  // three angles that run evenly
    for (int k = 1; k <= count; ++k) {
      const double share = static_cast<double>(k) / count;
      if (step.straight) {
        Eigen::Quaterniond o = from.slerp(share, to);
        if (even) {
          const Eigen::Vector3d abc =
              (*steps[i - 1].angles + share * (*step.angles - *steps[i - 1].angles)) * kDegPerRad;
          o = Eigen::Quaterniond(
              Eigen::Matrix3d(Oriented(machine.rotation, abc[0], abc[1], abc[2]) * machine.R_TC.transpose()));
        }
        line.samples.push_back({at.translation() + share * way, o, i});
      } else {
        const Pose tip = ForwardFlange(machine.arm, q + share * (step.q - q)) * machine.X_FT;
        line.samples.push_back({tip.translation(), Eigen::Quaterniond(tip.linear()), i});
      }
    }
    line.lengths.push_back(way.norm());
    line.angles.push_back(turned);
    line.along.push_back(way);
    line.about.push_back(RotationVector(from, to));
    q = step.q;
    at = step.X_BT;
  }
  return line;
}

Sample Between(const Sample& a, const Sample& b) { return {(a.p + b.p) / 2, a.o.slerp(0.5, b.o), b.step}; }

Corner CornerAt(const Polyline& line, size_t i) {
  const double a = line.lengths[i], b = line.lengths[i + 1];
  if (a < 1e-6 || b < 1e-6) return {};
  return {(line.along[i + 1] / b - line.along[i] / a).norm(),
          (line.about[i + 1] / b - line.about[i] / a).norm()};
}

double Follower::Follow(const Sample& sample) {
  double best = std::numeric_limits<double>::infinity(), best_share = share_;
  size_t best_segment = segment_;
  const size_t last = std::min(line_.samples.size(), segment_ + kLookAhead);
  for (size_t k = segment_; k + 1 < last; ++k) {
    const Sample &a = line_.samples[k], &b = line_.samples[k + 1];
    const Eigen::Vector3d way = b.p - a.p;
    const double turned = AngleOf(a.o, b.o);
    double share = 1;
    if (way.norm() / tolerance_ > turned / angle_tolerance_)
      share = (sample.p - a.p).dot(way) / way.squaredNorm();
    else if (turned > 0)
      share = AngleOf(a.o, sample.o) / turned;
    share = std::clamp(share, k == segment_ ? share_ : 0.0, 1.0);
    const double off = (sample.p - a.p - share * way).norm() / tolerance_;
    const double twisted = AngleOf(a.o.slerp(share, b.o), sample.o) / angle_tolerance_;
    const double distance = std::max(off, twisted);
    if (distance < best - 1e-9) {
      best = distance;
      best_segment = k;
      best_share = share;
    }
    if (best < 0.05 && distance > 5) break;  // found; the line leaves it
  }
  segment_ = best_segment;
  share_ = best_share;
  return best;
}

double FarthestOf(const std::vector<Joints>& way, const std::vector<Joints>& visited) {
  double farthest = 0, share_done = 0;
  size_t segment = 0;
  for (const Joints& q : visited) {
    double best = std::numeric_limits<double>::infinity(), best_share = share_done;
    size_t best_segment = segment;
    for (size_t k = segment; k + 1 < way.size(); ++k) {
      const Joints along = way[k + 1] - way[k];
      const double squared = along.squaredNorm();
      const double share = std::clamp(squared > 0 ? (q - way[k]).dot(along) / squared : 1.0,
                                      k == segment ? share_done : 0.0, 1.0);
      const double off = (q - way[k] - share * along).cwiseAbs().maxCoeff();
      if (off >= best) continue;
      best = off;
      best_segment = k;
      best_share = share;
    }
    segment = best_segment;
    share_done = best_share;
    farthest = std::max(farthest, best);
  }
  return farthest;
}

}  // namespace millpose::campaign
