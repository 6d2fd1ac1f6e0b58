// SPDX-License-Identifier: GPL-3.0-or-later
// The linear system of an identification and which joints it determines. Internal to stiffness.
#pragma once

#include <vector>

#include "machine/identification/identify.hpp"

namespace millpose::identify {

using Six = Eigen::Matrix<double, 6, 1>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// Weighted rows of x = L·c, and to which case each belongs.
struct System {
  Rows L;
  Eigen::VectorXd x;
  std::vector<size_t> case_of_row;
};
System MakeSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options);

/// Which joints the rows determine; empty text = observable, else why not.
std::array<std::string, 6> Observability(const Rows& L);

/// Condition number of the observable columns scaled to unit length; 1 when there is at most one.
double Condition(const Rows& L, const std::array<std::string, 6>& unobservable);

}  // namespace millpose::identify
