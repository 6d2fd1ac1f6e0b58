// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of STEP and IGES hand to the one that cuts faces into triangles.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "bodies.hpp"
#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// How far the work has come, in percent, when reading and transferring end.
inline constexpr int kParsed = 15, kTransferred = 50;

struct CadUnit {
  std::string name;
  double factor;   ///< mm
  bool keys_know;  ///< jobs can name it
};

struct CadModel {
  std::string kind;    ///< "STEP" or "IGES", for messages
  TopoDS_Shape shape;  ///< mm
  CadUnit unit;        ///< of the file
  /// Each face where it stands: a part used twice in an assembly has its faces twice.
  std::vector<SourceFace> faces;
  CadBodies bodies;
  std::vector<std::string> notes;
};

/// Kind and area (mm²) of a face; no id ("#0"), no name.
SourceFace DescribeFace(const TopoDS_Face& face);

}  // namespace millpose
