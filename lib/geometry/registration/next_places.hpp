// SPDX-License-Identifier: GPL-3.0-or-later
// Where to probe next (docs/registration.md).
#pragma once

#include <functional>
#include <vector>

#include "geometry/registration/face_error.hpp"

namespace millpose {

/// A place worth probing.
struct NextPlace {
  size_t candidate = 0;
  double worst_sd = 0;  ///< mm along the normal at the worst place of the face, with it and those before it
};

/// Places of a mesh's surface at most `spacing` (mm) apart on each face, none within `edge` (mm) of a side
/// that bends by more than `crease` (rad) or is a rim, where a ball would slip off. At most `most`, spread
/// evenly over the faces' order.
std::vector<PartPlace> PlacesToProbe(const Mesh& mesh, double spacing, double edge, double crease,
                                     size_t most);

/// The `count` of `candidates` that lower the largest deviation of the face along its normals most, one after
/// the other (greedy), each probed once with standard deviation `sd` (mm). Only those for which `reachable`
/// holds; it is asked of few.
std::vector<NextPlace> ProposePlaces(ProbeMatrix covariance, const Eigen::Vector3d& centre,
                                     const std::vector<PartPlace>& face,
                                     const std::vector<PartPlace>& candidates, double sd, int count,
                                     const std::function<bool(size_t candidate)>& reachable,
                                     const PartBending* bending = nullptr);

}  // namespace millpose
