// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "machine/collision/cell.hpp"

namespace millpose {

/// A polyhedron around a cone frustum (its own frame, mm) whose radius exceeds it by 0.2 %; never smaller.
Convex AroundFrustum(const Cone& cone);

/// The part of a tool body above height `z` (mm) over the tip, as a convex shape in T that contains it (a
/// mesh counts as its hull) and exceeds it by at most 0.5 % of its radius; empty when the body does not reach
/// that high. `X_TG` is the pose of the shape in T.
std::optional<Convex> AboveHeight(const Shape& shape, const Pose& X_TG, double z);

}  // namespace millpose
