// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "base/decompositions.hpp"
#include "base/trig.hpp"
#include "machine/identification/identify_system.hpp"

namespace millpose {
namespace {

/// Information of every candidate, its columns scaled by all candidates' together.
class Design {
 public:
  Design(const Arm& arm, const std::vector<LoadCase>& candidates, const IdentifyOptions& options) {
    const identify::System all = identify::MakeSystem(arm, candidates, options);
    reasons_ = identify::Observability(all.L);
    for (size_t j = 0; j < reasons_.size(); ++j)
      if (reasons_[j].empty()) keep_.push_back(static_cast<int>(j));
    rows_.resize(candidates.size());
    for (size_t i = 0; i < candidates.size(); ++i) {
      const Eigen::MatrixXd L = identify::MakeSystem(arm, {candidates[i]}, options).L;
      rows_[i].resize(L.rows(), static_cast<Eigen::Index>(keep_.size()));
      for (size_t k = 0; k < keep_.size(); ++k)
        rows_[i].col(static_cast<Eigen::Index>(k)) = L.col(keep_[k]) / all.L.col(keep_[k]).norm();
    }
  }

  size_t size() const { return rows_.size(); }

  /// log det of the chosen candidates' information; a trace of the unit matrix keeps it finite while too few
  /// are chosen.
  double Value(const std::vector<size_t>& chosen) const {
    const auto n = static_cast<Eigen::Index>(keep_.size());
    Eigen::MatrixXd information = 1e-9 * Eigen::MatrixXd::Identity(n, n);
    for (const size_t i : chosen) information += rows_[i].transpose() * rows_[i];
    return Log(DeterminantOf(information));
  }

  bool ObservesAll(const std::vector<size_t>& chosen) const {
    Eigen::MatrixXd stacked(0, static_cast<Eigen::Index>(reasons_.size()));
    for (const size_t i : chosen) {
      const Eigen::Index before = stacked.rows();
      stacked.conservativeResize(before + rows_[i].rows(), Eigen::NoChange);
      stacked.bottomRows(rows_[i].rows()).setZero();
      for (size_t k = 0; k < keep_.size(); ++k)
        stacked.col(keep_[k]).tail(rows_[i].rows()) = rows_[i].col(static_cast<Eigen::Index>(k));
    }
    const auto reasons = identify::Observability(stacked);
    return std::all_of(keep_.begin(), keep_.end(),
                       [&](int j) { return reasons[static_cast<size_t>(j)].empty(); });
  }

 private:
  std::vector<std::string> reasons_;
  std::vector<int> keep_;
  std::vector<Eigen::MatrixXd> rows_;
};

bool Contains(const std::vector<size_t>& chosen, size_t candidate) {
  return std::find(chosen.begin(), chosen.end(), candidate) != chosen.end();
}

/// Adds the candidate that helps most.
void Grow(const Design& design, std::vector<size_t>& chosen) {
  size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < design.size(); ++i) {
    if (Contains(chosen, i)) continue;
    chosen.push_back(i);
    const double value = design.Value(chosen);
    chosen.pop_back();
    if (value > most) {
      most = value;
      best = i;
    }
  }
  chosen.push_back(best);
}

/// Exchanges single candidates while that helps (Fedorov 1972).
void Exchange(const Design& design, std::vector<size_t>& chosen) {
  double value = design.Value(chosen);
  for (bool improved = true; improved;) {
    improved = false;
    for (size_t& slot : chosen) {
      for (size_t i = 0; i < design.size(); ++i) {
        if (Contains(chosen, i)) continue;
        const size_t before = slot;
        slot = i;
        const double tried = design.Value(chosen);
        if (tried > value + 1e-9) {
          value = tried;
          improved = true;
        } else {
          slot = before;
        }
      }
    }
  }
}

}  // namespace

std::vector<size_t> ProposeLoadCases(const Arm& arm, const std::vector<LoadCase>& candidates, size_t count,
                                     const IdentifyOptions& options) {
  std::vector<size_t> chosen;
  if (candidates.empty()) return chosen;
  const Design design(arm, candidates, options);
  while (chosen.size() < design.size() && (count > 0 ? chosen.size() < count : !design.ObservesAll(chosen))) {
    Grow(design, chosen);
    if (count == 0) Exchange(design, chosen);
  }
  Exchange(design, chosen);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace millpose
