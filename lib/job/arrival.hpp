// SPDX-License-Identifier: GPL-3.0-or-later
// What is said of an arm when it arrives, before anything is planned with it (docs/urdf.md).
#pragma once

#include "base/error.hpp"
#include "job/config/cell_settings.hpp"
#include "machine/collision/cell.hpp"

namespace millpose {

/// An arm as it was understood; every text is for people.
struct ArmArrival {
  std::string joints;                             ///< which, from where to where
  std::string zero;                               ///< where the arm is when all its angles are 0
  std::string wrist;                              ///< the family, and how far off the closed form is
  std::array<std::array<double, 2>, 6> limits{};  ///< lower and upper, deg
  struct Body {
    std::string name;
    std::string mount;                               ///< base, link1 … link6
    Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< of the box round it in its own frame, mm
  };
  std::vector<Body> bodies;              ///< of the arm, in the cell's order
  std::vector<std::string> controllers;  ///< "krl: signs […], offsets […] deg"
  std::vector<std::string> notes;        ///< what was snapped, what followed
};

ArmArrival DescribeArrival(const CellSettings& settings, const Cell& cell);

/// One line for each row, with a label of 20 columns as `millpose check` has them.
std::string ToText(const ArmArrival& arrival);

/// Meshes of the arm's links whose size cannot be meant: more than ten times what the arm reaches, or less
/// than a thousandth; with the scale that would do.
std::vector<Problem> CheckLinkMeshes(const CellSettings& cell,
                                     const std::map<std::string, std::string>& body_bytes);

}  // namespace millpose
