// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/lost_motion.hpp"

namespace millpose {

GearValues AtGears(const LostMotion& lost, const Joints& q, const ExternalPosition& external) {
  GearValues at(6 + static_cast<Eigen::Index>(external.size()));
  at.head<6>() = lost.gears.FromArm(q);
  for (size_t i = 0; i < external.size(); ++i) at[6 + static_cast<Eigen::Index>(i)] = external[i];
  return at;
}

GearValues GearLevers(const LostMotion& lost, const Joints& by_joint,
                      const std::vector<double>& by_external) {
  GearValues levers(6 + static_cast<Eigen::Index>(by_external.size()));
  levers.head<6>() = lost.gears.CountTorques(by_joint);  // the transpose, as for torques
  for (size_t i = 0; i < by_external.size(); ++i) levers[6 + static_cast<Eigen::Index>(i)] = by_external[i];
  return levers;
}

GearFlanks::GearFlanks(const LostMotion& lost, const GearValues& first_move, const GearValues& load)
    : half_(0.5 * lost.width), friction_(lost.friction), offset_(lost.width.size()) {
  for (Eigen::Index i = 0; i < offset_.size(); ++i)
    offset_[i] = i < first_move.size() && first_move[i] < 0 ? half_[i] : -half_[i];
  Press(load);
}

void GearFlanks::Move(const GearValues& move, const GearValues& load) {
  offset_ = (offset_ - move).cwiseMax(-half_).cwiseMin(half_);
  Press(load);
}

void GearFlanks::Press(const GearValues& load) {
  for (Eigen::Index i = 0; i < load.size(); ++i)
    if (std::abs(load[i]) > friction_[i]) offset_[i] = load[i] > 0 ? half_[i] : -half_[i];
}

int ReversalCounter::Next(double position) {
  const int at = count_++;
  if (at == 0) {
    low_ = high_ = position;
    return -1;
  }
  int turned = -1;
  if (direction_ >= 0 && high_ - position > dead_zone_) {
    if (direction_ > 0) turned = high_at_;
    direction_ = -1, low_ = position, low_at_ = at;
  } else if (direction_ <= 0 && position - low_ > dead_zone_) {
    if (direction_ < 0) turned = low_at_;
    direction_ = 1, high_ = position, high_at_ = at;
  }
  if (position > high_) high_ = position, high_at_ = at;
  if (position < low_) low_ = position, low_at_ = at;
  return turned;
}

namespace {

double DeadZone(Eigen::Index gear, const std::vector<ExternalAxis>& external) {
  const auto axis = static_cast<size_t>(gear) - 6;
  return gear >= 6 && axis < external.size() && external[axis].kind == AxisKind::kLinear
             ? kReversalDeadZoneLinear
             : kReversalDeadZone;
}

}  // namespace

GearValues FirstMove(const LostMotion& lost, const std::vector<GearValues>& way,
                     const std::vector<ExternalAxis>& external) {
  GearValues first = GearValues::Zero(lost.width.size());
  for (Eigen::Index i = 0; i < first.size(); ++i) {
    ReversalCounter counter(DeadZone(i, external));
    for (size_t t = 0; t < way.size() && counter.direction() == 0; ++t) counter.Next(way[t][i]);
    first[i] = counter.direction();
  }
  return first;
}

std::vector<GearValues> OffsetsAlong(const LostMotion& lost, const std::vector<GearValues>& way,
                                     const std::vector<GearValues>& load,
                                     const std::vector<ExternalAxis>& external) {
  std::vector<GearValues> offsets;
  if (way.empty()) return offsets;
  const auto loaded = [&](size_t t) { return load.empty() ? GearValues() : load[t]; };
  GearFlanks flanks(lost, FirstMove(lost, way, external), loaded(0));
  offsets.push_back(flanks.offset());
  for (size_t t = 1; t < way.size(); ++t) {
    flanks.Move(way[t] - way[t - 1], loaded(t));
    offsets.push_back(flanks.offset());
  }
  return offsets;
}

}  // namespace millpose
