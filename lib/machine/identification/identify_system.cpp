// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify_system.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

namespace millpose::identify {
namespace {

constexpr double kNoLoad = 1e-8;     // of the largest column: what rounding leaves of a joint without torque
constexpr double kDependent = 1e-6;  // part of a unit column that the others cannot make

/// Columns `keep` of L, each scaled to unit length.
Eigen::MatrixXd Scaled(const Rows& L, const std::vector<int>& keep) {
  Eigen::MatrixXd columns(L.rows(), static_cast<Eigen::Index>(keep.size()));
  for (size_t k = 0; k < keep.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = L.col(keep[k]).normalized();
  return columns;
}

}  // namespace

System MakeSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options) {
  Eigen::Index rows = 0;
  for (const LoadCase& load : cases) rows += load.rotation ? 6 : 3;
  System system;
  system.L.resize(rows, 6);
  system.x.resize(rows);
  Eigen::Index row = 0;
  for (size_t i = 0; i < cases.size(); ++i) {
    const LoadCase& load = cases[i];
    const Matrix6 at_load = Jacobian(arm, load.q, load.load_point);
    const Matrix6 measured = Jacobian(arm, load.q, load.measured_point);
    const Six torques =
        at_load.topRows<3>().transpose() * load.force + at_load.bottomRows<3>().transpose() * load.moment;
    system.L.middleRows<3>(row) =
        measured.topRows<3>() * torques.asDiagonal() / options.displacement_deviation;
    system.x.segment<3>(row) = load.displacement / options.displacement_deviation;
    if (load.rotation) {
      system.L.middleRows<3>(row + 3) =
          measured.bottomRows<3>() * torques.asDiagonal() / options.rotation_deviation;
      system.x.segment<3>(row + 3) = *load.rotation / options.rotation_deviation;
    }
    const int added = load.rotation ? 6 : 3;
    system.case_of_row.insert(system.case_of_row.end(), added, i);
    row += added;
  }
  return system;
}

std::array<std::string, 6> Observability(const Rows& L) {
  std::array<std::string, 6> reasons;
  const Six lengths = L.colwise().norm();
  std::vector<int> loaded;
  for (int j = 0; j < 6; ++j) {
    if (lengths[j] > kNoLoad * lengths.maxCoeff())
      loaded.push_back(j);
    else
      reasons[j] = "not observable: no load case puts a torque on it that moves the measured point";
  }
  for (const int j : loaded) {
    std::vector<int> others;
    for (const int other : loaded)
      if (other != j) others.push_back(other);
    if (others.empty()) continue;
    const Eigen::MatrixXd columns = Scaled(L, others);
    const Eigen::VectorXd column = L.col(j).normalized();
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
    if (L.rows() < static_cast<Eigen::Index>(loaded.size()) ||
        (columns * qr.solve(column) - column).norm() < kDependent)
      reasons[j] = "not observable: its effect is a combination of other joints'";
  }
  return reasons;
}

double Condition(const Rows& L, const std::array<std::string, 6>& unobservable) {
  std::vector<int> keep;
  for (int j = 0; j < 6; ++j)
    if (unobservable[j].empty()) keep.push_back(j);
  if (keep.size() < 2) return 1;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Scaled(L, keep));
  return svd.singularValues()[0] / svd.singularValues()[svd.singularValues().size() - 1];
}

}  // namespace millpose::identify
