// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate.hpp"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "recut.hpp"
#include "refine.hpp"
#include "step_progress.hpp"

namespace millpose {
namespace {

constexpr double kAngle = 10 * 0.017453292519943295;  // rad between neighbouring facets of a curved face

// Percent of the way when BRepMesh ends; what is left goes to the faces one by one.
constexpr int kMeshed = 75;

std::string KindOf(const TopoDS_Face& face) {
  switch (BRepAdaptor_Surface(face, Standard_False).GetType()) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_BezierSurface:
    case GeomAbs_BSplineSurface:
      return "spline";
    default:
      return "other";
  }
}

// Where a lost face lies.
void SetPlace(const TopoDS_Face& face, SourceFace& source) {
  Bnd_Box box;
  try {
    BRepBndLib::AddOptimal(face, box, Standard_False, Standard_False);
  } catch (const Standard_Failure&) {
    BRepBndLib::Add(face, box, Standard_False);
  }
  if (box.IsVoid()) return;
  const auto corner = [](const gp_Pnt& p) -> Eigen::Vector3d {
    constexpr double kFar = 1e9;  // mm, of faces without end
    return Eigen::Vector3d(p.X(), p.Y(), p.Z()).cwiseMax(-kFar).cwiseMin(kFar);
  };
  source.lower = corner(box.CornerMin());
  source.upper = corner(box.CornerMax());
}

// The face with triangles, cut in another way where BRepMesh's gave too few; sets whether it is lost.
std::vector<TopoDS_Face> Cut(const TopoDS_Face& face, double chord_tolerance, SourceFace& source) {
  const auto enough = [&] {
    const double cut = TriangleArea(face);
    return cut > 0 && cut >= source.area / 2;
  };
  if (enough()) return {face};
  for (const RecutLength& way : kRecutWays)
    if (std::vector<TopoDS_Face> faces = Recut(face, source.area, chord_tolerance, kAngle, way);
        !faces.empty())
      return faces;
  SetPlace(face, source);
  // Nothing is lost with a face that is narrower than the tolerance. Of an area of 0 nothing is known.
  source.lost = source.area == 0 || source.area > chord_tolerance * (source.upper - source.lower).norm();
  BRepTools::Clean(face);
  const BRepMesh_IncrementalMesh mesher(face, chord_tolerance, Standard_False, kAngle, Standard_False);
  return {face};
}

// Appends the face's triangles, in mm, seen from outside. Returns how far the face lies from them at most.
double Append(const TopoDS_Face& face, int source, double tolerance, Triangles& triangles) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull() || mesh->NbTriangles() == 0) return 0;
  FaceTriangles cut;
  for (int i = 1; i <= mesh->NbNodes(); ++i) {
    const gp_Pnt p = mesh->Node(i).Transformed(location.Transformation());
    cut.points.emplace_back(p.X(), p.Y(), p.Z());
    if (mesh->HasUVNodes()) cut.parameters.emplace_back(mesh->UVNode(i).X(), mesh->UVNode(i).Y());
  }
  const bool inverted = face.Orientation() == TopAbs_REVERSED;
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    std::array<int, 3> corners{};
    mesh->Triangle(i).Get(corners[0], corners[1], corners[2]);
    if (inverted) std::swap(corners[1], corners[2]);
    cut.faces.push_back({corners[0] - 1, corners[1] - 1, corners[2] - 1});
  }
  double deviation = 0;
  if (mesh->HasUVNodes()) {
    const BRepAdaptor_Surface surface(face, Standard_False);
    deviation = Refine(cut, tolerance, [&](const Eigen::Vector2d& at) -> Eigen::Vector3d {
      const gp_Pnt p = surface.Value(at.x(), at.y());
      return {p.X(), p.Y(), p.Z()};
    });
  }
  const auto first = static_cast<int>(triangles.vertices.size());
  triangles.vertices.insert(triangles.vertices.end(), cut.points.begin(), cut.points.end());
  for (const auto& [a, b, c] : cut.faces) {
    triangles.faces.push_back({first + a, first + b, first + c});
    triangles.source.push_back(source);
  }
  return deviation;
}

void Mesh(const TopoDS_Shape& shape, double chord_tolerance) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = chord_tolerance;
  parameters.Angle = kAngle;
  const Handle(StepProgress) progress = new StepProgress(kTransferred, kMeshed);
  const BRepMesh_IncrementalMesh mesher(shape, parameters, progress->Start());
}

}  // namespace

SourceFace DescribeFace(const TopoDS_Face& face) {
  SourceFace source;
  source.id = "#0";
  source.kind = KindOf(face);
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  source.area = std::max(0.0, properties.Mass());
  return source;
}

RawMesh Tessellate(CadModel model, double chord_tolerance) {
  Mesh(model.shape, chord_tolerance);
  RawMesh mesh;
  mesh.notes = std::move(model.notes);
  mesh.triangles.source_faces = std::move(model.faces);
  mesh.bodies = std::move(model.bodies.names);
  mesh.body_of_source = std::move(model.bodies.of_face);
  std::vector<SourceFace>& sources = mesh.triangles.source_faces;
  double deviation = 0;
  int number = 0;
  for (TopExp_Explorer it(model.shape, TopAbs_FACE); it.More(); it.Next(), ++number) {
    for (const TopoDS_Face& part : Cut(TopoDS::Face(it.Current()), chord_tolerance, sources[number]))
      deviation = std::max(deviation, Append(part, number, chord_tolerance, mesh.triangles));
    TellPercent(kMeshed + static_cast<int>((100.0 - kMeshed) * (number + 1) / sources.size()));
  }
  if (mesh.triangles.faces.empty())
    throw std::runtime_error("the " + model.kind + " file holds no face that can be cut into triangles");
  if (deviation > chord_tolerance)
    mesh.notes.push_back(fmt::format("triangles of the {} part deviate by up to {:.3g} mm, wanted {:.3g} mm",
                                     model.kind, deviation, chord_tolerance));
  if (!TopExp_Explorer(model.shape, TopAbs_SOLID).More())
    mesh.notes.emplace_back("the " + model.kind + " file holds faces, but no solid");
  if (model.unit.keys_know) {
    mesh.stated_unit = model.unit.factor;
    for (Eigen::Vector3d& p : mesh.triangles.vertices) p /= model.unit.factor;
  } else {
    mesh.stated_unit = 1;
    mesh.notes.push_back(
        fmt::format("the {} file's unit \"{}\" was converted to mm", model.kind, model.unit.name));
  }
  return mesh;
}

}  // namespace millpose
