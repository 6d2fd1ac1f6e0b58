// SPDX-License-Identifier: GPL-3.0-or-later
// check.html: cell, part, tool path and reach before anything is planned, as one file (docs/check.md).
#pragma once

#include "geometry/import/mesh_parts.hpp"
#include "report/html.hpp"
#include "report/side_view.hpp"
#include "report/words/words.hpp"
#include "toolpath/milling_point.hpp"
#include "toolpath/stock/removal.hpp"

namespace millpose {

/// What the arm can do at a point, whichever way the tool is turned about its axis and on whichever branch.
struct PointReach {
  Infeasibility best = Infeasibility::kUnreachable;  ///< kNone, kUnreachable, kLimit or kSingular
  int axis = -1;  ///< 0…5: nearest to its limit in the pose that keeps farthest from limits; −1: none
  double reserve = 0;         ///< rad to that limit, less the job's margin; below 0: beyond it
  Joints q = Joints::Zero();  ///< that pose, where the arm reaches the point at all
};

/// All that the page shows. What there is none of is left null or empty.
struct CheckHtmlInput {
  std::string title;
  const Cell* cell = nullptr;          ///< the workpiece among its bodies is not drawn: `part` is
  const Mesh* part = nullptr;          ///< in P
  std::vector<char> in_region;         ///< by triangle of the part
  const Toolpath* toolpath = nullptr;  ///< in W
  std::vector<PointReach> reach;       ///< of its points
  std::string measured;                ///< "SERIAL, measured on DATE" of a calibrated arm
  const Removal* removal = nullptr;    ///< what comes to the path, and what it leaves (PathRemoval)
  std::vector<std::string> findings, notes;
  std::optional<WrongSide> wrong_side;     ///< of such findings the first point, for their picture
  std::string text;                        ///< what the terminal is told
  std::string settings;                    ///< as resolved, YAML
  Language language = Language::kEnglish;  ///< that the page opens in
};

/// The page as bytes: a pure function of its input.
std::string CheckHtml(const CheckHtmlInput& input, const HtmlLimits& limits = {});

}  // namespace millpose
