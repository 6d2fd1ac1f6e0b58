// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_file.hpp"

#include <fmt/format.h>

#include <Interface_Static.hxx>
#include <NCollection_DataMap.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_Face.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <istream>
#include <stdexcept>

#include "step_progress.hpp"

namespace millpose {
namespace {

CadUnit UnitOf(const STEPControl_Reader& reader) {
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  const_cast<STEPControl_Reader&>(reader).FileUnits(lengths, angles, solid_angles);
  std::string name = lengths.IsEmpty() ? "" : lengths.First().ToCString();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const CadUnit& unit :
       {CadUnit{"millimetre", 1, true}, CadUnit{"centimetre", 10, true}, CadUnit{"micrometre", 1e-3, false},
        CadUnit{"kilometre", 1e6, false}, CadUnit{"decimetre", 100, false}, CadUnit{"metre", 1000, true},
        CadUnit{"inch", 25.4, true}, CadUnit{"foot", 304.8, false}, CadUnit{"feet", 304.8, false}})
    if (name.find(unit.name) != std::string::npos) return unit;
  return {name, 1, false};
}

using FaceEntities = NCollection_DataMap<Handle(TopoDS_TShape), Handle(Standard_Transient)>;

// The entity of the file that each face comes from. OpenCASCADE's own way back looks at all entities for each
// face.
FaceEntities EntitiesOf(const STEPControl_Reader& reader) {
  FaceEntities entities;
  const Handle(Interface_InterfaceModel) model = reader.Model();
  const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (!entity->IsKind(STANDARD_TYPE(StepShape_Face))) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    if (!shape.IsNull() && shape.ShapeType() == TopAbs_FACE) entities.Bind(shape.TShape(), entity);
  }
  return entities;
}

SourceFace Described(const STEPControl_Reader& reader, const FaceEntities& entities,
                     const TopoDS_Face& face) {
  SourceFace source = DescribeFace(face);
  if (!entities.IsBound(face.TShape())) return source;
  const Handle(Standard_Transient)& entity = entities.Find(face.TShape());
  const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(reader.Model());
  if (!model.IsNull()) source.id = fmt::format("#{}", model->IdentLabel(entity));
  const Handle(StepRepr_RepresentationItem) item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
  if (!item.IsNull() && !item->Name().IsNull()) source.name = item->Name()->ToCString();
  if (source.name == "NONE") source.name.clear();  // what writers put where there is none
  return source;
}

}  // namespace

CadModel ReadStepModel(std::istream& file) {
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  STEPControl_Reader reader;
  TellPercent(0);
  if (reader.ReadStream("part", file) != IFSelect_RetDone)
    throw std::runtime_error("the STEP file cannot be parsed");
  TellPercent(kParsed);
  const Handle(StepProgress) progress = new StepProgress(kParsed, kTransferred);
  if (reader.TransferRoots(progress->Start()) == 0)
    throw std::runtime_error("the STEP file holds no shape that can be read");
  CadModel model{"STEP", reader.OneShape(), UnitOf(reader), {}, {}, {}};
  const FaceEntities entities = EntitiesOf(reader);
  for (TopExp_Explorer it(model.shape, TopAbs_FACE); it.More(); it.Next())
    model.faces.push_back(Described(reader, entities, TopoDS::Face(it.Current())));
  model.bodies = BodiesOf(reader, model.shape);
  reader.ClearShapes();
  reader.WS()->ClearData(7);
  reader.WS()->ClearData(1);
  return model;
}

}  // namespace millpose
