// SPDX-License-Identifier: GPL-3.0-or-later
// How long the steps of a tool path are and how fast the tool axis turns along them.
#pragma once

#include <array>

#include "geometry/mesh/mesh.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

struct StepCensus {
  std::array<size_t, 5> steps{};    ///< below 0.01, 0.05, 0.5, 5 mm, and longer
  std::array<size_t, 4> turns{};    ///< below 0.1, 0.5, 2 degrees per mm, and more
  std::vector<std::string> uneven;  ///< shorter than 0.05 mm and at no corner, or turning by more than 2°/mm
                                    ///< where the surface does not; one sentence each
};

/// Of all passes with their leads. `mesh`: the surface, where the path lies on one. A corner is where the way
/// turns by 10° or more.
StepCensus CensusOf(const Toolpath& toolpath, const Mesh* mesh);

/// Both histograms in a line.
std::string ToText(const StepCensus& census);

}  // namespace millpose
