// SPDX-License-Identifier: GPL-3.0-or-later
// Down from a place to the nearest local optimum in all freedoms. Optima of several freedoms lie in creases
// that run across all of them: where a joint meets its limit, or where a deflection changes its sign. There
// no single freedom can be moved to advantage, although two together can. So the first freedom follows: at
// every setting of the others it is brought to its least, which lies in the crease, and what is left as a
// function of the others is even. That is brought down by looks at all neighbours and a Newton step from
// them.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "planning/pose/climber.hpp"

namespace millpose {
namespace {

constexpr double kGridSteps = 90;         // of a freedom without a step of its own
constexpr double kFirst = 0.5;            // steps of its grid that a freedom is moved by
constexpr double kLast = 1e-5;            // likewise; then it is the optimum
constexpr double kFollows = 4;            // steps of the first freedom for each of another
constexpr double kFarthest = 2;           // likewise, altogether
constexpr double kTolerance = 5e-2;       // of the first freedom: of the square of the others' steps
constexpr double kLeastTolerance = 1e-9;  // steps
constexpr double kShrink = 0.3, kNewtonShrink = 0.125;
constexpr double kWorthless = 1e-9;  // of the value: what Newton's step promises at the optimum

double GridStep(const Freedom& freedom) {
  return freedom.Step() > 0 ? freedom.Step() : (freedom.Upper() - freedom.Lower()) / kGridSteps;
}

class Descent {
 public:
  Descent(const PointScorer& scorer, int max_evaluations, PointOptimum& best)
      : freedoms_(scorer.problem().freedoms), scorer_(scorer), most_(max_evaluations), best_(best) {
    for (const auto& freedom : freedoms_) steps_.push_back(GridStep(*freedom));
    lanes_.resize(kLanes * freedoms_.size());
  }

  void Run() {
    centre_ = {best_.freedoms, best_.objective};
    const Place below = Follow(centre_.freedoms, kFirst);
    if (below.value < centre_.value) centre_ = below;
    if (freedoms_.size() == 1) return;
    for (double step = kFirst; step >= kLast && Left();) {
      Look(step);
      promised_ = kInfinity;
      const Place newton = NewtonPlace(step);
      Place least = *std::ranges::min_element(around_, {}, &Place::value);
      const bool beside = least.value < centre_.value;
      if (newton.value < least.value) least = newton;
      const bool lower = least.value < centre_.value;
      const bool converged = !(promised_ > kWorthless * centre_.value) && !beside;
      // Where Newton's step is the best the next one will be much shorter.
      if (lower && least.value == newton.value)
        step *= kNewtonShrink;
      else if (!lower)
        step *= kShrink;
      if (lower) centre_ = least;
      if (converged) return;
    }
  }

 private:
  struct Place {
    FreedomValues freedoms;
    double value = kInfinity;
    bool operator<(const Place& other) const { return value < other.value; }
  };

  /// The least along the first freedom near a setting.
  Place Follow(const FreedomValues& at, double step) {
    const double reach = std::min(kFarthest, kFollows * step) * steps_[0],
                 tolerance = std::max(kLeastTolerance, kTolerance * step * step) * steps_[0];
    double lower = at[0] - reach, upper = at[0] + reach;
    if (!freedoms_[0]->Periodic()) {
      lower = std::max(lower, freedoms_[0]->Lower());
      upper = std::min(upper, freedoms_[0]->Upper());
    }
    Place least{at, kInfinity};
    while (upper - lower > tolerance && Left()) {
      const double part = (upper - lower) / (kLanes + 1);
      for (size_t l = 0; l < kLanes; ++l) {
        std::copy(at.begin(), at.end(), lanes_.begin() + static_cast<std::ptrdiff_t>(l * at.size()));
        lanes_[l * at.size()] = lower + static_cast<double>(l + 1) * part;
      }
      const std::optional<size_t> lane = LeastLane();
      if (!lane) break;
      const double x = lanes_[*lane * at.size()];
      if (Value(*lane) < least.value) least.freedoms[0] = x, least.value = Value(*lane);
      lower = std::max(lower, x - part);
      upper = std::min(upper, x + part);
    }
    return least;
  }

  /// Whether there are evaluations left for a block.
  bool Left() const { return most_ - best_.evaluations >= kLanes; }

  double Value(size_t lane) const {
    return block_.obstacle[best_.branch][lane] == Infeasibility::kNone
               ? block_.objective[best_.branch].v[lane]
               : kInfinity;
  }

  /// The least of the block's lanes, which the optimum takes note of; empty where none is admissible.
  std::optional<size_t> LeastLane() {
    scorer_.ScoreBlock(lanes_, 1u << (best_.branch & 3), block_);
    best_.evaluations += kLanes;
    size_t least = 0;
    for (size_t l = 1; l < kLanes; ++l)
      if (Value(l) < Value(least)) least = l;
    if (!std::isfinite(Value(least))) return std::nullopt;
    if (Value(least) < best_.objective) {
      const auto from = lanes_.begin() + static_cast<std::ptrdiff_t>(least * freedoms_.size());
      best_.freedoms.assign(from, from + static_cast<std::ptrdiff_t>(freedoms_.size()));
      best_.freedoms[0] = Confine(*freedoms_[0], best_.freedoms[0]);
      best_.objective = Value(least);
      best_.q = CandidateOf(block_, best_.branch, static_cast<int>(least)).q;
    }
    return least;
  }

  /// The centre with the further freedoms moved by `move`, in steps; none leaves its range.
  FreedomValues Moved(const std::vector<double>& move) const {
    FreedomValues at = centre_.freedoms;
    for (size_t d = 1; d < at.size(); ++d) at[d] = Confine(*freedoms_[d], at[d] + move[d - 1] * steps_[d]);
    return at;
  }

  /// All neighbours of the centre: digit d of their index to base 3 says which way freedom d + 1 went.
  void Look(double step) {
    size_t count = 1;
    for (size_t d = 1; d < freedoms_.size(); ++d) count *= 3;
    around_.assign(count, centre_);
    std::vector<double> move(freedoms_.size() - 1);
    for (size_t k = 0; k < count; ++k) {
      size_t rest = k;
      for (double& way : move) way = (static_cast<double>(rest % 3) - 1) * step, rest /= 3;
      const FreedomValues at = Moved(move);
      around_[k] = at == centre_.freedoms ? centre_ : Follow(at, step);
    }
  }

  /// The value beside the centre: `a` and `b` say which way freedoms d and e went.
  double Beside(size_t d, int a, size_t e = 0, int b = 0) const {
    std::ptrdiff_t index = 0, power = 1;
    for (size_t of = 1; of < freedoms_.size(); ++of, power *= 3)
      index += (1 + (of == d ? a : of == e ? b : 0)) * power;
    return around_[static_cast<size_t>(index)].value;
  }

  /// The least of the paraboloid through the neighbours, over those freedoms that have two.
  Place NewtonPlace(double step) {
    std::vector<size_t> free;
    for (size_t d = 1; d < freedoms_.size(); ++d) {
      const bool inside = centre_.freedoms[d] - step * steps_[d] >= freedoms_[d]->Lower() &&
                          centre_.freedoms[d] + step * steps_[d] <= freedoms_[d]->Upper();
      if ((inside || freedoms_[d]->Periodic()) && std::isfinite(Beside(d, -1) + Beside(d, 1)))
        free.push_back(d);
    }
    const auto count = static_cast<Eigen::Index>(free.size());
    Eigen::VectorXd slope(count);
    Eigen::MatrixXd bend(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const size_t d = free[static_cast<size_t>(i)];
      slope[i] = (Beside(d, 1) - Beside(d, -1)) / 2;
      bend(i, i) = Beside(d, 1) - 2 * centre_.value + Beside(d, -1);
      for (Eigen::Index k = 0; k < i; ++k) {
        const size_t e = free[static_cast<size_t>(k)];
        const double twist =
            (Beside(d, 1, e, 1) - Beside(d, 1, e, -1) - Beside(d, -1, e, 1) + Beside(d, -1, e, -1)) / 4;
        bend(i, k) = bend(k, i) = std::isfinite(twist) ? twist : 0;
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(bend);
    if (count == 0 || factor.info() != Eigen::Success) return {centre_.freedoms, kInfinity};
    const Eigen::VectorXd by = factor.solve(slope);
    promised_ = slope.dot(by) / 2;
    std::vector<double> move(freedoms_.size() - 1, 0.0);
    for (Eigen::Index i = 0; i < count; ++i)
      move[free[static_cast<size_t>(i)] - 1] = std::clamp(-by[i], -1.0, 1.0) * step;
    return Follow(Moved(move), step);
  }

  const std::vector<std::shared_ptr<const Freedom>>& freedoms_;
  const PointScorer& scorer_;
  int most_;  ///< evaluations
  PointOptimum& best_;
  std::vector<double> steps_;
  std::vector<double> lanes_;
  ScoredBlock block_;
  Place centre_;
  double promised_ = 0;  ///< by what Newton's step would lower the value
  std::vector<Place> around_;
};

using Entry = CandidateTable::Entry;

PointOptimum OptimumOf(const CandidateTable& table, const Entry& entry) {
  PointOptimum at;
  at.found = true;
  at.reason = Infeasibility::kNone;
  at.freedoms = table.Setting(entry.setting);
  at.branch = entry.branch;
  at.q = entry.q;
  at.objective = entry.objective;
  return at;
}

/// The best of a table of which none is a grid neighbour of another on its branch.
std::vector<PointOptimum> BestPlaces(const PoseProblem& problem, const CandidateTable& table, size_t count) {
  std::vector<const Entry*> order;
  for (const Entry& entry : table.entries()) order.push_back(&entry);
  std::ranges::stable_sort(order, {}, [](const Entry* entry) { return entry->objective; });
  std::vector<PointOptimum> best;
  for (const Entry* entry : order) {
    if (best.size() == count) break;
    PointOptimum at = OptimumOf(table, *entry);
    const auto near = [&](const PointOptimum& other) {
      if (other.branch != at.branch) return false;
      for (size_t d = 0; d < at.freedoms.size(); ++d) {
        const Freedom& freedom = *problem.freedoms[d];
        if (std::abs(Difference(freedom, at.freedoms[d], other.freedoms[d])) > 1.5 * GridStep(freedom))
          return false;
      }
      return true;
    };
    if (std::ranges::none_of(best, near)) best.push_back(std::move(at));
  }
  return best;
}

}  // namespace

PointOptimum Descend(const PointScorer& scorer, PointOptimum from, int max_evaluations) {
  Descent(scorer, max_evaluations, from).Run();
  return from;
}

PointOptimum DescendTable(const PointScorer& scorer, const CandidateTable& table) {
  constexpr size_t kPlaces = 6;
  constexpr int kRough = 300;  // evaluations: enough to tell which leads lowest
  PointOptimum best;
  best.reason = table.reason();
  int evaluations = static_cast<int>(4 * table.settings());
  for (PointOptimum& place : BestPlaces(scorer.problem(), table, kPlaces)) {
    PointOptimum rough = Descend(scorer, std::move(place), kRough);
    evaluations += rough.evaluations;
    if (!best.found || rough.objective < best.objective) best = std::move(rough);
  }
  if (best.found) best = Descend(scorer, std::move(best));
  best.evaluations += evaluations;
  return best;
}

}  // namespace millpose
