// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/leave_one_out.hpp"

#include <cmath>

#include "base/decompositions.hpp"

namespace millpose::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Unknowns in `free` that a normal matrix does not determine beside those before them; `full`: the matrix of
/// all poses, of which each column's part that is its own must not be less than a hundred thousandth.
std::vector<char> LostOf(const MatrixXd& N, const MatrixXd& full, const std::vector<char>& free) {
  constexpr double kLeastPivot = 1e-10;
  std::vector<char> lost(free.size(), 0);
  std::vector<Eigen::Index> kept;
  std::vector<VectorXd> rows;  // of the Cholesky factor
  for (Eigen::Index j = 0; j < N.rows(); ++j) {
    if (!free[static_cast<size_t>(j)]) continue;
    VectorXd row(static_cast<Eigen::Index>(kept.size()) + 1);
    double pivot = N(j, j) / full(j, j);
    for (size_t k = 0; k < kept.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      double sum = N(j, kept[k]) / std::sqrt(full(j, j) * full(kept[k], kept[k]));
      for (Eigen::Index m = 0; m < at; ++m) sum -= row[m] * rows[k][m];
      row[at] = sum / rows[k][at];
      pivot -= row[at] * row[at];
    }
    if (pivot < kLeastPivot) {
      lost[static_cast<size_t>(j)] = 1;
      continue;
    }
    row[static_cast<Eigen::Index>(kept.size())] = std::sqrt(pivot);
    kept.push_back(j);
    rows.push_back(row);
  }
  return lost;
}

}  // namespace

LeaveOneOut::LeaveOneOut(const Fitted& fit, const std::vector<size_t>& pose_of_case) : fit_(fit) {
  for (size_t row = 0; row < fit.system.case_of_row.size(); ++row)
    if (pose_of_case[fit.system.case_of_row[row]] == first_row_.size())
      first_row_.push_back(static_cast<Eigen::Index>(row));
  first_row_.push_back(fit.system.x.size());
  const MatrixXd weighted = fit.weights.asDiagonal() * fit.system.L;
  N_ = fit.system.L.transpose() * weighted;
  g_ = weighted.transpose() * fit.system.x;
  slope_ = g_ - N_ * fit.solution.c;
}

LeaveOneOut::Rest LeaveOneOut::SolveAgain(const MatrixXd& R, const VectorXd& y, const Solution& start) const {
  const MatrixXd N = N_ - R.transpose() * R;
  Rest rest{{}, LostOf(N, N_, fit_.free)};
  std::vector<char> still = fit_.free;
  Solution from = start;
  for (size_t j = 0; j < still.size(); ++j) {
    if (!rest.lost[j]) continue;
    still[j] = from.active[j] = 0;
    from.c[static_cast<Eigen::Index>(j)] = 0;
  }
  rest.c = SolveNonNegative(N, g_ - R.transpose() * y, still, fit_.system.payload && still.back(), from).c;
  return rest;
}

LeaveOneOut::Rest LeaveOneOut::Without(size_t pose) const {
  constexpr double kSingular = 1e-9;  // of 1 − H: the pose alone says something
  const Eigen::Index first = first_row_[pose], count = first_row_[pose + 1] - first;
  const VectorXd root = fit_.weights.segment(first, count).cwiseSqrt();
  const MatrixXd R = root.asDiagonal() * fit_.system.L.middleRows(first, count);
  const VectorXd y = root.cwiseProduct(fit_.system.x.segment(first, count));
  const Solution& all = fit_.solution;
  const MatrixXd RP = R * all.inverse;
  const EigenPairs eigen = EigenOfSymmetric(MatrixXd::Identity(count, count) - RP * R.transpose());
  if (eigen.values[0] < kSingular) return SolveAgain(R, y, all);
  const VectorXd e = y - R * all.c;
  const VectorXd across = eigen.vectors.transpose() * e;
  const VectorXd change = -RP.transpose() * (eigen.vectors * across.cwiseQuotient(eigen.values));
  // Without its rows: which unknowns are 0 must stay as it is.
  const VectorXd slope = slope_ - N_ * change - R.transpose() * (e - R * change);
  bool same = true;
  for (size_t j = 0; j < all.active.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const bool of_any_sign = fit_.system.payload && j + 1 == all.active.size();
    if (all.active[j])
      same = same && (of_any_sign || all.c[at] + change[at] > 0);
    else if (fit_.free[j])
      same = same && slope[at] <= 0;
  }
  if (!same) return SolveAgain(R, y, all);
  return {all.c + change, {}};
}

std::optional<double> LeaveOneOut::Foretold(size_t pose, Eigen::Index needed) const {
  const Rest rest = Without(pose);
  for (size_t j = static_cast<size_t>(needed); j < rest.lost.size(); ++j)
    if (rest.lost[j]) return std::nullopt;
  double square = 0, count = 0;
  for (Eigen::Index row = first_row_[pose]; row < first_row_[pose + 1]; ++row) {
    if (!fit_.system.displaces[static_cast<size_t>(row)]) continue;
    const double off = fit_.system.L.row(row).dot(rest.c) - fit_.system.x[row];
    square += off * off;
    count += 1;
  }
  return 3 * square / count;
}

}  // namespace millpose::identify
