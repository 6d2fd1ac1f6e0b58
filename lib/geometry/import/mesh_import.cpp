// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/mesh_import.hpp"

#include "base/error.hpp"
#include "base/shown.hpp"
#include "geometry/import/weld.hpp"
#include "geometry/mesh/pieces.hpp"

namespace millpose {
namespace {

// Rims are loops of open sides; each vertex of a manifold starts at most one open side.
void MeasureRims(const Mesh& mesh, ImportReport& report) {
  std::vector<int> next(mesh.triangles().vertices.size(), -1);
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k)
      if (mesh.Neighbour(face, k) < 0) {
        const auto& corners = mesh.triangles().faces[face];
        const int from = corners[k], to = corners[(k + 1) % 3];
        next[from] = to;
        report.rim_length += (mesh.triangles().vertices[to] - mesh.triangles().vertices[from]).norm();
      }
  for (size_t start = 0; start < next.size(); ++start) {
    if (next[start] < 0) continue;
    ++report.rims;
    for (int at = static_cast<int>(start); at >= 0;) at = std::exchange(next[at], -1);
  }
}

void MeasurePieces(const Mesh& finished, ImportReport& report) {
  const Triangles& mesh = finished.triangles();
  for (const ConnectedPiece& piece : PiecesOf(finished)) {
    double area = 0;
    for (const int face : piece.faces) {
      const auto& [a, b, c] = mesh.faces[face];
      area += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
    }
    ++report.pieces;
    report.area += area;
    if (piece.closed) ++report.closed_pieces, report.closed_area += area;
    const int body =
        report.body_of_source.empty() ? -1 : report.body_of_source[mesh.source[piece.faces.front()]];
    if (body < 0) continue;
    ++report.bodies[body].pieces;
    report.bodies[body].closed_pieces += piece.closed ? 1 : 0;
    report.bodies[body].area += area;
  }
}

// The body of each triangle; empty where there is none or one alone.
std::vector<int> BodyOfFaces(const RawMesh& raw) {
  std::vector<int> body_of;
  if (raw.bodies.size() < 2) return body_of;
  for (const int source : raw.triangles.source) body_of.push_back(raw.body_of_source[source]);
  return body_of;
}

// Coordinates are bounded so that no product of four of them overflows.
void Scale(Triangles& triangles, double unit, const std::string& name) {
  constexpr double kLargest = 1e9;  // mm
  for (Eigen::Vector3d& p : triangles.vertices) {
    p *= unit;
    if (!(p.cwiseAbs().maxCoeff() <= kLargest))
      throw InputError(
          {name},
          fmt::format("a vertex at ({:.6g}, {:.6g}, {:.6g}) mm lies beyond ±{} mm: is the unit right?", p.x(),
                      p.y(), p.z(), kLargest));
  }
}

// "18 bodies: skin, rib, rib (2), …"
std::string NamesOf(const std::vector<ImportedBody>& bodies) {
  constexpr size_t kShown = 8;
  std::string text = fmt::format("{} bodies", bodies.size());
  for (size_t i = 0; i < std::min(kShown, bodies.size()); ++i)
    text += (i == 0 ? ": " : ", ") + Shown(bodies[i].name, 60);
  return text + (bodies.size() > kShown ? ", …" : "");
}

}  // namespace

ImportResult ImportMesh(RawMesh raw, const ImportOptions& options, const std::string& name) {
  if (raw.stated_unit && *raw.stated_unit != options.unit)
    throw InputError({name}, fmt::format("the file states that its unit is {:.6g} mm, given {:.6g} mm",
                                         *raw.stated_unit, options.unit));
  ImportReport report;
  report.notes = std::move(raw.notes);
  report.triangles_read = raw.triangles.faces.size();
  Scale(raw.triangles, options.unit, name);
  Triangles mesh = Weld(raw.triangles, options.weld_tolerance, &report.welded, BodyOfFaces(raw));
  for (std::string& body : raw.bodies) report.bodies.push_back({std::move(body)});
  report.body_of_source = std::move(raw.body_of_source);
  raw = {};
  RemoveDegenerate(mesh, options.weld_tolerance, report.repairs);
  RemoveDuplicates(mesh, report.repairs);
  if (mesh.faces.empty())
    throw InputError({name},
                     fmt::format("none of the {} triangles has an area above the weld tolerance of {} mm: is "
                                 "the unit right?",
                                 report.triangles_read, options.weld_tolerance));
  MakeManifold(mesh, report.repairs);
  if (options.flip && FlipOpenPieces(mesh) == 0)
    throw InputError({name},
                     "flip: every piece is closed, so its outside is known; only open sheets can be flipped");
  DropUnusedVertices(mesh);
  ImportResult result{Mesh(std::move(mesh)), std::move(report)};
  const Triangles& done = result.mesh.triangles();
  result.report.triangles = done.faces.size();
  result.report.vertices = done.vertices.size();
  Eigen::AlignedBox3d box;
  for (const auto& p : done.vertices) box.extend(p);
  result.report.lower = box.min();
  result.report.upper = box.max();
  MeasureRims(result.mesh, result.report);
  MeasurePieces(result.mesh, result.report);
  for (size_t i = 0; i < done.source_faces.size(); ++i)
    if (done.source_faces[i].lost) result.report.lost_faces.push_back(DescribeLost(done, i));
  result.report.crossings = FindSelfCrossings(
      result.mesh, result.report.bodies.size() > 1 ? result.report.body_of_source : std::vector<int>());
  return result;
}

std::string DescribeLost(const Triangles& mesh, size_t number) {
  const SourceFace& face = mesh.source_faces[number];
  return fmt::format(
      "STEP face {} ({}{}{}, {:.4g} mm²) between ({:.6g}, {:.6g}, {:.6g}) and ({:.6g}, {:.6g}, {:.6g}) mm "
      "could not be cut into triangles",
      number + 1, face.id == "#0" ? "" : face.id + ", ", face.kind,
      face.name.empty() ? "" : ", " + Shown(face.name), face.area, face.lower.x(), face.lower.y(),
      face.lower.z(), face.upper.x(), face.upper.y(), face.upper.z());
}

std::vector<std::string> Findings(const ImportReport& report) {
  std::vector<std::string> findings = report.notes;
  std::ranges::copy(report.lost_faces, std::back_inserter(findings));
  const auto tell = [&](size_t count, std::string_view one, std::string_view many) {
    if (count > 0) findings.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
  };
  const RepairCounts& repairs = report.repairs;
  tell(report.welded, "vertex was joined with a neighbour within the weld tolerance",
       "vertices were joined with a neighbour within the weld tolerance");
  tell(repairs.t_junctions, "triangle was split at a vertex on its open edge",
       "triangles were split at a vertex on their open edge");
  tell(repairs.degenerate, "triangle without area was removed", "triangles without area were removed");
  tell(repairs.duplicate, "triangle that was there twice was removed",
       "triangles that were there twice were removed");
  tell(repairs.flipped, "triangle was turned to fit its neighbours",
       "triangles were turned to fit their neighbours");
  tell(repairs.turned_pieces, "closed piece was inside out and was turned",
       "closed pieces were inside out and were turned");
  tell(repairs.non_manifold_edges, "edge of more than two triangles was taken apart",
       "edges of more than two triangles were taken apart");
  tell(repairs.non_manifold_vertices, "vertex in which several fans of triangles met was doubled",
       "vertices in which several fans of triangles met were doubled");
  tell(repairs.not_orientable_edges, "edge was cut because no orientation fits both sides",
       "edges were cut because no orientation fits both sides");
  if (const SelfCrossings& crossings = report.crossings; crossings.pairs > 0 || !crossings.complete)
    findings.push_back(fmt::format(
        "{}{} pair{} of triangles cross or touch each other, first at ({:.6g}, {:.6g}, {:.6g}) mm",
        crossings.complete ? "" : "search given up: at least ", crossings.pairs,
        crossings.pairs == 1 ? "" : "s", crossings.place.x(), crossings.place.y(), crossings.place.z()));
  if (report.rims > 0)
    findings.push_back(fmt::format("{} open rim{}, {:.1f} mm long{}; holes stay open", report.rims,
                                   report.rims == 1 ? "" : "s", report.rim_length,
                                   report.rims == 1 ? "" : " together"));
  if (report.pieces > 1)
    findings.push_back(fmt::format("{} unconnected pieces, {} of them closed{}", report.pieces,
                                   report.closed_pieces,
                                   report.bodies.size() > 1 ? "; " + NamesOf(report.bodies) : ""));
  return findings;
}

std::optional<std::string> UnitWarning(double extent, double reach) {
  // Parts from 1/100 of the reach (25 mm for a large arm) to four times the reach (a cabin that the arm mills
  // a part of) are plausible.
  const auto plausible = [&](double length) { return length >= reach / 100 && length <= 4 * reach; };
  if (plausible(extent)) return std::nullopt;
  struct Unit {
    double factor;
    const char* text;
  };
  const std::array<Unit, 6> units{{{1000, "1000 times larger (metres given as mm?)"},
                                   {25.4, "25.4 times larger (inches given as mm?)"},
                                   {10, "10 times larger (centimetres given as mm?)"},
                                   {1.0 / 1000, "1000 times smaller (mm given as metres?)"},
                                   {1.0 / 25.4, "25.4 times smaller (mm given as inches?)"},
                                   {1.0 / 10, "10 times smaller (mm given as centimetres?)"}}};
  std::string warning = fmt::format("the part is {:.4g} mm long, the arm reaches {:.4g} mm", extent, reach);
  std::string fits;
  for (const Unit& unit : units)
    if (plausible(extent * unit.factor))
      fits += (fits.empty() ? "; it would fit if it were " : " or ") + std::string(unit.text);
  return warning + (fits.empty() ? "; check the unit" : fits);
}

}  // namespace millpose
