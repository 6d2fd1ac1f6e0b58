// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "motion/line.hpp"

namespace millpose {

/// A straight motion as a controller makes it: orientation turning evenly about one axis, or by three angles
/// that run evenly.
class ProgrammedLine {
 public:
  ProgrammedLine(const Pose& from, const Pose& to) : line_(from, to) {}
  /// Orientation by angles (rad) from `first` to `last`: R = FromToolAngles(rotation, angles)·R_TCᵀ.
  ProgrammedLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const std::string& rotation,
                 const Eigen::Matrix3d& R_TC, const Eigen::Vector3d& first, const Eigen::Vector3d& last);

  Pose At(double share) const;  ///< 0..1
  double length() const { return line_.length(); }
  double angle() const;  ///< rad; of three angles a bound

 private:
  struct ByAngles {
    std::string rotation;
    Eigen::Matrix3d R_CT;
    Eigen::Vector3d first, last;
  };

  PoseLine line_;
  std::optional<ByAngles> by_angles_;
};

}  // namespace millpose
