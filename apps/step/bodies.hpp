// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <STEPControl_Reader.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace millpose {

/// The solids of a model, each where it stands: a part that an assembly uses twice is two bodies.
struct CadBodies {
  std::vector<std::string> names;  ///< of the product; several solids of one, and uses of one, are counted
  std::vector<int> of_face;        ///< by face in TopExp_Explorer's order: into `names`; −1 in no solid
};

/// Of a model whose solids have no names.
CadBodies BodiesOf(const TopoDS_Shape& shape);

/// Precondition: the reader still holds its model.
CadBodies BodiesOf(const STEPControl_Reader& reader, const TopoDS_Shape& shape);

}  // namespace millpose
