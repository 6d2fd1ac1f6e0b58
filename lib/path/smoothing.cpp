// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/smoothing.hpp"

#include <limits>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "path/box_step.hpp"

namespace millpose {
namespace {

/// What is looked at to either side of a value: for derivatives, and for how far it may go.
constexpr double kNear = 0.03 * kRadPerDeg, kFarther = 8 * kNear, kFar = 64 * kNear;
constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-8, kMostDamping = 1e2;
constexpr double kSamePlace = 1e-9;  // mm
constexpr int kMostSteps = 15;       // for one weight of the objective
constexpr int kBisections = 3;       // of that weight
constexpr double kConverged = 3e-3;  // relative
constexpr double kLeastLoss = 1e-3;  // the scale of the objective when less than this may be lost
/// Bounds are aimed at with this reserve, and their violation weighs as much against smoothness.
constexpr double kReserve = 0.95, kStepReserve = 0.97, kViolationWeight = 100;

/// The joint accelerations at one point: left·(q_m − q_{m−1}) + right·(q_{m+1} − q_m), and its share of time.
struct AccelerationRow {
  size_t before, middle, after;
  double left, right, share;
};

/// A point where it stands, and what is known around it.
struct Place {
  double x = 0;  ///< the first freedom
  Joints q = Joints::Zero();
  double objective = 0;
  Joints turn = Joints::Zero();     ///< dq/dx
  double slope = 0, curvature = 0;  ///< of the objective; never curved downwards
  double lower = 0, upper = 0;      ///< how far x may move: admissible as far as it was looked at
};

/// What a course is judged by.
struct Merit {
  double square = 0;     ///< mean square of the joint accelerations, rad²/s⁴
  double objective = 0;  ///< summed
  double violation = 0;  ///< of the bounds between points, with reserve; relative squares
  bool within = true;    ///< the bound of the deviation itself is kept
  bool steps = true;     ///< the bounds of the joint steps are kept
};

class Smoother {
 public:
  Smoother(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
           std::span<const FreedomRange> ranges, const SmoothOptions& options, std::span<PathNode> path)
      : scorers_(scorers),
        points_(points),
        ranges_(ranges),
        options_(options),
        path_(path),
        problem_(scorers[0].problem()),
        edges_(options.closed ? path.size() : path.size() - 1) {
    MakeRows();
  }

  void Run() {
    const std::vector<Place> start = Probed(Values(), Start());
    limits_.assign(edges_, options_.max_deviation);
    Smooth(start);
    // Where mending the deviations costs too much, or cannot be done, they only may not grow.
    if (!start_.within && !(best_.within && Affordable(best_))) {
      for (size_t t = 0; t < edges_; ++t) {
        const double off = Deviation(t, start[t].q, Step(start[t], start[Next(t)])).norm();
        limits_[t] = std::max(options_.max_deviation, off / kReserve);
      }
      Smooth(start);
    }
    for (size_t t = 0; t < path_.size(); ++t) {
      path_[t].freedoms[0] = best_places_[t].x;
      path_[t].q = best_places_[t].q;
      path_[t].objective = best_places_[t].objective;
    }
  }

 private:
  void Smooth(const std::vector<Place>& start) {
    places_ = best_places_ = start;
    start_ = best_ = Judge(places_);
    damping_ = kFirstDamping;
    if (start_.square <= 0) return;
    // Ever more of the objective is given for smoothness, until the loss allowed is used up.
    double enough = 128, too_little = 0;
    for (double weight = 8; weight > 1e-3; weight /= 4) {
      if (Minimise(weight)) {
        enough = weight;
      } else {
        too_little = weight;
        break;
      }
    }
    for (int i = 0; i < kBisections && too_little > 0; ++i) {
      places_ = best_places_;
      const double weight = std::sqrt(enough * too_little);
      (Minimise(weight) ? enough : too_little) = weight;
    }
  }

  bool Affordable(const Merit& merit) const {
    return merit.objective <= (1 + options_.loss) * options_.objective;
  }

  std::vector<double> Values() const {
    std::vector<double> values;
    for (const PathNode& node : path_) values.push_back(node.freedoms[0]);
    return values;
  }
  std::vector<Place> Start() const {
    std::vector<Place> places(path_.size());
    for (size_t t = 0; t < path_.size(); ++t) {
      places[t].x = path_[t].freedoms[0], places[t].q = path_[t].q;
      places[t].objective = path_[t].objective;
    }
    return places;
  }

  size_t Next(size_t t) const { return t + 1 == path_.size() ? 0 : t + 1; }
  size_t Before(size_t t) const { return t == 0 ? path_.size() - 1 : t - 1; }
  double Way(size_t t) const {  // mm, from t to the next
    const size_t next = Next(t);
    return next ? points_[next].arc_length - points_[t].arc_length
                : (points_[0].position - points_[t].position).norm();
  }

  /// As RatesAlong: the parabola through a point and its neighbours; at open ends the neighbour's.
  void MakeRows() {
    const size_t count = path_.size();
    if (count < 3) return;
    double time = 0;
    for (size_t t = 0; t < count; ++t) {
      const size_t middle = options_.closed ? t : std::clamp<size_t>(t, 1, count - 2);
      const size_t before = Before(middle), after = Next(middle);
      const double h0 = Way(before), h1 = Way(middle);
      if (h0 < kSamePlace || h1 < kSamePlace) continue;
      const bool first = t == 0 && !options_.closed, last = t + 1 == count && !options_.closed;
      const double away = first ? -h0 : last ? h1 : 0, half = first ? h0 / 2 : last ? h1 / 2 : (h0 + h1) / 2;
      const double feed = points_[t].feed_rate;
      const double v0 = points_[first ? t : Before(t)].feed_rate, v1 = points_[last ? t : Next(t)].feed_rate;
      const double tangential = (v1 * v1 - v0 * v0) / (4 * half);
      const double curve = feed * feed + tangential * away, sum = h0 + h1;
      rows_.push_back({before, middle, after, (-2 * curve + tangential * h1) / (h0 * sum),
                       (2 * curve + tangential * h0) / (h1 * sum), half / feed});
      time += half / feed;
    }
    for (AccelerationRow& row : rows_) row.share /= time;
  }

  /// The points at the values `x`. One that is not admissible there stays as it is in `from`.
  std::vector<Place> Probed(const std::vector<double>& x, std::vector<Place> from) const {
    for (size_t t = 0; t < x.size(); ++t) {
      if (ranges_[t].lower == ranges_[t].upper) continue;  // stays where it is
      if (!Probe(t, x[t], from[t])) Probe(t, from[t].x, from[t]);
    }
    return from;
  }

  bool Probe(size_t t, double x, Place& place) const {
    constexpr std::array<double, kLanes> offsets{0, kNear, -kNear, kFarther, -kFarther, kFar, -kFar, 0};
    const size_t dimensions = path_[t].freedoms.size();
    std::vector<double> lanes(kLanes * dimensions);
    for (size_t l = 0; l < kLanes; ++l) {
      std::copy(path_[t].freedoms.begin(), path_[t].freedoms.end(), lanes.begin() + l * dimensions);
      lanes[l * dimensions] = x + offsets[l];
    }
    const int branch = path_[t].branch;
    ScoredBlock block;
    scorers_[t].ScoreBlock(lanes, 1u << (branch & 3), block);
    std::array<Candidate, kLanes> at;
    std::array<bool, kLanes> good;
    for (size_t l = 0; l < kLanes; ++l) {
      at[l] = CandidateOf(block, branch, static_cast<int>(l));
      for (int j = 0; j < 6; ++j) {
        at[l].q[j] += 2 * kPi * std::round((place.q[j] - at[l].q[j]) / (2 * kPi));
      }
      // The point itself was admitted before; turned back, its angles may differ by rounding.
      good[l] = at[l].admissibility == Admissibility::kAdmissible && InRange(t, x + offsets[l]) &&
                (at[l].q.array() >= problem_.bounds.lower.array() - kRounding).all() &&
                (at[l].q.array() <= problem_.bounds.upper.array() + kRounding).all();
    }
    const bool stays = x == place.x;
    if (!good[0] && !stays) return false;
    if (!stays) place.x = x, place.q = at[0].q, place.objective = at[0].objective;
    Derive(place, at, good);
    return true;
  }

  bool InRange(size_t t, double x) const { return x >= ranges_[t].lower && x <= ranges_[t].upper; }

  void Derive(Place& place, const std::array<Candidate, kLanes>& at,
              const std::array<bool, kLanes>& good) const {
    place.upper = !good[1] ? 0 : !good[3] ? kNear : !good[5] ? kFarther : kFar;
    place.lower = !good[2] ? 0 : !good[4] ? -kNear : !good[6] ? -kFarther : -kFar;
    place.turn = Joints::Zero();
    place.slope = place.curvature = 0;
    if (!good[1] && !good[2]) return;
    const Joints up = good[1] ? at[1].q : place.q, down = good[2] ? at[2].q : place.q;
    const double f_up = good[1] ? at[1].objective : place.objective,
                 f_down = good[2] ? at[2].objective : place.objective;
    const double width = kNear * (good[1] + good[2]);
    place.turn = (up - down) / width;
    place.slope = (f_up - f_down) / width;
    if (good[1] && good[2]) {
      place.curvature = std::max(0.0, (f_up - 2 * place.objective + f_down) / (kNear * kNear));
    }
  }

  static Joints Step(const Place& from, const Place& to) { return (to.q - from.q).unaryExpr(&ShortWay); }

  /// Tip half-way of the joint motion less that of the straight line; in B, mm.
  Eigen::Vector3d Deviation(size_t t, const Joints& from, const Joints& step) const {
    const Eigen::Vector3d middle = 0.5 * (points_[t].position + points_[Next(t)].position);
    const Pose X_BF = ForwardFlange(problem_.arm, from + 0.5 * step);
    return X_BF * problem_.X_FT.translation() - problem_.X_WB.inverse(Eigen::Isometry) * middle;
  }

  Merit Judge(const std::vector<Place>& places) const {
    Merit merit;
    for (const AccelerationRow& row : rows_)
      merit.square += row.share * Acceleration(places, row).squaredNorm();
    for (const Place& place : places) merit.objective += place.objective;
    for (size_t t = 0; t < edges_; ++t) {
      const Joints step = Step(places[t], places[Next(t)]);
      const double off = Deviation(t, places[t].q, step).norm() / limits_[t];
      const double beyond = std::max(0.0, off - kReserve);
      merit.violation += beyond * beyond;
      merit.within = merit.within && off <= 1;
      for (int j = 0; j < 6; ++j) {
        const double share = std::abs(step[j]) / options_.max_step[j],
                     over = std::max(0.0, share - kStepReserve);
        merit.violation += over * over;
        merit.steps = merit.steps && share <= 1 + kRounding;
      }
    }
    return merit;
  }

  Joints Acceleration(const std::vector<Place>& places, const AccelerationRow& row) const {
    return row.left * Step(places[row.before], places[row.middle]) +
           row.right * Step(places[row.middle], places[row.after]);
  }

  double Total(const Merit& merit, double weight) const {
    return merit.square / start_.square + weight * PerObjective() * (merit.objective - start_.objective) +
           kViolationWeight * merit.violation;
  }

  /// Turns objective into shares of what may be lost.
  double PerObjective() const { return 1 / (std::max(options_.loss, kLeastLoss) * options_.objective); }

  /// Gauss-Newton steps towards the least total. False when the answer loses more than it may.
  bool Minimise(double weight) {
    Merit merit = Judge(places_);
    for (int step = 0; step < kMostSteps && damping_ <= kMostDamping; ++step) {
      CheckStop(options_.stop);
      const double before = Total(merit, weight);
      const std::vector<double> delta = StepFrom(places_, weight);
      std::vector<double> x;
      for (size_t t = 0; t < delta.size(); ++t) x.push_back(places_[t].x + delta[t]);
      std::vector<Place> trial = Probed(x, places_);
      const Merit reached = Judge(trial);
      const double gain = before - Total(reached, weight);
      if (!(gain > 0)) {
        damping_ *= 10;
        continue;
      }
      places_ = std::move(trial);
      merit = reached;
      damping_ = std::max(damping_ / 4, kLeastDamping);
      if (gain < kConverged * std::abs(before)) break;
    }
    damping_ = std::min(damping_, kFirstDamping);
    const bool affordable = Affordable(merit);
    if (Better(merit, affordable)) best_ = merit, best_places_ = places_;
    return affordable;
  }

  /// Bounds between points go first, then what may be lost, then smoothness.
  bool Better(const Merit& merit, bool affordable) const {
    if (!merit.steps) return false;
    if (merit.within != best_.within) return merit.within;
    if (!merit.within && merit.violation < best_.violation) return true;
    return affordable && merit.square < best_.square && merit.violation <= std::max(best_.violation, 1e-6);
  }

  std::vector<double> StepFrom(const std::vector<Place>& places, double weight) const {
    BoxLeastSquares squares(places.size());
    for (const AccelerationRow& row : rows_) {
      const Joints acceleration = Acceleration(places, row);
      const double share = row.share / start_.square;
      for (int j = 0; j < 6; ++j) {
        squares.Add<3>(share, acceleration[j],
                       {{{row.before, -row.left * places[row.before].turn[j]},
                         {row.middle, (row.left - row.right) * places[row.middle].turn[j]},
                         {row.after, row.right * places[row.after].turn[j]}}});
      }
    }
    const double per_objective = weight * PerObjective();
    for (size_t t = 0; t < places.size(); ++t) {
      squares.AddCurve(t, per_objective * places[t].slope, per_objective * places[t].curvature);
    }
    for (size_t t = 0; t < edges_; ++t) AddViolations(places, t, squares);
    std::vector<double> lower, upper;
    for (const Place& place : places) lower.push_back(place.lower), upper.push_back(place.upper);
    return squares.Solve(lower, upper, damping_);
  }

  void AddViolations(const std::vector<Place>& places, size_t t, BoxLeastSquares& squares) const {
    const size_t next = Next(t);
    const Joints step = Step(places[t], places[next]);
    const Eigen::Vector3d off = Deviation(t, places[t].q, step) / limits_[t];
    if (const double size = off.norm(); size > kReserve) {
      // The deviation's own derivatives, along its present direction.
      constexpr double kSmall = 1e-6;
      const Eigen::Vector3d along = off / (size * limits_[t] * kSmall);
      const auto derivative = [&](double first, double second) {
        const Joints from = places[t].q + first * places[t].turn;
        const Joints moved = step + second * places[next].turn - first * places[t].turn;
        return along.dot(Deviation(t, from, moved) - off * limits_[t]);
      };
      squares.Add<2>(kViolationWeight, size - kReserve,
                     {{{t, derivative(kSmall, 0)}, {next, derivative(0, kSmall)}}});
    }
    for (int j = 0; j < 6; ++j) {
      const double share = step[j] / options_.max_step[j];
      if (std::abs(share) <= kStepReserve) continue;
      const double sign = share > 0 ? 1 : -1, scale = sign / options_.max_step[j];
      squares.Add<2>(kViolationWeight, std::abs(share) - kStepReserve,
                     {{{t, -scale * places[t].turn[j]}, {next, scale * places[next].turn[j]}}});
    }
  }

  static constexpr double kRounding = 1e-12;  // rad: of angles that full turns were added to

  std::span<const PointScorer> scorers_;
  std::span<const MillingPoint> points_;
  std::span<const FreedomRange> ranges_;
  const SmoothOptions& options_;
  std::span<PathNode> path_;
  const PoseProblem& problem_;
  size_t edges_;
  std::vector<AccelerationRow> rows_;
  std::vector<double> limits_;  // mm, of the deviation of each motion
  double damping_ = kFirstDamping;
  std::vector<Place> places_, best_places_;
  Merit start_, best_;
};

}  // namespace

void SmoothPath(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                std::span<const FreedomRange> ranges, const SmoothOptions& options,
                std::span<PathNode> path) {
  assert(scorers.size() == path.size() && points.size() == path.size() && ranges.size() == path.size());
  if (path.size() < 3) return;
  Smoother(scorers, points, ranges, options, path).Run();
}

}  // namespace millpose
