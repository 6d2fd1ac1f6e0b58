// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/counted.hpp"
#include "base/shown.hpp"
#include "base/units.hpp"
#include "run/pipeline/commands/advise_text.hpp"
#include "run/pipeline/commands/arm_json.hpp"
#include "run/pipeline/commands/check.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

std::string Size(const Eigen::Vector3d& size) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x(), size.y(), size.z());
}

Json ToList(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// Name of the solid that a STEP face belongs to; of a model with several.
std::string BodyOf(const ImportReport& report, const MeshCheck::Face& face) {
  if (report.bodies.size() < 2 || face.number > report.body_of_source.size()) return "";
  const int body = report.body_of_source[face.number - 1];
  return body < 0 ? "" : report.bodies[static_cast<size_t>(body)].name;
}

Json BodiesJson(const ImportReport& report) {
  Json list = Json::array();
  for (const ImportedBody& body : report.bodies)
    list.push_back({{"name", body.name},
                    {"pieces", body.pieces},
                    {"closed_pieces", body.closed_pieces},
                    {"area_mm2", body.area}});
  return list;
}

Json FacesJson(const MeshCheck& check, bool from_step) {
  const std::vector<MeshCheck::Face>& faces = check.faces;
  Json list = Json::array();
  for (const MeshCheck::Face& face : faces) {
    Json entry{{"number", face.number}};
    if (from_step) {
      entry["id"] = face.source.id;
      entry["name"] = face.source.name;
      entry["kind"] = face.source.kind;
      entry["body"] = BodyOf(check.report, face);
    }
    entry["area_mm2"] = face.source.area;
    const bool seen = face.part.triangles > 0;
    entry["place_mm"] = seen ? ToList(face.part.place) : Json();
    entry["normal"] = seen ? ToList(face.part.normal) : Json();
    entry["radius_mm"] = face.part.radius > 0 ? Json(face.part.radius) : Json();
    list.push_back(std::move(entry));
  }
  return list;
}

/// "at (1.0, 2.0, 3.0) mm looking (0.00, 0.00, 1.00), radius 5.000 mm".
std::string WhereText(const FacePart& part) {
  if (part.triangles == 0) return "without triangles";
  // Of noise, no minus before a zero.
  const Eigen::Vector3d n = ((part.normal * 1000).array().round() / 1000 + 0.0).matrix();
  std::string text = fmt::format("at ({:.1f}, {:.1f}, {:.1f}) mm looking ({:.3f}, {:.3f}, {:.3f})",
                                 part.place.x(), part.place.y(), part.place.z(), n.x(), n.y(), n.z());
  if (part.radius > 0) text += fmt::format(", radius {:.3f} mm", part.radius);
  return text;
}

Json HolesJson(const std::vector<MeshCheck::Holes>& all) {
  Json list = Json::array();
  for (const MeshCheck::Holes& holes : all)
    list.push_back({{"diameter_mm", holes.diameter},
                    {"through", holes.through},
                    {"blind", holes.blind},
                    {"in_sheet", holes.rims}});
  return list;
}

// Of the area, on closed pieces: where outside is certain.
double ClosedShare(const ImportReport& report) {
  return report.area > 0 ? report.closed_area / report.area : 0;
}

Json MeshJson(const MeshCheck& check) {
  const ImportReport& report = check.report;
  const RepairCounts& repairs = report.repairs;
  return {{"file", check.file},
          {"triangles_read", report.triangles_read},
          {"triangles", report.triangles},
          {"vertices", report.vertices},
          {"unit_mm", check.unit},
          {"unit_plausible", check.unit_plausible},
          {"lower_mm", ToList(report.lower)},
          {"upper_mm", ToList(report.upper)},
          {"area_mm2", report.area},
          {"pieces", report.pieces},
          {"closed_pieces", report.closed_pieces},
          {"bodies", BodiesJson(report)},
          {"rims", report.rims},
          {"rim_length_mm", report.rim_length},
          {"repairs",
           {{"welded", report.welded},
            {"t_junctions", repairs.t_junctions},
            {"degenerate", repairs.degenerate},
            {"duplicate", repairs.duplicate},
            {"flipped", repairs.flipped},
            {"turned_pieces", repairs.turned_pieces},
            {"non_manifold_edges", repairs.non_manifold_edges},
            {"non_manifold_vertices", repairs.non_manifold_vertices},
            {"not_orientable_edges", repairs.not_orientable_edges}}},
          {"closed_area_share", ClosedShare(report)},
          {"median_bend_deg", RadToDeg(check.median_bend)},
          {"creases", check.creases},
          {"crossings", report.crossings.pairs},
          {"crossings_complete", report.crossings.complete},
          {"step_faces", check.from_step ? FacesJson(check, true) : Json::array()},
          {"mesh_faces", check.from_step ? Json::array() : FacesJson(check, false)},
          {"round_holes", HolesJson(check.holes)},
          {"warnings", check.warnings},
          {"notes", check.notes}};
}

std::string_view NameOf(SpindleSense sense) {
  if (sense == SpindleSense::kNotStated) return "not_stated";
  return sense == SpindleSense::kClockwise ? "clockwise" : "counter_clockwise";
}

// Null for a path that no file gave.
Json SourceJson(const std::optional<CamSource>& source) {
  if (!source) return {};
  Json sections = Json::array();
  for (const CamSection& section : source->sections)
    sections.push_back({{"tool", section.tool},
                        {"cutter_mm", RoundedOrNull(section.diameter, 1)},
                        {"corner_radius_mm", section.corner_radius},
                        {"spindle_rpm", RoundedOrNull(section.speed, 60)},
                        {"spindle_sense", NameOf(section.sense)},
                        {"first_line", section.first_line},
                        {"last_line", section.last_line}});
  return {{"sender", source->sender},
          {"unit", source->unit},
          {"frame", source->frame},
          {"three_numbers", source->three_numbers.empty() ? Json() : Json(source->three_numbers)},
          {"sections", std::move(sections)}};
}

/// Numbers of an external axis from mm and rad to what its unit says.
struct AxisUnit {
  explicit AxisUnit(const ExternalAxis& axis)
      : linear(axis.kind == AxisKind::kLinear),
        factor(linear ? 1 : kDegPerRad),
        name(linear ? "mm" : "deg") {}
  bool linear;
  double factor;
  const char* name;
};

/// "linear, carries the robot, -2000 to 2000 mm, home 0 mm, 1000 mm/s, 500 mm/s²".
std::string AxisText(const ExternalAxis& axis) {
  const AxisUnit unit(axis);
  return fmt::format(
      "{}, carries the {}, {:.6g} to {:.6g} {unit}, home {:.6g} {unit}, {:.6g} {unit}/s, {:.6g} "
      "{unit}/s², {}",
      WordOf(kAxisKindWords, axis.kind), WordOf(kCarriesWords, axis.carries), unit.factor * axis.lower,
      unit.factor * axis.upper, unit.factor * axis.home, unit.factor * axis.speed,
      unit.factor * axis.acceleration, axis.compliance ? "yields" : "taken as stiff",
      fmt::arg("unit", unit.name));
}

Json AxesJson(const std::vector<ExternalAxis>& axes) {
  Json list = Json::array();
  for (const ExternalAxis& axis : axes) {
    const AxisUnit unit(axis);
    list.push_back({{"name", axis.name},
                    {"kind", WordOf(kAxisKindWords, axis.kind)},
                    {"carries", WordOf(kCarriesWords, axis.carries)},
                    {"unit", unit.name},
                    {"limits", {unit.factor * axis.lower, unit.factor * axis.upper}},
                    {"home", unit.factor * axis.home},
                    {"speed_per_s", unit.factor * axis.speed},
                    {"acceleration_per_s2", unit.factor * axis.acceleration}});
  }
  return list;
}

Json JobJson(const JobCheck& check) {
  Json json{{"job", check.job},
            {"cell", check.cell},
            {"arm", check.arm},
            {"for_arm", check.for_arm.empty() ? Json() : Json(check.for_arm)},
            {"mesh", MeshJson(check.mesh)},
            {"passes", check.passes},
            {"points", check.points},
            {"cam", SourceJson(check.source)},
            {"reach",
             {{"admissible", check.reach[0]},
              {"unreachable", check.reach[1]},
              {"limit", check.reach[2]},
              {"singular", check.reach[3]}}},
            {"limited_by_axis", check.limited},
            {"out_of_reach", check.out_of_reach},
            {"gouges", check.gouges},
            {"deepest_gouge_mm", check.deepest_gouge},
            {"gouge_place_mm", check.gouges > 0 ? ToList(check.gouge_place) : Json()}};
  if (!check.operation.empty()) json["operation"] = check.operation;
  if (check.advice) json["advice"] = Json::parse(ToJson(*check.advice));
  return json;
}

}  // namespace

std::string ToText(const MeshCheck& check) {
  const ImportReport& report = check.report;
  std::string text = fmt::format("mesh                {}\n", check.file.empty() ? "none" : check.file);
  text += fmt::format("size                {}\n", Size(report.upper - report.lower));
  text +=
      fmt::format("unit                {:.6g} mm, {}\n", check.unit,
                  check.unit_plausible ? "plausible for the arm" : "not plausible for the arm, see below");
  text += fmt::format("triangles           {} read, {} after repair, {} vertices\n", report.triangles_read,
                      report.triangles, report.vertices);
  text += fmt::format("area                {:.6g} mm²\n", report.area);
  text += fmt::format("pieces              {}, {} of them closed\n", report.pieces, report.closed_pieces);
  for (size_t i = 0; report.bodies.size() > 1 && i < report.bodies.size(); ++i) {
    const ImportedBody& body = report.bodies[i];
    text += fmt::format("body {:<15}{:>14.6g} mm²  {}{}\n", i + 1, body.area, Shown(body.name),
                        body.closed_pieces == body.pieces ? "" : ", open");
  }
  text += fmt::format("rims                {}, {:.4g} mm\n", report.rims, report.rim_length);
  text += fmt::format(
      "normals             outside is certain on {:.1f} % of the area; facets bend by {:.2g}° in the "
      "median; {} edges are creases (above 30°)\n",
      100 * ClosedShare(report), RadToDeg(check.median_bend), check.creases);
  for (const MeshCheck::Face& face : check.faces) {
    const std::string where = WhereText(face.part);
    const std::string body = BodyOf(report, face);
    if (check.from_step)
      text +=
          fmt::format("STEP face {:<10}{:<8} {:<10}{:>14.6g} mm²  {}{}{}{}\n", face.number, face.source.id,
                      face.source.kind, face.source.area, where, face.source.name.empty() ? "" : "  ",
                      face.source.name, body.empty() ? "" : "  of " + Shown(body));
    else
      text += fmt::format("face {:<15}{:>14.6g} mm²  {}\n", face.number, face.source.area, where);
  }
  for (const MeshCheck::Holes& holes : check.holes)
    text += fmt::format("round holes         {:.3f} mm: {} through, {} blind, {} in sheet\n", holes.diameter,
                        holes.through, holes.blind, holes.rims);
  for (const std::string& warning : check.warnings) text += "  - " + warning + "\n";
  for (const std::string& note : check.notes) text += "  - note: " + note + "\n";
  return text;
}

std::string ToText(const JobCheck& check) {
  const auto share = [&](size_t count) {
    return fmt::format("{} ({:.1f} %)", count,
                       100.0 * static_cast<double>(count) / static_cast<double>(check.points));
  };
  std::string text =
      fmt::format("job                 {}, cell {}, arm {}\n", check.job, check.cell, check.arm);
  if (!check.for_arm.empty())
    text += fmt::format("programs            for this arm alone: {}\n", check.for_arm);
  if (!check.operation.empty()) text += fmt::format("operation           {}\n", check.operation);
  text += ToText(check.mesh);
  text += fmt::format("tool path           {} points in {}\n", check.points, CountedPasses(check.passes));
  text += fmt::format("within reach        {}\n", share(check.reach[0]));
  const std::array<const char*, 4> reasons{"", "too far or too near", "outside the limits",
                                           "near a singularity"};
  for (size_t i = 1; i < 4; ++i)
    if (check.reach[i] > 0) text += fmt::format("{:<20}{}\n", reasons[i], share(check.reach[i]));
  for (size_t axis = 0; axis < check.limited.size(); ++axis)
    if (check.limited[axis] > 0)
      text += fmt::format("  farthest: A{:<7}{}\n", axis + 1, share(check.limited[axis]));
  if (!check.out_of_reach.empty())
    text += fmt::format("first of these      points {}\n", fmt::join(check.out_of_reach, ", "));
  text += fmt::format("gouges              {}", check.gouges);
  if (check.gouges > 0)
    text +=
        fmt::format(", deepest {:.3f} mm at ({:.3f}, {:.3f}, {:.3f}) mm in the workpiece frame",
                    check.deepest_gouge, check.gouge_place.x(), check.gouge_place.y(), check.gouge_place.z());
  text += "\n";
  return check.advice ? text + ToText(*check.advice) : text;
}

std::string ToText(const CellCheck& check) {
  std::string text = fmt::format("cell                {}, arm {}\n", check.cell, check.arm);
  text += fmt::format("bodies              {}\n", check.bodies);
  text += fmt::format("reach               {:.4g} mm from axis 1 to the tool's tip\n", check.reach);
  text +=
      fmt::format("controllers         {}\n",
                  check.controllers.empty() ? "none" : fmt::format("{}", fmt::join(check.controllers, ", ")));
  for (const ExternalAxis& axis : check.external_axes)
    text += fmt::format("external axis       {}: {}\n", axis.name, AxisText(axis));
  text += ToText(check.arrival) + ToText(check.measured);
  for (const std::string& warning : check.warnings) text += "  - " + warning + "\n";
  return text;
}

std::string ToJson(const CellCheck& check) {
  const Json json{{"cell", check.cell},
                  {"arm", check.arm},
                  {"bodies", check.bodies},
                  {"reach_mm", check.reach},
                  {"controllers", check.controllers},
                  {"external_axes", AxesJson(check.external_axes)},
                  {"arrival", ArrivalJson(check.arrival)},
                  {"measured", MeasuredJson(check.measured)},
                  {"warnings", check.warnings}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToJson(const MeshCheck& check) {
  return MeshJson(check).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string ToJson(const JobCheck& check) {
  return JobJson(check).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToJson(const std::vector<JobCheck>& operations) {
  Json list = Json::array();
  for (const JobCheck& check : operations) list.push_back(JobJson(check));
  return Json{{"operations", list}}.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
