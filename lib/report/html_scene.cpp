// SPDX-License-Identifier: GPL-3.0-or-later
// The arm and the bodies of report.html.
#include "base/units.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"
#include "report/view_mesh.hpp"

namespace millpose::html {
namespace {

const char* MountName(Mount mount) {
  switch (mount) {
    case Mount::kWorld:
    case Mount::kCarriage:  // drawn where it stands with the external axes at 0
      return "world";
    case Mount::kLink:
      return "link";
    case Mount::kTool:
      return "tool";
    case Mount::kWorkpiece:
      return "workpiece";
  }
  assert(false && "mount out of range");
  return "";
}

Json BodyJson(const Body& body, const HtmlLimits& limits) {
  const bool workpiece = body.body_class == BodyClass::kWorkpiece;
  const Triangles whole = ViewMesh(body.shape);
  const Triangles mesh = ThinnedMesh(whole, workpiece ? limits.workpiece_triangles : limits.body_triangles);
  std::vector<uint32_t> faces;
  for (const auto& face : mesh.faces)
    for (int v : face) faces.push_back(static_cast<uint32_t>(v));
  return {{"name", body.name},
          {"class", WordOf(kBodyClassWords, body.body_class)},
          {"mount", MountName(body.mount)},
          {"link", body.link},
          {"X_MG", Matrix(body.X_MG)},
          {"triangles", whole.faces.size()},
          {"triangles_shown", mesh.faces.size()},
          {"vertices", PackVectors(mesh.vertices)},
          {"faces", PackUint32(faces)}};
}

}  // namespace

std::string ScriptText(const Json& data) {
  const std::string dumped = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  text.reserve(dumped.size());
  for (size_t at = 0;;) {
    const size_t open = dumped.find('<', at);
    text.append(dumped, at, open - at);
    if (open == std::string::npos) return text;
    text += "\\u003c";
    at = open + 1;
  }
}

Json Matrix(const Pose& pose) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) rows.push_back(pose.matrix()(i, j));
  return rows;
}

Json Degrees(const Joints& angles) {
  Json list = Json::array();
  for (double angle : angles) list.push_back(RadToDeg(angle));
  return list;
}

std::string PackPoses(const std::vector<Pose>& poses) {
  std::vector<float> values;
  values.reserve(12 * poses.size());
  for (const Pose& pose : poses)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) values.push_back(static_cast<float>(pose.matrix()(i, j)));
  return PackFloats(values);
}

std::string PackVectors(const std::vector<Eigen::Vector3d>& vectors) {
  std::vector<float> values;
  values.reserve(3 * vectors.size());
  for (const Eigen::Vector3d& v : vectors)
    for (double x : v) values.push_back(static_cast<float>(x));
  return PackFloats(values);
}

Json ArmJson(const Arm& arm) {
  return {{"name", arm.name},
          {"d1", arm.d1},
          {"a1", arm.a1},
          {"dy", arm.dy},
          {"a2", arm.a2},
          {"d4", arm.d4},
          {"dz", arm.dz},
          {"parallel", arm.family == ArmFamily::kParallelAxes},
          {"d5", arm.d5},
          {"d6", arm.d6},
          {"sign", arm.sign},
          {"offset_deg", Degrees(arm.offset)},
          {"lower_deg", Degrees(arm.lower)},
          {"upper_deg", Degrees(arm.upper)},
          {"speed_deg_s", Degrees(arm.speed)}};
}

Json BodiesJson(const Cell& cell, const HtmlLimits& limits) {
  Json bodies = Json::array();
  for (const Body& body : cell.bodies)
    if (body.body_class != BodyClass::kStock) bodies.push_back(BodyJson(body, limits));
  return bodies;
}

}  // namespace millpose::html
