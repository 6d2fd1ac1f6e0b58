// SPDX-License-Identifier: GPL-3.0-or-later
// A way beside a contour with a tool axis that turns evenly, and no more nodes than that needs.
#pragma once

#include "toolpath/strategies/trim_distance.hpp"
#include "toolpath/strategies/trim_offset.hpp"

namespace millpose {

/// A node of the way and what of the contour it lies beside. Where the way leaves one part of the contour for
/// another, two follow each other at one place.
struct TrackSample {
  OffsetNode node;
  size_t segment = 0;  ///< of the contour
  double rise = 0;     ///< by which this part's plane lies over that of the sample before, mm
};

struct Way {
  std::vector<TrackSample> samples;
  bool closed = false;
};

/// The way with the axis averaged over `options.smoothing`, moved across the axis so that it keeps its
/// distance from the contour, in as few nodes as the chord tolerance allows at the tip as well as in the
/// surface. `lean` becomes the largest angle (rad) by which the mean differs from the way's own axis, if that
/// is more.
OffsetPath SmoothPath(const Way& way, const Contour& contour, const ContourDistance& near,
                      const OffsetOptions& options, double& lean);

}  // namespace millpose
