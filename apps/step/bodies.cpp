// SPDX-License-Identifier: GPL-3.0-or-later
#include "bodies.hpp"

#include <Interface_InterfaceModel.hxx>
#include <NCollection_DataMap.hxx>
#include <NCollection_Map.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <map>

namespace millpose {
namespace {

using NamesByShape = NCollection_DataMap<Handle(TopoDS_TShape), std::string>;

std::string NameOf(const StepBasic_ProductDefinition& definition) {
  if (definition.Formation().IsNull() || definition.Formation()->OfProduct().IsNull()) return {};
  const StepBasic_Product& product = *definition.Formation()->OfProduct();
  std::string name = product.Name().IsNull() ? "" : product.Name()->ToCString();
  if (name.empty() && !product.Id().IsNull()) name = product.Id()->ToCString();
  return name == "NONE" ? "" : name;  // what writers put where there is none
}

// What products became. An assembly of one component has that one's shape: the name is the component's.
NamesByShape ProductNames(const STEPControl_Reader& reader) {
  const Handle(Interface_InterfaceModel) model = reader.Model();
  const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
  NCollection_Map<Handle(Standard_Transient)> assemblies;
  for (int i = 1; i <= model->NbEntities(); ++i)
    if (const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
        !use.IsNull() && !use->RelatingProductDefinition().IsNull())
      assemblies.Add(use->RelatingProductDefinition());
  NamesByShape names;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto definition = Handle(StepBasic_ProductDefinition)::DownCast(model->Value(i));
    if (definition.IsNull()) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, definition);
    if (shape.IsNull() || (assemblies.Contains(definition) && names.IsBound(shape.TShape()))) continue;
    if (const std::string name = NameOf(*definition); !name.empty()) names.Bind(shape.TShape(), name);
  }
  return names;
}

// From the whole down to its faces, in TopExp_Explorer's order.
class Walk {
 public:
  explicit Walk(const NamesByShape& names) : names_(names) {}

  void Into(const TopoDS_Shape& shape, const std::string& above, int body) {
    const std::string& name = names_.IsBound(shape.TShape()) ? names_.Find(shape.TShape()) : above;
    if (shape.ShapeType() == TopAbs_FACE) {
      found_.of_face.push_back(body);
      return;
    }
    if (shape.ShapeType() == TopAbs_SOLID) body = Add(name);
    for (TopoDS_Iterator it(shape); it.More(); it.Next()) Into(it.Value(), name, body);
  }

  CadBodies Found() { return std::move(found_); }

 private:
  int Add(const std::string& name) {
    const std::string base = name.empty() ? "body" : name;
    const int use = ++uses_[base];
    found_.names.push_back(use == 1 ? base : base + " (" + std::to_string(use) + ")");
    return static_cast<int>(found_.names.size()) - 1;
  }

  const NamesByShape& names_;
  std::map<std::string, int> uses_;
  CadBodies found_;
};

}  // namespace

CadBodies BodiesOf(const TopoDS_Shape& shape) {
  const NamesByShape none;
  Walk walk(none);
  walk.Into(shape, "", -1);
  return walk.Found();
}

CadBodies BodiesOf(const STEPControl_Reader& reader, const TopoDS_Shape& shape) {
  const NamesByShape names = ProductNames(reader);
  Walk walk(names);
  walk.Into(shape, "", -1);
  return walk.Found();
}

}  // namespace millpose
