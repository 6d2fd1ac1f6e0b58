// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/program_axes.hpp"

namespace millpose::audit {

Matrix4 ToolFrame(const std::string& name) {
  Matrix4 X_TC = Matrix4::Zero();
  const int k = name.back() - 'x';
  const double along = name.front() == '-' ? -1 : 1;
  X_TC(2, k) = X_TC(1, (k + 2) % 3) = along;
  X_TC(0, (k + 1) % 3) = X_TC(3, 3) = 1;
  return X_TC;
}

Angles OfArm(const Setup& setup, const std::string& controller, Angles angles) {
  const auto found = setup.counts.find(controller);
  if (found == setup.counts.end()) return angles;
  const Setup::Count& count = found->second;
  Eigen::Matrix<Real, 6, 6> coupled;
  for (size_t i = 0; i < 6; ++i)
    for (size_t k = 0; k < 6; ++k)
      coupled(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          count.coupling[i][k] + (i == k ? 1 : 0);
  Eigen::Map<Eigen::Matrix<Real, 6, 1>> counted(angles.data());
  counted = coupled.fullPivLu().solve(counted).eval();
  for (size_t i = 0; i < 6; ++i) angles[i] = count.sign[i] * (angles[i] - count.offset[i]);
  return angles;
}

}  // namespace millpose::audit
