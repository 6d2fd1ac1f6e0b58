// SPDX-License-Identifier: GPL-3.0-or-later
#include "recut.hpp"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace millpose {
namespace {

std::vector<TopoDS_Face> FacesOf(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
    faces.push_back(TopoDS::Face(it.Current()));
  return faces;
}

// What ShapeFix makes of a copy of the face, moving nothing by more than the tolerance.
TopoDS_Shape Repaired(const TopoDS_Face& face, double tolerance) {
  ShapeFix_Shape fix(BRepBuilderAPI_Copy(face).Shape());
  fix.SetMaxTolerance(tolerance);
  fix.Perform();
  return fix.Shape();
}

}  // namespace

double TriangleArea(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  double area = 0;
  for (int i = 1; !mesh.IsNull() && i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    const gp_Vec ab(mesh->Node(a), mesh->Node(b)), ac(mesh->Node(a), mesh->Node(c));
    area += ab.Crossed(ac).Magnitude() / 2;
  }
  return area;
}

std::vector<TopoDS_Face> Recut(const TopoDS_Face& face, double area, double chord_tolerance, double angle,
                               const RecutLength& way) try {
  IMeshTools_Parameters parameters;
  parameters.Deflection = chord_tolerance;
  parameters.Angle = angle;
  parameters.AllowQualityDecrease = Standard_True;
  if (way.other_algorithm) parameters.MeshAlgo = IMeshTools_MeshAlgoType_Delabella;
  if (way.coarse) {
    parameters.DeflectionInterior = 20 * chord_tolerance;
    parameters.AngleInterior = 4 * angle;
    parameters.ControlSurfaceDeflection = Standard_False;
  }
  const TopoDS_Shape shape = way.repaired ? Repaired(face, chord_tolerance) : TopoDS_Shape(face);
  if (!way.repaired) BRepTools::Clean(face);  // its edges keep the points that the neighbours have
  const BRepMesh_IncrementalMesh mesher(shape, parameters);
  std::vector<TopoDS_Face> faces = FacesOf(shape);
  double cut = 0;
  for (const TopoDS_Face& part : faces) cut += TriangleArea(part);
  if (cut <= 0 || cut < area / 2) faces.clear();
  return faces;
} catch (const Standard_Failure&) {
  return {};
}

}  // namespace millpose
