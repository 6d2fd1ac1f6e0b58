// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// A mesh (mm) as a binary STL in metres, about `centre` (mm): its numbers have seven digits, which are the
/// finer the nearer the mesh lies to its origin. `head`: at most 79 bytes of it are kept, in front of it a
/// blank, since "solid" would promise text.
std::string StlBytes(const Triangles& mesh, const Eigen::Vector3d& centre, const std::string& head);

}  // namespace millpose
