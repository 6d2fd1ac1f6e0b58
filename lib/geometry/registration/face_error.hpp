// SPDX-License-Identifier: GPL-3.0-or-later
// What the uncertainty of a part's place does to the face that is milled on it (docs/registration.md).
#pragma once

#include <vector>

#include "geometry/registration/register.hpp"

namespace millpose {

/// A place of a part and its surface normal there, in P.
struct PartPlace {
  Eigen::Vector3d position, normal;  ///< mm; unit vector out of the material
};

/// How far a face may be off, along its normals.
struct FaceError {
  std::vector<double> sd;  ///< by place, mm
  size_t worst = 0;        ///< the place with the largest
  double off_95 = 0;       ///< mm: with 95 % probability no place is farther off
  double median_off = 0;   ///< mm: likewise with 50 %
  double beside_95 = 0;    ///< mm: largest 95 % bound of a shift across the normal at any place
};

/// `covariance` of (t, w) about `centre`, and of a bent part's modes, as Registration has it. The bound over
/// all places comes from 4,000 draws of a fixed random stream; `sd` and `beside_95` are exact for normal
/// errors.
FaceError ErrorOfFace(const ProbeMatrix& covariance, const Eigen::Vector3d& centre,
                      const std::vector<PartPlace>& face, const PartBending* bending = nullptr);

}  // namespace millpose
