// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/lost_motion.hpp"

#include <algorithm>
#include <tuple>

#include "base/trig.hpp"

namespace millpose {

Joints GearError::At(const Joints& gears) const {
  Joints ahead;
  for (int i = 0; i < 6; ++i) ahead[i] = amplitude[i] * SinCos(periods[i] * gears[i] + phase[i]).sin;
  return ahead;
}

namespace {

/// The way of one gear, place by place: where it turns back.
class TurnFinder {
 public:
  explicit TurnFinder(double dead_zone) : dead_zone_(dead_zone) {}

  /// Goes on from `position` as if it had always gone in `direction` (−1 or +1; 0: not known).
  void Begin(size_t place, double position, int direction) {
    low_ = high_ = position;
    low_at_ = high_at_ = place;
    direction_ = direction;
  }
  /// The place at which it turned back, where that shows now.
  std::optional<size_t> Next(size_t place, double position) {
    std::optional<size_t> turned;
    const auto turn = [&](int direction, size_t at) {
      if (direction_ != 0) turned = at;
      Begin(place, position, direction);
    };
    if (direction_ >= 0 && high_ - position > dead_zone_)
      turn(-1, high_at_);
    else if (direction_ <= 0 && position - low_ > dead_zone_)
      turn(1, low_at_);
    if (position > high_) high_ = position, high_at_ = place;
    if (position < low_) low_ = position, low_at_ = place;
    return turned;
  }
  int direction() const { return direction_; }

 private:
  double dead_zone_;
  int direction_ = 0;
  double low_ = 0, high_ = 0;
  size_t low_at_ = 0, high_at_ = 0;
};

int FirstDirection(double dead_zone, std::span<const GearPlace> way, Eigen::Index gear) {
  TurnFinder finder(dead_zone);
  for (size_t t = 0; t < way.size() && finder.direction() == 0; ++t)
    if (t == 0)
      finder.Begin(t, way[t].at[gear], 0);
    else
      finder.Next(t, way[t].at[gear]);
  return finder.direction();
}

/// Where the output of one gear goes over: like its turns, but that a load that beats friction says alone on
/// which flank it rests.
class CrossingFinder {
 public:
  /// `first`: the direction of the first move, as in GearFlanks.
  CrossingFinder(double dead_zone, double friction, int first)
      : turns_(dead_zone), friction_(friction), first_(first < 0 ? -1 : 1) {}

  std::optional<size_t> Next(size_t place, double position, double load) {
    const int pressed = std::abs(load) > friction_ ? (load > 0 ? 1 : -1) : 0;
    // An output that is behind its input, on flank −1, is where going on in + had left it.
    if (place == 0) {
      turns_.Begin(place, position, pressed == 0 ? first_ : -pressed);
      return std::nullopt;
    }
    if (pressed == 0) return turns_.Next(place, position);
    const bool over = turns_.direction() == pressed;
    turns_.Begin(place, position, -pressed);
    return over ? std::optional(place) : std::nullopt;
  }

 private:
  TurnFinder turns_;
  double friction_;
  int first_;
};

void AddEvents(const LostMotion& lost, std::span<const GearPlace> way, Eigen::Index gear,
               std::vector<GearEvent>& events) {
  TurnFinder turns(lost.dead_zone[gear]);
  CrossingFinder crossings(lost.dead_zone[gear], lost.friction[gear],
                           FirstDirection(lost.dead_zone[gear], way, gear));
  std::vector<size_t> turned, crossed;
  for (size_t t = 0; t < way.size(); ++t) {
    if (t == 0) turns.Begin(t, way[t].at[gear], 0);
    const auto turn = t == 0 ? std::nullopt : turns.Next(t, way[t].at[gear]);
    if (turn) turned.push_back(*turn);
    const auto cross = crossings.Next(t, way[t].at[gear], way[t].load[gear]);
    if (cross) crossed.push_back(*cross);
  }
  const auto has = [](const std::vector<size_t>& places, size_t place) {
    return std::ranges::find(places, place) != places.end();
  };
  for (const size_t place : turned)
    events.push_back({static_cast<int>(gear), place, true, has(crossed, place)});
  for (const size_t place : crossed)
    if (!has(turned, place)) events.push_back({static_cast<int>(gear), place, false, true});
}

}  // namespace

GearValues AtGears(const LostMotion& lost, const Joints& q, const ExternalPosition& external) {
  GearValues at = GearValues::Zero();
  at.head<6>() = lost.gears * q;
  for (size_t i = 0; i < external.size(); ++i) at[6 + static_cast<Eigen::Index>(i)] = external[i];
  return at;
}

GearValues GearLevers(const LostMotion& lost, const Joints& by_joint,
                      const std::vector<double>& by_external) {
  GearValues levers = GearLoads(lost, by_joint);  // both by the transpose
  for (size_t i = 0; i < by_external.size(); ++i) levers[6 + static_cast<Eigen::Index>(i)] = by_external[i];
  return levers;
}

GearValues GearLoads(const LostMotion& lost, const Joints& about_axes) {
  GearValues loads = GearValues::Zero();
  loads.head<6>() = lost.axes.transpose() * about_axes;
  return loads;
}

GearFlanks::GearFlanks(const LostMotion& lost, const GearValues& first_move, const GearValues& load)
    : half_(0.5 * lost.width), friction_(lost.friction) {
  offset_ = (first_move.array() < 0).select(half_, -half_);
  Press(load);
}

void GearFlanks::Move(const GearValues& move, const GearValues& load) {
  offset_ = (offset_ - move).cwiseMax(-half_).cwiseMin(half_);
  Press(load);
}

void GearFlanks::Press(const GearValues& load) {
  for (Eigen::Index i = 0; i < kMostGears; ++i)
    if (std::abs(load[i]) > friction_[i]) offset_[i] = load[i] > 0 ? half_[i] : -half_[i];
}

GearValues FirstMove(const LostMotion& lost, std::span<const GearPlace> way) {
  GearValues first;
  for (Eigen::Index i = 0; i < kMostGears; ++i) first[i] = FirstDirection(lost.dead_zone[i], way, i);
  return first;
}

std::vector<GearValues> OffsetsAlong(const LostMotion& lost, std::span<const GearPlace> way) {
  std::vector<GearValues> offsets;
  if (way.empty()) return offsets;
  GearFlanks flanks(lost, FirstMove(lost, way), way[0].load);
  offsets.push_back(flanks.offset());
  for (size_t t = 1; t < way.size(); ++t) {
    flanks.Move(way[t].at - way[t - 1].at, way[t].load);
    offsets.push_back(flanks.offset());
  }
  return offsets;
}

std::vector<GearEvent> GearEvents(const LostMotion& lost, std::span<const GearPlace> way) {
  std::vector<GearEvent> events;
  for (Eigen::Index i = 0; i < kMostGears; ++i) AddEvents(lost, way, i, events);
  std::ranges::stable_sort(events, {},
                           [](const GearEvent& event) { return std::tuple(event.place, event.gear); });
  return events;
}

}  // namespace millpose
