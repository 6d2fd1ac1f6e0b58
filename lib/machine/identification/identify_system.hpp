// SPDX-License-Identifier: GPL-3.0-or-later
// The linear system of an identification and which of its unknowns it determines. Internal to identification.
#pragma once

#include <vector>

#include "machine/identification/identify.hpp"

namespace millpose::identify {

/// Weighted rows of x = L·c, and to which case each belongs. Columns: the six joints, then
/// IdentifyOptions::beside.
struct System {
  Eigen::MatrixXd L;
  Eigen::VectorXd x;
  std::vector<size_t> case_of_row;
};
System MakeSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options);

/// The same without the rows of one pose.
System Without(const System& system, const std::vector<size_t>& pose_of_case, size_t pose);

/// Which unknowns the rows determine, one for each column; empty text = observable, else why not.
std::vector<std::string> Observability(const Eigen::MatrixXd& L);

/// Condition number of the observable columns scaled to unit length; 1 when there is at most one.
double Condition(const Eigen::MatrixXd& L, const std::vector<std::string>& unobservable);

/// Least squares c ≥ 0.
struct Solution {
  Eigen::VectorXd c;
  Eigen::MatrixXd inverse;   ///< of the normal matrix over the unknowns above 0; else 0
  std::vector<char> active;  ///< above 0
};

/// Over the unknowns in `free`; with or without Huber's weights, which `weights` leaves as used.
Solution Solve(const System& system, const std::vector<char>& free, bool robust, Eigen::VectorXd& weights);

/// Of each case the pose that it is in: equal joint angles that follow each other are one.
std::vector<size_t> PosesOf(const std::vector<LoadCase>& cases);

}  // namespace millpose::identify
