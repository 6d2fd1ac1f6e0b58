// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// Cutters that comments of G-code name, by the tool's number, as Autodesk's posts list them:
/// "(T3 D=8. CR=4. - …)". `unit` of their lengths in mm.
std::map<std::string, CamCutter> CuttersInComments(std::string_view bytes, double unit);

}  // namespace millpose
