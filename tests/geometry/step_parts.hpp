// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace millpose {

/// A block of 100 × 60 × 20 mm from the origin with a hole of the given radius (mm) through (50, 30) along z,
/// as STEP in the given unit ("MM" or "INCH").
std::string DrilledBlockStep(const std::string& unit, double radius = 15);

/// The same block as IGES: as a solid, or as surfaces that stand beside each other.
std::string DrilledBlockIges(const std::string& unit, bool solid);

/// A plate of 100 × 60 × 10 mm on the floor with two ribs of 10 × 60 × 30 mm upright on it, which share faces
/// and edges with it: an assembly of the products "plate" and, used twice, "rib".
std::string AssemblyStep();

/// A ball of the given radius (mm) about the origin.
std::string BallStep(double radius);

/// A block of 100 × 60 × 20 mm and, as face 7, a plane between two edges that no wire joins, so that it has
/// no triangles.
std::string LostFaceStep();

}  // namespace millpose
