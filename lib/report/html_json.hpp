// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the data of report.html that html_data.cpp puts together.
#pragma once

#include <nlohmann/json.hpp>

#include "report/html.hpp"
#include "report/html_columns.hpp"

namespace millpose::html {

using Json = nlohmann::ordered_json;

/// 4x4, row by row, mm.
Json Matrix(const Pose& pose);
Json Degrees(const Joints& angles);
/// x, y, z of each in turn, packed as floats.
std::string PackVectors(const std::vector<Eigen::Vector3d>& vectors);
/// The upper three rows of each in turn, row by row, mm, packed as floats.
std::string PackPoses(const std::vector<Pose>& poses);

/// As it may stand in a script element: "<" is written as an escape, bytes that are no UTF-8 are replaced.
std::string ScriptText(const Json& data);

/// What the page needs to draw the arm at any joint angles.
Json ArmJson(const Arm& arm);
/// All bodies but the stock, which would hide the path; meshes thinned to the limits.
Json BodiesJson(const Cell& cell, const HtmlLimits& limits);
/// The objective over the rotation and the genetic algorithm's generations at the points that have curves.
Json CurvesJson(const HtmlInput& input);

/// The run of the plan: times and joints of its instants, by row where they are those of a point shown; null
/// without a timeline.
Json TimelineJson(const HtmlInput& input, const std::vector<ReportRow>& rows);

/// The nearest pair at every row, with the two places that are nearest to each other; null where nobody
/// looked.
Json NearestJson(const HtmlInput& input, const std::vector<ReportRow>& rows);

/// What bars the poses of the points that have curves, and the optima of the rows; null without a map.
Json MapJson(const HtmlInput& input, const std::vector<ReportRow>& rows);

/// The material while it is milled off; null without a raw part.
Json RemovalJson(const Removal* removal);

/// The map of the face, the plan's beside the fixed rotation's; null where it was not asked for.
Json FaceMapJson(const HtmlInput& input);

}  // namespace millpose::html
