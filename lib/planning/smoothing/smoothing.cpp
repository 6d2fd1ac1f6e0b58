// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/smoothing/smoothing.hpp"

#include "base/parallel.hpp"

namespace millpose {
namespace {

constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-8, kMostDamping = 1e2;
constexpr int kMostSteps = 15;       // for one weight of the objective
constexpr int kBisections = 3;       // of that weight
constexpr double kConverged = 3e-3;  // relative
constexpr double kLeastLoss = 1e-3;  // the scale of the objective when less than this may be lost
constexpr double kViolationWeight = 100;
constexpr double kGrowth = 1 / 0.95;  // room for deviations that cannot be repaired

class Smoother {
 public:
  Smoother(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
           std::span<const FreedomRange> ranges, const SmoothOptions& options, std::span<PathNode> path)
      : ranges_(ranges),
        options_(options),
        path_(path),
        course_(scorers, points, path, options.closed,
                {options.max_step, options.max_lean, options.freedom, options.middles}) {}

  Smoothed Run() {
    const std::vector<CoursePlace> start = course_.Start(ranges_);
    bool repaired = options_.repair;
    if (repaired) {
      course_.set_limits(DeviationLimits(options_));
      Smooth(start);
      repaired = best_.within && Affordable(best_);
    }
    if (!repaired) {
      SmoothOptions as_before = options_;
      as_before.repair = false;
      course_.set_limits(DeviationLimits(as_before));
      Smooth(start);
    }
    for (size_t t = 0; t < path_.size(); ++t) {
      path_[t].freedoms[options_.freedom] = best_places_[t].x;
      path_[t].q = best_places_[t].q;
      path_[t].objective = best_places_[t].objective;
    }
    return {repaired, best_weight_};
  }

 private:
  void Smooth(const std::vector<CoursePlace>& start) {
    places_ = start;
    best_ = merit_ = course_.Judge(places_);
    best_places_ = places_;
    best_weight_ = 0;
    damping_ = kFirstDamping;
    if (options_.before.square <= 0) return;
    if (options_.weight > 0) {
      Minimise(options_.weight);
      return;
    }
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
      places_ = best_places_, merit_ = best_;
      const double weight = std::sqrt(enough * too_little);
      (Minimise(weight) ? enough : too_little) = weight;
    }
  }

  bool Affordable(const Merit& merit) const {
    return merit.objective <= (1 + options_.loss) * options_.before.objective;
  }

  double Total(const Merit& merit, double weight) const {
    return merit.square / options_.before.square +
           weight * PerObjective() * (merit.objective - options_.before.objective) +
           kViolationWeight * merit.violation;
  }

  /// Turns objective into shares of what may be lost.
  double PerObjective() const {
    if (options_.before.objective <= 0) return 0;  // in air: no pose is better than another
    return 1 / (std::max(options_.loss, kLeastLoss) * options_.before.objective);
  }

  /// Gauss-Newton steps towards the least total. False when the answer loses more than it may.
  bool Minimise(double weight) {
    std::optional<BoxLeastSquares> squares;  // about the places
    for (int step = 0; step < kMostSteps && damping_ <= kMostDamping; ++step) {
      CheckStop(options_.stop);
      const double before = Total(merit_, weight);
      if (!squares) squares = SquaresFor(weight);
      std::vector<CoursePlace> trial = course_.Moved(StepFrom(*squares), ranges_, places_);
      const Merit reached = course_.Judge(trial);
      const double gain = before - Total(reached, weight);
      if (!(gain > 0)) {
        damping_ *= 10;
        continue;
      }
      places_ = std::move(trial);
      merit_ = reached;
      squares.reset();
      damping_ = std::max(damping_ / 4, kLeastDamping);
      if (gain < kConverged * std::abs(before)) break;
    }
    damping_ = std::min(damping_, kFirstDamping);
    if (Better(merit_, best_)) best_ = merit_, best_places_ = places_, best_weight_ = weight;
    return Affordable(merit_);
  }

  /// Bounds between points go first, then what may be lost, then smoothness.
  bool Better(const Merit& a, const Merit& b) const {
    constexpr double kSame = 1e-6;  // violations within the reserve are no better or worse
    if (a.steps != b.steps) return a.steps;
    if (a.within != b.within) return a.within;
    if (!(a.steps && a.within) && a.violation != b.violation) return a.violation < b.violation;
    if (Affordable(a) != Affordable(b)) return Affordable(a);
    if (!Affordable(a)) return a.objective < b.objective;
    return a.square < b.square && a.violation <= std::max(b.violation, kSame);
  }

  BoxLeastSquares SquaresFor(double weight) const {
    BoxLeastSquares squares(places_.size());
    course_.AddTo(squares, places_, 1 / options_.before.square, weight * PerObjective(), kViolationWeight);
    return squares;
  }

  /// Where the points would go next.
  std::vector<double> StepFrom(const BoxLeastSquares& squares) const {
    std::vector<double> lower, upper;
    for (const CoursePlace& place : places_) lower.push_back(place.lower), upper.push_back(place.upper);
    std::vector<double> x = squares.Solve(lower, upper, damping_);
    for (size_t t = 0; t < x.size(); ++t)
      x[t] = std::clamp(places_[t].x + x[t], ranges_[t].lower, ranges_[t].upper);
    return x;
  }

  std::span<const FreedomRange> ranges_;
  const SmoothOptions& options_;
  std::span<PathNode> path_;
  FreedomCourse course_;
  double damping_ = kFirstDamping;
  std::vector<CoursePlace> places_, best_places_;
  Merit merit_, best_;  ///< of both
  double best_weight_ = 0;
};

}  // namespace

SmoothReference MeasurePath(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                            const SmoothOptions& options, std::span<const PathNode> path) {
  const FreedomCourse course(scorers, points, path, options.closed,
                             {options.max_step, options.max_lean, options.freedom, options.middles});
  std::vector<CoursePlace> places(path.size());
  for (size_t t = 0; t < path.size(); ++t) places[t].q = path[t].q, places[t].objective = path[t].objective;
  const Merit merit = course.Judge(places);
  SmoothReference reference{merit.square, merit.objective, 0, {}};
  for (const PathNode& node : path) reference.worst = std::max(reference.worst, node.objective);
  for (size_t t = 0; t < course.motions(); ++t) reference.deviation.push_back(places[t].off.norm());
  return reference;
}

std::vector<double> DeviationLimits(const SmoothOptions& options) {
  std::vector<double> limits = options.before.deviation;
  for (double& limit : limits) {
    limit = options.repair ? options.max_deviation : std::max(options.max_deviation, kGrowth * limit);
  }
  return limits;
}

Smoothed SmoothPath(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                    std::span<const FreedomRange> ranges, const SmoothOptions& options,
                    std::span<PathNode> path) {
  assert(ranges.size() == path.size());
  if (path.size() < 3) return {};
  return Smoother(scorers, points, ranges, options, path).Run();
}

}  // namespace millpose
