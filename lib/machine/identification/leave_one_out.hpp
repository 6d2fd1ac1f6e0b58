// SPDX-License-Identifier: GPL-3.0-or-later
// A fit without one of its poses, from the fit of all. Internal to identification.
#pragma once

#include <vector>

#include "machine/identification/identify_system.hpp"

namespace millpose::identify {

/// Exact for least squares with c ≥ 0: with the rows R of a pose, their residuals e, the inverse P of the
/// normal matrix and H = R·P·Rᵀ the solution without them is c − P·Rᵀ·(1 − H)⁻¹·e (Cook and Weisberg 1982,
/// section 2.2); where that changes which unknowns are 0, those are sought again from it. Huber's weights are
/// those of all poses; with a payload it holds to first order.
class LeaveOneOut {
 public:
  LeaveOneOut(const Fitted& fit, const std::vector<size_t>& pose_of_case);

  size_t poses() const { return first_row_.size() - 1; }

  struct Rest {
    Eigen::VectorXd c;
    std::vector<char> lost;  ///< unknowns that the other poses do not determine; empty: none
  };
  Rest Without(size_t pose) const;

  /// Of the weighted displacements of a pose, the mean square of what the others do not foretell; nothing
  /// where they do not determine all unknowns from `needed` on.
  std::optional<double> Foretold(size_t pose, Eigen::Index needed) const;

 private:
  Rest SolveAgain(const Eigen::MatrixXd& R, const Eigen::VectorXd& y, const Solution& start) const;

  const Fitted& fit_;
  std::vector<Eigen::Index> first_row_;  ///< of each pose, and the end
  Eigen::MatrixXd N_;
  Eigen::VectorXd g_, slope_;  ///< slope: g − N·c
};

}  // namespace millpose::identify
