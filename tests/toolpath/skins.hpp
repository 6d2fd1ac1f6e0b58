// SPDX-License-Identifier: GPL-3.0-or-later
// Open skins with a window, made for tests: flat, bent about x, or a part of a sphere.
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace millpose {

enum class SkinForm : uint8_t { kFlat, kCylinder, kSphere };

struct Skin {
  SkinForm form = SkinForm::kFlat;
  double radius = 0;                   ///< mm, of the skin
  double corner = 5;                   ///< mm, of the window's corners; 0: sharp
  double width = 180, height = 180;    ///< mm, along x and along the arc
  double edge = 15;                    ///< mm, length of the border's sides along its straights
  double facet = 5 * 0.0174532925199;  ///< rad, by which the border turns in a corner from side to side
};

/// The window is empty, the skin reaches to 1.6 times its size; z is out of the material at the middle, where
/// the origin is. All vertices lie on the skin.
Triangles SkinShape(const Skin& skin);

/// Where a place of the development lies: the first number along x, the second along the arc. A sphere has
/// none; it is seen along z.
Eigen::Vector3d OnSkin(const Skin& skin, const Eigen::Vector2d& p);

/// The skin's unit normal at a place on it, or beside it.
Eigen::Vector3d SkinNormal(const Skin& skin, const Eigen::Vector3d& p);

}  // namespace millpose
