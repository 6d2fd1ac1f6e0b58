// SPDX-License-Identifier: GPL-3.0-or-later
// The beginning of a small cell, up to its tool's stack; tests go on with the rest.
#pragma once

namespace millpose {

inline constexpr char kCellHead[] = R"(millpose_cell: 1
name: cell
arm:
  name: arm
  lengths_mm: {d1: 1045, a1: 500, a2: 1300, d4: 1025, dz: -55, d6: 290}
  axis_signs: [-1, 1, 1, -1, 1, -1]
  limits_deg: [[-185, 185], [-130, 20], [-100, 144], [-350, 350], [-120, 120], [-350, 350]]
  speeds_deg_s: [80, 75, 70, 70.5, 70.5, 109.7]
  accelerations_deg_s2: [200, 200, 200, 300, 300, 500]
  joint_stiffness_Nm_per_rad: [8.9e6, 6.78e6, 1.13e7, 2.01e6, 1.65e6, 1.35e6]
home_deg: [0, -90, 90, 0, 0, 0]
tool:
  name: spindle
  tip_in_flange_mm: [-250, 0, 250]
  axis_in_flange: [1, 0, 0]
  x_in_flange: [0, 0, 1]
  cutter: {diameter_mm: 20, cutting_length_mm: 40}
)";

}  // namespace millpose
