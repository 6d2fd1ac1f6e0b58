// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/setup_views.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "planning/result/station.hpp"
#include "report/setup_picture.hpp"
#include "report/view_mesh.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Sums over the milled points, in P: which side of the part they are on.
struct MilledSide {
  Vector3d normals = Vector3d::Zero(), axes = Vector3d::Zero();
};

std::vector<ExternalPosition> StationsOf(std::span<const OperationWithTree> operations) {
  std::vector<ExternalPosition> stations;
  for (const OperationWithTree& one : operations)
    for (const PassResult& pass : one.plan.passes)
      if (std::ranges::find(stations, pass.external) == stations.end()) stations.push_back(pass.external);
  if (stations.empty()) stations.push_back(Mechanism(operations.front().plan.external_axes).Home());
  return stations;
}

/// Lines of the tips of a pass in P, one for each piece that is milled.
std::vector<std::vector<Vector3d>> CutsOf(const PlanResult& plan, const PassResult& pass, MilledSide& side) {
  std::vector<std::vector<Vector3d>> cuts;
  for (const Segment& piece : pass.pieces) {
    std::vector<Vector3d>& cut = cuts.emplace_back();
    for (int i = piece.first; i <= piece.last; ++i) {
      const auto k = static_cast<size_t>(i);
      const MillingPoint& point = pass.points[k].point;
      const Pose X_PW = PartAt(plan, ExternalAt(pass, k)).inverse();
      cut.push_back(X_PW * point.position);
      side.normals += X_PW.linear() * point.normal;
      side.axes += X_PW.linear() * point.tool_axis;
    }
  }
  return cuts;
}

void AddSkipped(const PlanResult& plan, const PassResult& pass, std::vector<Vector3d>& skipped) {
  for (size_t k = 0; k < pass.points.size(); ++k)
    if (pass.points[k].skip != Infeasibility::kNone)
      skipped.push_back(PartAt(plan, ExternalAt(pass, k)).inverse() * pass.points[k].point.position);
}

/// What the operations mill at `station`, into the picture; what they mill at others, as well.
MilledSide AddPaths(std::span<const OperationWithTree> operations, const ExternalPosition& station,
                    SetupPicture& picture) {
  MilledSide side;
  for (const OperationWithTree& one : operations) {
    PicturePath& path = picture.paths.emplace_back();
    for (const PassResult& pass : one.plan.passes) {
      const bool here = pass.external == station;
      MilledSide other;
      std::ranges::move(CutsOf(one.plan, pass, here ? side : other),
                        std::back_inserter(here ? path.cuts : picture.elsewhere));
      if (here) AddSkipped(one.plan, pass, path.skipped);
    }
  }
  return side;
}

/// The part and its fixtures as they stand at `station`, in P.
void AddSolids(const Cell& cell, const PlanResult& plan, const Mesh& part, const ExternalPosition& station,
               SetupPicture& picture) {
  if (part.face_count() > 0) picture.solids.push_back({part.triangles(), true});
  const Pose X_PW = PartAt(plan, station).inverse();
  for (const Body& body : cell.bodies) {
    if (body.body_class != BodyClass::kFixture) continue;
    Pose X_PM = X_PW;
    if (body.mount == Mount::kWorkpiece)
      X_PM = Pose::Identity();
    else if (body.mount == Mount::kCarriage)
      X_PM = X_PW * Mechanism(plan.external_axes).MovedWith(static_cast<size_t>(body.axis), station);
    else if (body.mount != Mount::kWorld)
      continue;  // on the arm
    PictureSolid solid{ViewMesh(body.shape), false};
    for (Vector3d& p : solid.mesh.vertices) p = X_PM * (body.X_MG * p);
    picture.solids.push_back(std::move(solid));
  }
}

/// From the side that is milled, a little from above and aside, so that neither face nor depth is lost.
Vector3d Towards(const MilledSide& side, const SetupPicture& picture) {
  const Vector3d looked = side.normals.norm() > 1e-6 ? side.normals.normalized()
                          : side.axes.norm() > 1e-6  ? side.axes.normalized()
                                                     : picture.up;
  Vector3d aside = picture.up.cross(looked);
  if (aside.norm() < 0.3) aside = picture.arm - picture.arm.dot(looked) * looked;
  if (aside.norm() > 1e-6) aside.normalize();
  return looked + 0.45 * picture.up + 0.45 * aside;
}

/// "0–3, 7": passes that are milled at `station`; with the operations' names where there are several.
std::string PassesText(std::span<const OperationWithTree> operations, const ExternalPosition& station) {
  std::vector<std::string> texts;
  for (const OperationWithTree& one : operations) {
    const std::vector<PassResult>& passes = one.plan.passes;
    bool named = operations.size() == 1;
    for (size_t p = 0; p < passes.size(); ++p) {
      if (passes[p].external != station) continue;
      const size_t first = p;
      while (p + 1 < passes.size() && passes[p + 1].external == station) ++p;
      texts.push_back((named ? "" : one.name + " ") +
                      (p == first ? fmt::format("{}", p) : fmt::format("{}–{}", first, p)));
      named = true;
    }
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string NoteOf(std::span<const OperationWithTree> operations, const SetupPicture& picture) {
  std::vector<std::string> names;
  for (size_t i = 0; i < operations.size(); ++i)
    if (!picture.paths[i].cuts.empty()) names.push_back(fmt::format("{} {}", i + 1, operations[i].name));
  return (names.empty() ? "" : fmt::format("Begins at {}; ", fmt::join(names, ", at "))) +
         "x, y, z: the part's frame. Points that are left out are red.";
}

SheetSection ViewAt(std::span<const OperationWithTree> operations, const ExternalPosition& station,
                    const Cell& cell, const Mesh& part, SetupPicture picture) {
  const PlanResult& plan = operations.front().plan;
  const Pose X_PW = PartAt(plan, station).inverse();
  picture.up = X_PW.linear() * Vector3d::UnitZ();
  picture.arm = X_PW * BaseAt(plan, station).translation();
  AddSolids(cell, plan, part, station, picture);
  picture.towards = Towards(AddPaths(operations, station, picture), picture);
  SheetSection section{.title = "Setup"};
  if (!station.empty()) section.title += " at " + PositionText(plan.external_axes, station);
  section.note = NoteOf(operations, picture);
  section.picture = PictureOf(picture);
  return section;
}

}  // namespace

std::vector<SheetSection> SetupViews(std::span<const OperationWithTree> operations, const Cell& cell,
                                     const Mesh& part, Language language) {
  const std::vector<ExternalPosition> stations = StationsOf(operations);
  const size_t shown = std::min(stations.size(), kMostStationPictures);
  SetupPicture empty;
  empty.language = language;
  if (shown > 1) empty.part_faces /= 2;  // the pictures share the page's size
  std::vector<SheetSection> sections;
  for (size_t i = 0; i < shown; ++i) {
    SheetSection section = ViewAt(operations, stations[i], cell, part, empty);
    section.new_page = i % 2 == 0;  // two pictures fill a page
    if (stations.size() > 1)
      section.note =
          fmt::format("Station {} of {}: passes {} are milled here; what is milled elsewhere is grey. {}",
                      i + 1, stations.size(), PassesText(operations, stations[i]), section.note);
    sections.push_back(std::move(section));
  }
  if (std::ranges::any_of(operations, [](const OperationWithTree& one) { return MovesAlong(one.plan); }))
    sections.back().note += " Axes move along passes: pictures are of where these begin.";
  if (shown < stations.size())
    sections.back().note += fmt::format(
        " The first {} of {} stations have a picture; External axes lists them all.", shown, stations.size());
  return sections;
}

}  // namespace millpose
