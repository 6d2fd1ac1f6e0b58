// SPDX-License-Identifier: GPL-3.0-or-later
// The sample panel, somewhere, with points drawn on it.
#pragma once

#include <optional>

#include "base/random.hpp"
#include "base/units.hpp"
#include "geometry/registration/next_places.hpp"

namespace millpose {

inline constexpr double kSharp = DegToRad(30);

Eigen::Vector3d NormalVector(RandomStream& random);
/// A motion by some `mm` and, at a metre, as much by turning.
Eigen::Isometry3d SmallMove(RandomStream& random, double mm);

/// Places of the sample panel, 600 by 900 mm: its skin, its narrow sides, and where it is milled.
struct ProbedPanel {
  ProbedPart part;
  std::vector<PartPlace> skin, sides, milled;
  ProbedPanel();
};
const ProbedPanel& ThePanel();

/// Where the program's face lies against the true one: the farthest along the normal at any place.
double Off(const std::vector<PartPlace>& face, const Eigen::Isometry3d& X_true,
           const Eigen::Isometry3d& X_found, const PartBending& bent_true = {},
           const std::optional<PartBending>& bent_found = {});

/// A part somewhere, and points probed on it.
struct Drawn {
  Eigen::Isometry3d X_true, start;
  std::vector<ProbedPoint> points;
};
Drawn Draw(RandomStream& random, size_t on_skin, size_t on_sides, double sd, double radius = 3,
           const PartBending& bending = {});

double Median(std::vector<double> values);

}  // namespace millpose
