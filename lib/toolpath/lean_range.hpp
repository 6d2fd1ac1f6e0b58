// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace millpose {

/// By how much the tool axis may lean one way, rad.
struct LeanRange {
  double from = 0, to = 0;
  double step = 0;     ///< grid of searches
  double nominal = 0;  ///< how the tool path is laid
};

}  // namespace millpose
