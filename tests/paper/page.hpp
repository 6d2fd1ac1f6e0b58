// SPDX-License-Identifier: GPL-3.0-or-later
// What the sections of docs/paper.md share.
#pragma once

#include <fmt/format.h>

#include <string>

#include "machine/stiffness/compliance.hpp"
#include "tests/paper/figure3.hpp"
#include "tests/paper/paper_data.hpp"

namespace millpose {

/// Adds a line to the page.
void WriteLine(const std::string& line);

template <class... Arguments>
void Write(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
  WriteLine(fmt::format(text, std::forward<Arguments>(arguments)...));
}

/// The sections in the page's order.
void Head();
void Table1();
void Figure3Section(const Figure3& figure);
void Identification2();
void Table4();
void Table5();
void Table6();
void Equation36();
void Table7();
void Flatness45();

/// The tool axis u and tip t in F that the poses of Table 6 share best, and how far they miss.
struct Closure {
  Eigen::Vector3d axis, tip;
  double axis_spread_deg = 0, tip_rms = 0;
};

Closure Close(const Arm& arm);

struct PoseIndices {
  MillingPlaneIndices plane;
  PlaneDeflections moved;
  double f = 0;
};

/// At the point p_FT of the flange frame with the plane's normal given there.
PoseIndices IndicesAt(const Arm& arm, const Joints& q, const Eigen::Vector3d& p_FT,
                      const Eigen::Vector3d& normal_F);

}  // namespace millpose
