// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/step_parts.hpp"

#include <unistd.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Wire.hxx>
#include <filesystem>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <gp_Trsf.hxx>
#include <regex>
#include <sstream>

#include "base/file.hpp"

namespace millpose {
namespace {

std::string AsStep(const TopoDS_Shape& shape, const std::string& unit) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();  // else the unit is not known yet; the writer takes it when it is made
  Interface_Static::SetCVal("write.step.unit", unit.c_str());
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  const auto path =
      std::filesystem::temp_directory_path() / ("millpose_step_" + std::to_string(::getpid()) + ".step");
  writer.Write(path.c_str());
  std::string bytes = ReadFile(path);
  std::filesystem::remove(path);
  return bytes;
}

TopoDS_Shape BlockWithHole(double radius) {
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(100.0, 60.0, 20.0).Shape();
  const gp_Ax2 axis(gp_Pnt(50, 30, -1), gp_Dir(0, 0, 1));
  return BRepAlgoAPI_Cut(block, BRepPrimAPI_MakeCylinder(axis, radius, 22).Shape()).Shape();
}

}  // namespace

std::string DrilledBlockStep(const std::string& unit, double radius) {
  return AsStep(BlockWithHole(radius), unit);
}

std::string DrilledBlockIges(const std::string& unit, bool solid) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  IGESControl_Controller::Init();
  IGESControl_Writer writer(unit.c_str(), solid ? 1 : 0);
  writer.AddShape(BlockWithHole(15));
  writer.ComputeModel();
  std::ostringstream file;
  writer.Write(file);
  return file.str();
}

std::string LostFaceStep() {
  BRep_Builder builder;
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  builder.Add(wire, BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 50), gp_Pnt(40, 0, 70)).Edge());
  builder.Add(wire, BRepBuilderAPI_MakeEdge(gp_Pnt(40, 0, 70), gp_Pnt(40, 30, 20)).Edge());
  TopoDS_Compound part;
  builder.MakeCompound(part);
  builder.Add(part, BRepPrimAPI_MakeBox(100.0, 60.0, 20.0).Shape());
  builder.Add(
      part, BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 50), gp_Dir(0, 0, 1)), wire, Standard_False).Face());
  return AsStep(part, "MM");
}

std::string AssemblyStep() {
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(100.0, 60.0, 10.0).Shape();
  const TopoDS_Shape rib = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(10, 60, 30)).Shape();
  const auto at = [](const TopoDS_Shape& shape, double x, double z) {
    gp_Trsf move;
    move.SetTranslation(gp_Vec(x, 0, z));
    return shape.Moved(TopLoc_Location(move));
  };
  BRep_Builder builder;
  TopoDS_Compound whole;
  builder.MakeCompound(whole);
  for (const TopoDS_Shape& body : {plate, at(rib, 0, 10), at(rib, 50, 10)}) builder.Add(whole, body);
  Interface_Static::SetIVal("write.step.assembly", 1);
  std::string step = AsStep(whole, "MM");
  Interface_Static::SetIVal("write.step.assembly", 0);
  // The writer numbers products, the first ones of a process otherwise than later ones; people name them.
  step = std::regex_replace(step, std::regex("'Open CASCADE STEP translator [0-9.]+ [0-9]+\\.1'"), "'plate'");
  step = std::regex_replace(step, std::regex("'Open CASCADE STEP translator [0-9.]+ [0-9]+\\.2'"), "'rib'");
  return step;
}

std::string BallStep(double radius) { return AsStep(BRepPrimAPI_MakeSphere(radius).Shape(), "MM"); }

}  // namespace millpose
