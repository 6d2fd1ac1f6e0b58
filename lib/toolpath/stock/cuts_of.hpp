// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/milling_point.hpp"
#include "toolpath/stock/swept_cutter.hpp"

namespace millpose {

/// What a tool path in P takes off as it is laid; points with a gouge are not milled, nor is the way to them
/// and from them.
CutsOfTool CutsOf(const Toolpath& toolpath, const CutterShape& cutter);

}  // namespace millpose
