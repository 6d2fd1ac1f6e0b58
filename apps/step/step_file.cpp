// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_file.hpp"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Interface_Static.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "refine.hpp"

namespace millpose {
namespace {

constexpr double kAngle = 10 * 0.017453292519943295;  // rad between neighbouring facets of a curved face

struct Unit {
  std::string name;
  double factor;   // mm
  bool keys_know;  // jobs can name it
};

Unit UnitOf(const STEPControl_Reader& reader) {
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  const_cast<STEPControl_Reader&>(reader).FileUnits(lengths, angles, solid_angles);
  std::string name = lengths.IsEmpty() ? "" : lengths.First().ToCString();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const Unit& unit :
       {Unit{"millimetre", 1, true}, Unit{"centimetre", 10, true}, Unit{"micrometre", 1e-3, false},
        Unit{"kilometre", 1e6, false}, Unit{"decimetre", 100, false}, Unit{"metre", 1000, true},
        Unit{"inch", 25.4, true}, Unit{"foot", 304.8, false}, Unit{"feet", 304.8, false}})
    if (name.find(unit.name) != std::string::npos) return unit;
  return {name, 1, false};
}

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

SourceFace Described(const STEPControl_Reader& reader, const TopoDS_Face& face) {
  SourceFace source;
  source.id = "#0";
  source.kind = KindOf(face);
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  source.area = std::max(0.0, properties.Mass());
  const Handle(XSControl_TransferReader) transfer = reader.WS()->TransferReader();
  const Handle(Standard_Transient) entity = transfer->EntityFromShapeResult(face, 1);
  if (entity.IsNull()) return source;
  const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(reader.Model());
  if (!model.IsNull()) source.id = "#" + std::to_string(model->IdentLabel(entity));
  const Handle(StepRepr_RepresentationItem) item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
  if (!item.IsNull() && !item->Name().IsNull()) source.name = item->Name()->ToCString();
  if (source.name == "NONE") source.name.clear();  // what writers put where there is none
  return source;
}

// Appends the face's triangles, in mm, seen from outside. Returns how far the face lies from them at most, or
// nothing when it has none.
std::optional<double> Append(const TopoDS_Face& face, int source, double tolerance, Triangles& triangles) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull() || mesh->NbTriangles() == 0) return std::nullopt;
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

}  // namespace

RawMesh TessellateStep(const std::string& bytes, double chord_tolerance) {
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  STEPControl_Reader reader;
  std::istringstream stream(bytes);
  if (reader.ReadStream("part", stream) != IFSelect_RetDone)
    throw std::runtime_error("the STEP file cannot be parsed");
  if (reader.TransferRoots() == 0) throw std::runtime_error("the STEP file holds no shape that can be read");
  const TopoDS_Shape shape = reader.OneShape();
  const BRepMesh_IncrementalMesh mesher(shape, chord_tolerance, Standard_False, kAngle, Standard_False);
  const Unit unit = UnitOf(reader);
  RawMesh mesh;
  int solids = 0;
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) ++solids;
  // Each face where it stands: a part used twice in an assembly has its faces twice.
  size_t lost = 0;
  double deviation = 0;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face face = TopoDS::Face(it.Current());
    const auto number = static_cast<int>(mesh.triangles.source_faces.size());
    mesh.triangles.source_faces.push_back(Described(reader, face));
    const std::optional<double> left = Append(face, number, chord_tolerance, mesh.triangles);
    lost += left ? 0 : 1;
    deviation = std::max(deviation, left.value_or(0));
  }
  if (mesh.triangles.faces.empty())
    throw std::runtime_error("the STEP file holds no face that can be cut into triangles");
  if (deviation > chord_tolerance)
    mesh.notes.push_back(
        fmt::format("triangles of the STEP part deviate by up to {:.3g} mm, wanted {:.3g} mm", deviation,
                    chord_tolerance));
  if (lost > 0)
    mesh.notes.push_back(fmt::format("{} faces of the STEP file could not be cut into triangles", lost));
  if (solids == 0) mesh.notes.emplace_back("the STEP file holds faces, but no solid");
  if (unit.keys_know) {
    mesh.stated_unit = unit.factor;
    for (Eigen::Vector3d& p : mesh.triangles.vertices) p /= unit.factor;
  } else {
    mesh.stated_unit = 1;
    mesh.notes.push_back(fmt::format("the STEP file's unit \"{}\" was converted to mm", unit.name));
  }
  return mesh;
}

}  // namespace millpose
