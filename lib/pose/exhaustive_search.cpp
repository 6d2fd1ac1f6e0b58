// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <limits>

#include "pose/interval_end.hpp"
#include "pose/search.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMinimumTolerance = 1e-7;  // rad or mm: the value is flat there to 14 digits
constexpr double kEndTolerance = 1e-12;

/// One line through the space of the freedoms: all but the first fixed.
class Line {
 public:
  Line(const PointScorer& scorer, double step, PointOptimum& best)
      : scorer_(scorer), first_(*scorer.problem().freedoms[0]), best_(best) {
    const double range = first_.Upper() - first_.Lower();
    const int intervals = std::max(1, static_cast<int>(std::ceil(range / step - 1e-9)));
    count_ = first_.Periodic() ? intervals : intervals + 1;
    step_ = range / intervals;
    values_.assign(8 * static_cast<size_t>(count_), kInfinity);
    lanes_.resize(kLanes * scorer.problem().freedoms.size());
  }

  void Search(const FreedomValues& others) {
    others_ = others;
    Sample();
    for (int branch = 0; branch < 8; ++branch) {
      for (int i = 0; i < count_; ++i) {
        if (IsLocalMinimum(branch, i) && CouldWin(branch, i)) Refine(branch, i);
      }
    }
  }

 private:
  double At(int i) const { return first_.Lower() + i * step_; }

  /// The grid value, +inf where it is not admissible and beyond the ends of a freedom that is not periodic.
  double Value(int branch, int i) const {
    if (first_.Periodic()) i = (i + count_) % count_;
    return i < 0 || i >= count_ ? kInfinity : values_[static_cast<size_t>(branch) * count_ + i];
  }

  void Sample() {
    double x[kLanes];
    for (int first = 0; first < count_; first += kLanes) {
      for (int l = 0; l < kLanes; ++l) x[l] = At(std::min(first + l, count_ - 1));
      Score(x, kAllArmBranches);
      for (int l = 0; l < kLanes && first + l < count_; ++l) {
        for (int branch = 0; branch < 8; ++branch) {
          values_[static_cast<size_t>(branch) * count_ + first + l] = Consider(branch, l, x[l]);
        }
      }
    }
  }

  void Score(const double (&x)[kLanes], unsigned arm_branches) {
    const size_t dimensions = others_.size();
    for (size_t l = 0; l < kLanes; ++l) {
      std::copy(others_.begin(), others_.end(), lanes_.begin() + l * dimensions);
      lanes_[l * dimensions] = x[l];
    }
    scorer_.ScoreBlock(lanes_, arm_branches, block_);
    best_.evaluations += kLanes * std::popcount(arm_branches);
  }

  /// Takes a lane of the block into account; its value, +inf where it is not admissible.
  double Consider(int branch, int lane, double x) {
    const Admissibility admissibility = block_.admissibility[branch][lane];
    if (admissibility != Admissibility::kAdmissible) {
      if (!best_.found && admissibility > best_.reason) best_.reason = admissibility;
      return kInfinity;
    }
    const double value = block_.objective[branch].v[lane];
    if (!best_.found || value < best_.objective) {
      best_.found = true;
      best_.reason = Admissibility::kAdmissible;
      best_.freedoms = others_;
      best_.freedoms[0] = x;
      best_.branch = branch;
      best_.objective = value;
      best_.q = CandidateOf(block_, branch, lane).q;
    }
    return value;
  }

  bool IsLocalMinimum(int branch, int i) const {
    const double value = Value(branch, i);
    return std::isfinite(value) && value <= Value(branch, i - 1) && value <= Value(branch, i + 1);
  }

  /// Within a step of a sample the value falls by no more than a few times what it does between the samples
  /// beside it; a minimum that cannot reach the best so far even so is not refined.
  bool CouldWin(int branch, int i) const {
    constexpr double kReserve = 8.0;
    double change = 0.0;
    for (const int side : {-1, 1}) {
      const double beside = Value(branch, i + side);
      // At an interval's end the slope is taken on its inner side; an interval of one sample has none.
      if (std::isfinite(beside)) change = std::max(change, beside - Value(branch, i));
    }
    if (change == 0.0) return true;
    return Value(branch, i) - kReserve * change <= best_.objective;
  }

  void Refine(int branch, int i) {
    double ends[2] = {At(i - 1), At(i + 1)};
    for (double& end : ends) {
      const bool before = &end == ends;
      if (std::isfinite(Value(branch, before ? i - 1 : i + 1))) continue;
      if (!first_.Periodic()) end = std::clamp(end, first_.Lower(), first_.Upper());
      others_[0] = At(i);
      end = IntervalEnd(scorer_, others_, 0, branch, end, kEndTolerance, best_.evaluations);
    }
    double x[kLanes];
    for (int l = 0; l < kLanes; ++l) x[l] = ends[l % 2];
    Score(x, 1u << (branch & 3));
    for (int l = 0; l < 2; ++l) Consider(branch, l, x[l]);
    Minimise(branch, ends[0], ends[1]);
  }

  /// The minimum between two places: kLanes-fold section.
  void Minimise(int branch, double lower, double upper) {
    double x[kLanes];
    while (upper - lower > kMinimumTolerance) {
      const double part = (upper - lower) / (kLanes + 1);
      for (int l = 0; l < kLanes; ++l) x[l] = lower + (l + 1) * part;
      Score(x, 1u << (branch & 3));
      int least = 0;
      double values[kLanes];
      for (int l = 0; l < kLanes; ++l) {
        values[l] = Consider(branch, l, x[l]);
        if (values[l] < values[least]) least = l;
      }
      lower = x[least] - part;
      upper = x[least] + part;
    }
  }

  const PointScorer& scorer_;
  const Freedom& first_;
  PointOptimum& best_;
  int count_ = 0;
  double step_ = 0;
  FreedomValues others_;
  std::vector<double> values_;  // branch by branch
  std::vector<double> lanes_;
  ScoredBlock block_;
};

/// Moves `values` to the next node of the grid over all freedoms but the first; false after the last.
bool NextNode(const PoseProblem& problem, double step, std::vector<int>& node, FreedomValues& values) {
  for (size_t d = 1; d < values.size(); ++d) {
    const Freedom& freedom = *problem.freedoms[d];
    const double range = freedom.Upper() - freedom.Lower();
    const int intervals = std::max(1, static_cast<int>(std::ceil(range / step - 1e-9)));
    const int last = freedom.Periodic() ? intervals - 1 : intervals;
    node[d] = node[d] < last ? node[d] + 1 : 0;
    values[d] = freedom.Lower() + node[d] * (range / intervals);
    if (node[d] > 0) return true;
  }
  return false;
}

}  // namespace

PointOptimum ExhaustiveSearch(const PointScorer& scorer, const PoseProblem& problem, double step) {
  PointOptimum best;
  FreedomValues others;
  for (const auto& freedom : problem.freedoms) others.push_back(freedom->Lower());
  std::vector<int> node(others.size(), 0);
  Line line(scorer, step, best);
  do {
    line.Search(others);
  } while (NextNode(problem, step, node, others));
  return best;
}

}  // namespace millpose
