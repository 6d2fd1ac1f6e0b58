// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/arm.hpp"

namespace millpose {

/// a·b as Eigen has it, bit for bit, for what composes poses by the million: Eigen's own product calls a
/// function for each of its blocks.
inline Pose Compose(const Pose& a, const Pose& b) {
  Pose product;
  const double *of_a = a.data(), *of_b = b.data();
  double* to = product.data();
  for (int column = 0; column < 4; ++column, of_b += 4, to += 4) {
    // Eigen works rows 0 and 1 out together and row 2 by itself, in another order.
    to[0] = (of_a[0] * of_b[0] + of_a[4] * of_b[1]) + of_a[8] * of_b[2];
    to[1] = (of_a[1] * of_b[0] + of_a[5] * of_b[1]) + of_a[9] * of_b[2];
    to[2] = of_a[2] * of_b[0] + (of_a[6] * of_b[1] + of_a[10] * of_b[2]);
    to[3] = 0;
  }
  product.translation() += a.translation();
  product(3, 3) = 1;
  return product;
}

}  // namespace millpose
