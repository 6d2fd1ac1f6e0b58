// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_track.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/trig.hpp"
#include "geometry/mesh/triangle.hpp"
#include "toolpath/strategies/trim_distance.hpp"
#include "toolpath/strategies/trim_points.hpp"

namespace millpose {
namespace {

constexpr double kOver = 2;          // mm over the surface, where entries begin and ways back run
constexpr double kLeadTouch = 1e-3;  // mm by which leads may come nearer to the contour
constexpr double kNearStop = 0.1;    // mm: a bend of the way nearer to a stop may go

// The path by its length, in the direction of milling.
class Track {
 public:
  Track(OffsetPath path, bool reversed) : path_(std::move(path)) {
    if (reversed) std::ranges::reverse(path_.nodes);
    for (size_t i = 0; i < path_.Segments(); ++i)
      begin_.push_back(begin_.back() + (path_.To(i).place - path_.From(i).place).norm());
  }

  double length() const { return begin_.back(); }
  bool closed() const { return path_.closed; }
  const std::vector<double>& begins() const { return begin_; }

  size_t SegmentAt(double s) const {
    const auto after = std::upper_bound(begin_.begin(), begin_.end(), s);
    const auto segment = after - begin_.begin() - 1;
    return std::min(static_cast<size_t>(std::max<std::ptrdiff_t>(segment, 0)), path_.Segments() - 1);
  }

  OffsetNode At(double s) const {
    const size_t i = SegmentAt(s);
    const double share = std::clamp((s - begin_[i]) / (begin_[i + 1] - begin_[i]), 0.0, 1.0);
    const OffsetNode &a = path_.From(i), &b = path_.To(i);
    return {a.place + share * (b.place - a.place), (a.axis + share * (b.axis - a.axis)).normalized()};
  }

  Eigen::Vector3d Along(double s) const {
    const size_t i = SegmentAt(s);
    return (path_.To(i).place - path_.From(i).place).normalized();
  }

  /// By how much the direction changes at a node, as a share of its length.
  double Bend(double s) const {
    const double before = s - 1e-6 < 0 && closed() ? s - 1e-6 + length() : s - 1e-6;
    const double after = s + 1e-6 > length() && closed() ? s + 1e-6 - length() : s + 1e-6;
    return (Along(after) - Along(before)).norm();
  }

  double Nearest(const Eigen::Vector3d& p) const {
    double best = std::numeric_limits<double>::infinity(), found = 0;
    for (size_t i = 0; i < path_.Segments(); ++i) {
      const Eigen::Vector3d &a = path_.From(i).place, &b = path_.To(i).place;
      const double t = ClosestOnSegment(p, a, b), distance = (a + t * (b - a) - p).norm();
      if (distance < best) best = distance, found = begin_[i] + t * (b - a).norm();
    }
    return found;
  }

 private:
  OffsetPath path_;
  std::vector<double> begin_{0};
};

// Depth over the way where tabs are left standing.
class Tabs {
 public:
  Tabs(const Trim& trim, double cutter_radius, double depth, const Track& track, double start)
      : slope_(SinCos(trim.ramp).sin / SinCos(trim.ramp).cos) {
    if (!trim.tabs) return;
    top_ = trim.through - trim.tabs->height;
    half_ = trim.tabs->width / 2 + cutter_radius;
    const double length = track.length();
    if (trim.tabs->count)
      for (int i = 0; i < *trim.tabs->count; ++i) middles_.push_back(length * (i + 0.5) / *trim.tabs->count);
    for (const Eigen::Vector3d& place : trim.tabs->places) {
      const double middle = track.Nearest(place) - start;
      middles_.push_back(track.closed() && middle < 0 ? middle + length : middle);
    }
    std::ranges::sort(middles_);
    const double reach = half_ + (depth - top_) / slope_, overlap = track.closed() ? trim.overlap : 0;
    for (size_t i = 0; i < middles_.size(); ++i) {
      const double from = i == 0 ? overlap : middles_[i - 1] + reach;
      const double to = i + 1 == middles_.size() ? length : length + reach;  // the next looks back itself
      if (middles_[i] - reach < from || middles_[i] + reach > to)
        throw InputError(
            {}, fmt::format("toolpath.trim.tabs: tab {} has no room: with the cutter's diameter and ramps "
                            "of {:.6g}° each takes {:.1f} mm of the way, which is {:.1f} mm long and begins "
                            "at the lead-in; give fewer, a steeper ramp_deg or another start_mm",
                            i + 1, RadToDeg(trim.ramp), 2 * reach, length));
    }
  }

  /// mm under the surface where `depth` is asked for.
  double Depth(double s, double depth) const {
    for (const double middle : middles_)
      depth = std::min(depth, std::max(top_, top_ + (std::abs(s - middle) - half_) * slope_));
    return depth;
  }

  /// Where the depth's slope changes.
  void AddBends(double depth, std::vector<double>& places) const {
    if (depth <= top_) return;
    const double reach = half_ + (depth - top_) / slope_;
    for (const double middle : middles_)
      places.insert(places.end(), {middle - reach, middle - half_, middle + half_, middle + reach});
  }

 private:
  std::vector<double> middles_;
  double top_ = 0, half_ = 0, slope_;
};

class TrackMaker {
 public:
  TrackMaker(const Trim& trim, const ToolpathOptions& options, const Contour& contour, const OffsetPath& path)
      : trim_(trim),
        options_(options),
        track_(path, !trim.climb),
        distance_(options.cutter.radius + trim.allowance),
        radius_(trim.LeadRadius(options.cutter.radius)),
        near_(contour, 3 * (distance_ + radius_)),
        plunge_(options.plunge_feed > 0 ? std::min(options.plunge_feed, options.feed_rate)
                                        : options.feed_rate),
        retract_(options.retract_feed > 0 ? options.retract_feed : options.feed_rate),
        slope_(SinCos(trim.ramp).sin / SinCos(trim.ramp).cos),
        total_(trim.through + trim.overcut),
        rounds_(std::max(1, static_cast<int>(std::ceil(total_ / trim.per_depth.value_or(total_) - 1e-9)))),
        start_(track_.closed() ? Start() : 0),
        tabs_(trim, options.cutter.radius, total_, track_, start_) {
    const double around = trim.entry == TrimEntry::kHelix ? 3 * kQuarter : 0;
    if (!track_.closed() && !(LeadFits(0, -kQuarter, around) && LeadFits(track_.length(), 0, kQuarter)))
      throw InputError(
          {}, fmt::format("toolpath.trim.lead_radius_mm: leads of {:.6g} mm have no room at the ends "
                          "of the stretch",
                          radius_));
  }

  std::vector<TrimStop> Make() {
    double done = -kOver;
    for (int round = 1; round <= rounds_; ++round) {
      const double depth = total_ * round / rounds_;
      AddEntry(done, depth, round == 1);
      AddArc(start_, -kQuarter, 0, depth, depth, round == 1 ? plunge_ : options_.feed_rate);
      if (round == 1) lead_in_ = way_.size() - 1;
      AddRound(depth);
      const double end = track_.closed() ? start_ + trim_.overlap : track_.length();
      lead_out_ = way_.size();
      AddArc(end, 0, kQuarter, depth, depth, options_.feed_rate);
      if (round < rounds_) AddReturn(depth);
      done = depth;
    }
    return std::move(way_);
  }

  /// The way's stops up to this one are the lead-in, those from the other on the lead-out.
  size_t lead_in() const { return lead_in_; }
  size_t lead_out() const { return lead_out_; }

 private:
  static constexpr double kQuarter = kPi / 2;

  // Where leads touch the way: on its waste side, from behind (−90°) over the place itself (0) to ahead
  // (90°).
  OffsetNode OnLead(double s, double angle) const {
    const OffsetNode node = track_.At(Wrapped(s));
    const Eigen::Vector3d along = track_.Along(Wrapped(s)), aside = Aside(node.axis, along);
    const Eigen::Vector3d ahead = trim_.climb ? aside.cross(node.axis) : node.axis.cross(aside);
    const SineCosine at = SinCos(angle);
    return {node.place + radius_ * ((1 - at.cos) * aside + at.sin * ahead), node.axis};
  }

  // Across the way, away from the part.
  Eigen::Vector3d Aside(const Eigen::Vector3d& axis, const Eigen::Vector3d& along) const {
    return (trim_.climb ? axis.cross(along) : along.cross(axis)).normalized();
  }

  double Wrapped(double s) const { return track_.closed() && s > track_.length() ? s - track_.length() : s; }

  bool LeadFits(double s, double from, double to) const {
    constexpr int kSteps = 48;
    for (int i = 0; i <= kSteps; ++i) {
      const OffsetNode node = OnLead(s, from + (to - from) * i / kSteps);
      if (near_.At(node.place, node.axis) < distance_ - kLeadTouch) return false;
    }
    return true;
  }

  bool Fits(double s) const {
    return LeadFits(s, -kQuarter, 3 * kQuarter) &&
           LeadFits(s + trim_.overlap, 0, rounds_ > 1 ? 2 * kQuarter : kQuarter);
  }

  // As asked for, or the middle of the longest straight that has room, or any place that has.
  double Start() const {
    constexpr int kPlaces = 200;
    if (trim_.start) {
      const double s = track_.Nearest(*trim_.start);
      if (Fits(s)) return s;
      throw InputError(
          {}, fmt::format("toolpath.trim.start_mm: leads of {:.6g} mm have no room there; give another "
                          "place or a smaller lead_radius_mm",
                          radius_));
    }
    std::vector<std::pair<double, double>> straights;  // length, middle
    for (size_t i = 0; i + 1 < track_.begins().size(); ++i)
      straights.emplace_back(track_.begins()[i + 1] - track_.begins()[i],
                             (track_.begins()[i + 1] + track_.begins()[i]) / 2);
    std::ranges::stable_sort(straights, std::greater(), &std::pair<double, double>::first);
    straights.resize(std::min<size_t>(straights.size(), 20));
    for (int i = 0; i < kPlaces; ++i) straights.emplace_back(0, track_.length() * (i + 0.37) / kPlaces);
    for (const auto& [length, s] : straights)
      if (Fits(s)) return s;
    throw InputError(
        {}, fmt::format("toolpath.trim.lead_radius_mm: leads of {:.6g} mm have no room anywhere along "
                        "the contour; give a smaller one",
                        radius_));
  }

  void Add(const OffsetNode& node, double depth, double feed, bool back = false) {
    way_.push_back({node, depth, feed, back});
  }

  void AddArc(double s, double from, double to, double depth0, double depth1, double feed) {
    const double widest = std::min(kPi / 6, 2 * std::sqrt(2 * options_.chord_tolerance / radius_));
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from) / widest - 1e-9)));
    for (int i = 1; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      Add(OnLead(s, i == steps ? to : from + (to - from) * share), depth0 + (depth1 - depth0) * share, feed);
    }
  }

  // Down to a round's depth at the lead-in's beginning, in whole turns through what is cut there already.
  void AddEntry(double done, double depth, bool first) {
    const OffsetNode begin = OnLead(start_, -kQuarter);
    if (first) Add(begin, -kOver, plunge_);
    if (trim_.entry == TrimEntry::kPlunge) return Add(begin, depth, plunge_);
    const double drop = 2 * kPi * radius_ * slope_;  // of a turn at most
    // On the way back over the part the lead's circle was left sloping by as much; else it is level.
    const double from = first ? -kOver : track_.closed() ? done : std::max(-kOver, done - drop);
    if (!first && !track_.closed()) Add(begin, from, retract_);
    const double turns = std::max(1.0, std::ceil((depth - from) / drop - 1e-9));
    AddArc(start_, -kQuarter - 2 * kPi * turns, -kQuarter, from, depth, plunge_);
  }

  // Once round, or along the stretch.
  void AddRound(double depth) {
    const double length = track_.length(), end = track_.closed() ? length + trim_.overlap : length;
    std::vector<double> places{0, end};  // from the start
    tabs_.AddBends(depth, places);
    AddBends(end, places);
    double before = 0;
    for (const double s : places) {
      if (s <= before + 1e-6 || s > end) continue;
      double on = start_ + s;
      while (track_.closed() && on > length) on -= length;
      Add(track_.At(on), tabs_.Depth(s > length ? s - length : s, depth), options_.feed_rate);
      before = s;
    }
  }

  // The way's own bends up to `end`, but those so close to a place that is there already that the way keeps
  // its tolerance without them.
  void AddBends(double end, std::vector<double>& places) const {
    std::ranges::sort(places);
    const std::vector<double> given = places;
    const double length = track_.length();
    for (const double begin : track_.begins())
      for (const double s : {begin - start_, begin - start_ + length}) {
        if (s <= 1e-9 || s >= end) continue;
        const auto after = std::ranges::lower_bound(given, s);
        const double gap = std::min(after == given.end() ? kNearStop : *after - s,
                                    after == given.begin() ? kNearStop : s - *std::prev(after));
        if (gap >= kNearStop || gap * track_.Bend(Wrapped(s + start_)) > options_.chord_tolerance)
          places.push_back(s);
      }
    std::ranges::sort(places);
  }

  // To where the next round's entry begins.
  void AddReturn(double depth) {
    if (track_.closed()) {  // on along the lead-out's circle, back beside the way, and along the lead-in's
      AddArc(start_ + trim_.overlap, kQuarter, 2 * kQuarter, depth, depth, options_.feed_rate);
      if (trim_.overlap > kNearStop) Add(OnLead(start_, 2 * kQuarter), depth, options_.feed_rate);
      AddArc(start_, 2 * kQuarter, 3 * kQuarter, depth, depth, options_.feed_rate);
      return;
    }
    Add(OnLead(track_.length(), kQuarter), -kOver, retract_);
    for (auto begin = track_.begins().rbegin(); begin != track_.begins().rend(); ++begin)
      Add(track_.At(*begin), -kOver, retract_, true);
    Add(OnLead(0, -kQuarter), -kOver, retract_, true);
  }

  const Trim& trim_;
  const ToolpathOptions& options_;
  Track track_;
  double distance_, radius_;
  ContourDistance near_;
  double plunge_, retract_;
  double slope_;  // of helices
  double total_;
  int rounds_;
  double start_;
  Tabs tabs_;
  std::vector<TrimStop> way_;
  size_t lead_in_ = 0, lead_out_ = 0;
};

}  // namespace

Pass TrimPass(const Trim& trim, const ToolpathOptions& options, const Contour& contour,
              const OffsetPath& path) {
  TrackMaker maker(trim, options, contour, path);
  TrimStops way{maker.Make(), maker.lead_in(), maker.lead_out()};
  return PointsAlong(trim, options, way);
}

}  // namespace millpose
