// SPDX-License-Identifier: GPL-3.0-or-later
// The linear system of an identification and which of its unknowns it determines. Internal to identification.
#pragma once

#include <vector>

#include "machine/identification/identify.hpp"

namespace millpose::identify {

/// Weighted rows of x = L·c, and to which case each belongs. Columns: the six joints, then
/// IdentifyOptions::beside, then perhaps a payload's weight.
struct System {
  Eigen::MatrixXd L;
  Eigen::VectorXd x;
  std::vector<size_t> case_of_row;
  std::vector<char> displaces;  ///< of each row: a displacement's; else a rotation's
  bool payload = false;         ///< the last column's unknown is a weight, which may be below 0
};
/// Of the loads as stated.
System MakeSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options);
/// Of a weight of 1 N in place of each load; a joint's gap is taken up by the loads alone.
System MakeWeightSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options);

/// The same with those columns alone.
System Columns(const System& system, const std::vector<Eigen::Index>& columns);

/// Which unknowns the rows determine, one for each column; empty text = observable, else why not.
std::vector<std::string> Observability(const Eigen::MatrixXd& L);

/// Condition number of the observable columns scaled to unit length; 1 when there is at most one.
double Condition(const Eigen::MatrixXd& L, const std::vector<std::string>& unobservable);

/// Least squares.
struct Solution {
  Eigen::VectorXd c;
  Eigen::MatrixXd inverse;   ///< of the normal matrix over the active unknowns; else 0
  std::vector<char> active;  ///< not held at 0
};

/// Minimum of ½cᵀNc − gᵀc over the unknowns in `keep`, of any sign; the others 0.
Solution SolveSubset(const Eigen::MatrixXd& N, const Eigen::VectorXd& g, const std::vector<char>& keep);

/// Minimum of ½cᵀNc − gᵀc with c ≥ 0 over the unknowns in `free`, the last of any sign where `payload`; from
/// `start`, which is such a c.
Solution SolveNonNegative(const Eigen::MatrixXd& N, const Eigen::VectorXd& g, const std::vector<char>& free,
                          bool payload, const Solution& start);

/// What a system says of its unknowns.
struct Fitted {
  System system;  ///< with a payload: as it is about the solution
  std::vector<std::string> reasons;
  std::vector<char> free;  ///< observable
  Solution solution;
  Eigen::VectorXd weights;  ///< 1, or Huber's

  double freedom() const;  ///< rows more than unknowns
};

/// With or without Huber's weights; `weight`: with a payload, of which these are the columns.
/// Fitted::solution is empty where freedom() is below 1.
Fitted FitSystem(const System& stated, const System* weight, bool robust);

/// Of each case the pose that it is in: equal joint angles that follow each other are one.
std::vector<size_t> PosesOf(const std::vector<LoadCase>& cases);

}  // namespace millpose::identify
