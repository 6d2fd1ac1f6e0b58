// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>

#include "base/units.hpp"
#include "planning/pose/interval_end.hpp"
#include "planning/pose/search.hpp"

namespace millpose {
namespace {

constexpr double kMinimumTolerance = 1e-7;  // rad or mm: the value is flat there to 14 digits
constexpr double kEndTolerance = 1e-12;

/// Refines a table's minima along lines through the space of the freedoms: all but the first fixed.
class Line {
 public:
  Line(const PointScorer& scorer, const CandidateTable& table, PointOptimum& best)
      : scorer_(scorer),
        table_(table),
        first_(*scorer.problem().freedoms[0]),
        best_(best),
        count_(table.line_length()),
        values_(8 * table.settings(), kInfinity) {
    for (const CandidateTable::Entry& entry : table.entries())
      values_[entry.branch * table.settings() + entry.setting] = entry.objective;
    lanes_.resize(kLanes * scorer.problem().freedoms.size());
  }

  /// `line`: the setting of its first value.
  void Search(size_t line) {
    line_ = line;
    others_ = table_.Setting(line);
    for (int branch = 0; branch < 8; ++branch) {
      for (int i = 0; i < count_; ++i) {
        if (IsLocalMinimum(branch, i) && CouldWin(branch, i)) Refine(branch, i);
      }
    }
  }

 private:
  double At(int i) const { return table_.At(0, i); }

  /// The grid value, +inf where it is not admissible and beyond the ends of a freedom that is not periodic.
  double Value(int branch, int i) const {
    if (first_.Periodic()) i = (i + count_) % count_;
    if (i < 0 || i >= count_) return kInfinity;
    return values_[static_cast<size_t>(branch) * table_.settings() + line_ +
                   static_cast<size_t>(i) * table_.stride()];
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
    const Infeasibility obstacle = block_.obstacle[branch][lane];
    if (obstacle != Infeasibility::kNone) {
      if (!best_.found && obstacle > best_.reason) best_.reason = obstacle;
      return kInfinity;
    }
    const double value = block_.objective[branch].v[lane];
    if (!best_.found || value < best_.objective) {
      best_.found = true;
      best_.reason = Infeasibility::kNone;
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
  const CandidateTable& table_;
  const Freedom& first_;
  PointOptimum& best_;
  int count_;
  size_t line_ = 0;
  FreedomValues others_;
  std::vector<double> values_;  // +inf where not admissible; branch by branch, setting by setting
  std::vector<double> lanes_;
  ScoredBlock block_;
};

}  // namespace

PointOptimum RefineTable(const PointScorer& scorer, const CandidateTable& table) {
  PointOptimum best;
  best.reason = table.reason();
  best.evaluations = static_cast<int>(4 * table.settings());
  if (table.entries().empty()) return best;
  const auto least = std::min_element(table.entries().begin(), table.entries().end(),
                                      [](const auto& a, const auto& b) { return a.objective < b.objective; });
  best.found = true;
  best.freedoms = table.Setting(least->setting);
  best.branch = least->branch;
  best.objective = least->objective;
  best.q = least->q;
  Line line(scorer, table, best);
  for (size_t first = 0; first < table.stride(); ++first) line.Search(first);
  return best;
}

PointOptimum ExhaustiveSearch(const PointScorer& scorer, double step) {
  return RefineTable(scorer, CandidateTable::OfStep(scorer, step));
}

}  // namespace millpose
