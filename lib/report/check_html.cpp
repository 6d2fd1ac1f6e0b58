// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/check_html.hpp"

#include <limits>

#include "base/units.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"
#include "report/page/escaped.hpp"
#include "report/page/web_page.hpp"
#include "report/view_mesh.hpp"
#include "report/web_assets.hpp"

namespace millpose {
namespace {

using namespace html;

constexpr size_t kEdges = 3000;            // the longest of a part that has more
constexpr size_t kPartTriangles = 150000;  // drawn with all of them up to here, else thinned

Json Place(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json FacesJson(const Mesh& mesh, const MeshParts& parts) {
  Json list = Json::array();
  const std::vector<SourceFace>& source = mesh.triangles().source_faces;
  for (size_t i = 0; i < parts.faces.size(); ++i) {
    const FacePart& face = parts.faces[i];
    list.push_back({{"number", i + 1},
                    {"id", i < source.size() ? source[i].id : ""},
                    {"name", i < source.size() ? source[i].name : ""},
                    {"kind", i < source.size() ? source[i].kind : ""},
                    {"area_mm2", i < source.size() ? source[i].area : face.area},
                    {"triangles", face.triangles},
                    {"place_mm", Place(face.place)},
                    {"normal", Place(face.normal)}});
  }
  return list;
}

Json EdgesJson(const Mesh& mesh, const MeshParts& parts) {
  double shortest = 0;
  if (parts.edges.size() > kEdges) {
    std::vector<double> lengths;
    for (const EdgePart& edge : parts.edges) lengths.push_back(edge.length);
    std::ranges::nth_element(lengths, lengths.begin() + kEdges, std::greater<>());
    shortest = lengths[kEdges];
  }
  Json list = Json::array();
  for (size_t i = 0; i < parts.edges.size(); ++i) {
    const EdgePart& edge = parts.edges[i];
    if (edge.length < shortest) continue;
    std::vector<Eigen::Vector3d> ends;
    for (const auto& side : edge.sides)
      for (const int end : side) ends.push_back(mesh.triangles().vertices[static_cast<size_t>(end)]);
    list.push_back({{"number", i + 1},
                    {"faces", {edge.first + 1, edge.second + 1}},
                    {"length_mm", edge.length},
                    {"closed", edge.closed},
                    {"place_mm", Place(edge.place)},
                    {"normal", Place(edge.normal)},
                    {"sides_mm", PackVectors(ends)}});
  }
  return list;
}

Json PartJson(const CheckHtmlInput& input) {
  if (!input.part || input.part->face_count() == 0) return nullptr;
  const Mesh& mesh = *input.part;
  const MeshParts parts = FindMeshParts(mesh);
  const Triangles drawn = ThinnedMesh(mesh.triangles(), kPartTriangles);
  const bool thinned = drawn.faces.size() != mesh.triangles().faces.size();
  std::vector<uint32_t> faces, face_of, region;
  for (size_t i = 0; i < drawn.faces.size(); ++i) {
    size_t from = i;
    if (thinned) {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const int v : drawn.faces[i]) middle += drawn.vertices[static_cast<size_t>(v)] / 3;
      from = static_cast<size_t>(mesh.Closest(middle).face);
    }
    for (const int v : drawn.faces[i]) faces.push_back(static_cast<uint32_t>(v));
    face_of.push_back(static_cast<uint32_t>(parts.face_of[from]));
    region.push_back(from < input.in_region.size() ? static_cast<uint32_t>(input.in_region[from]) : 0);
  }
  return {{"vertices", PackVectors(drawn.vertices)}, {"triangles", PackUint32(faces)},
          {"triangles_of_file", mesh.face_count()},  {"face_of", PackUint32(face_of)},
          {"in_region", PackUint32(region)},         {"solid_model", !mesh.triangles().source_faces.empty()},
          {"faces", FacesJson(mesh, parts)},         {"edges", EdgesJson(mesh, parts)}};
}

Json PathJson(const CheckHtmlInput& input, size_t limit) {
  if (!input.toolpath) return nullptr;
  size_t total = 0;
  for (const Pass& pass : input.toolpath->passes) total += pass.points.size();
  const size_t stride = std::max<size_t>(1, (total + limit - 1) / limit);
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::vector<uint32_t> number, pass_of, kind, state, axis;
  std::vector<float> way, reserve, joints;
  std::vector<Eigen::Vector3d> position, normal, tool_axis;
  uint32_t next = 0;
  double begin = 0;
  for (size_t p = 0; p < input.toolpath->passes.size(); ++p) {
    const Pass& pass = input.toolpath->passes[p];
    for (size_t i = 0; i < pass.points.size(); ++i, ++next) {
      const PointReach& reach = input.reach.at(next);
      if (i % stride != 0 && i + 1 != pass.points.size() && reach.best == Infeasibility::kNone) continue;
      const MillingPoint& point = pass.points[i];
      const bool reached = reach.best != Infeasibility::kUnreachable;
      number.push_back(next);
      pass_of.push_back(static_cast<uint32_t>(p));
      kind.push_back(static_cast<uint32_t>(point.kind));
      state.push_back(static_cast<uint32_t>(reach.best));
      axis.push_back(reached && reach.axis >= 0 ? static_cast<uint32_t>(reach.axis) + 1 : 0);
      way.push_back(static_cast<float>(begin + point.arc_length));
      reserve.push_back(reached ? static_cast<float>(RadToDeg(reach.reserve)) : kNone);
      for (const double q : reach.q) joints.push_back(reached ? static_cast<float>(RadToDeg(q)) : kNone);
      position.push_back(point.position);
      normal.push_back(point.normal);
      tool_axis.push_back(point.tool_axis);
    }
    if (!pass.points.empty()) begin += pass.points.back().arc_length;
  }
  return {{"passes", input.toolpath->passes.size()},
          {"total", total},
          {"number", PackUint32(number)},
          {"pass", PackUint32(pass_of)},
          {"kind", PackUint32(kind)},
          {"state", PackUint32(state)},
          {"axis", PackUint32(axis)},
          {"way_mm", PackFloats(way)},
          {"reserve_deg", PackFloats(reserve)},
          {"joints_deg", PackFloats(joints)},
          {"position_mm", PackVectors(position)},
          {"normal", PackVectors(normal)},
          {"tool_axis", PackVectors(tool_axis)}};
}

Json CellJson(const CheckHtmlInput& input, const HtmlLimits& limits) {
  if (!input.cell) return nullptr;
  Cell cell = *input.cell;
  std::erase_if(cell.bodies, [](const Body& body) { return body.body_class == BodyClass::kWorkpiece; });
  return {{"name", cell.name},
          {"arm", ArmJson(cell.arm)},
          {"home_deg", Degrees(cell.home)},
          {"X_WB", Matrix(cell.X_WB)},
          {"X_FT", Matrix(cell.X_FT)},
          {"X_WP", Matrix(cell.X_WP)},
          {"bodies", BodiesJson(cell, limits)}};
}

}  // namespace

std::string CheckHtml(const CheckHtmlInput& input, const HtmlLimits& limits) {
  const Json data{{"format", 1},
                  {"title", input.title},
                  {"cell", CellJson(input, limits)},
                  {"part", PartJson(input)},
                  {"path", PathJson(input, limits.points)},
                  {"measured", input.measured},
                  {"removal", RemovalJson(input.removal)},
                  {"findings", input.findings},
                  {"notes", input.notes},
                  {"text", input.text},
                  {"settings", input.settings}};
  std::string picture;
  if (input.wrong_side && input.cell) {
    const Mesh none{Triangles()};
    picture = "<figure id=\"wrong-side\" class=\"card\">" +
              SideView(*input.cell, input.part ? *input.part : none, *input.wrong_side) + "</figure>";
  }
  const std::string title = Escaped(input.title), text = ScriptText(data),
                    language = WordOf(kLanguageWords, input.language),
                    words = std::string(kWordsOfPage) + std::string(kWordsOfCheck);
  return FilledPage(kWebCheckPage, {{"title", title},
                                    {"language", language},
                                    {"words", words},
                                    {"style", kWebStyle},
                                    {"license", kWebLicense},
                                    {"three", kWebThree},
                                    {"scripts", kWebCheckScripts},
                                    {"picture", picture},
                                    {"data", text}});
}

}  // namespace millpose
