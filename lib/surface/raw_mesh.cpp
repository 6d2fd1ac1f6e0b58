// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/raw_mesh.hpp"

#include "base/error.hpp"
#include "surface/obj_reader.hpp"
#include "surface/off_reader.hpp"
#include "surface/ply_reader.hpp"
#include "surface/step_reader.hpp"
#include "surface/stl_reader.hpp"

namespace millpose {
namespace {

RawMesh Read(std::string_view bytes, const std::string& name, const StepOptions& step) {
  if (bytes.empty()) throw InputError({name}, "the file is empty");
  if (IsExactBinaryStl(bytes)) return ReadStl(bytes, name);  // its header may begin with any word
  if (LooksLikeStep(bytes)) return ReadStep(bytes, name, step);
  if (LooksLikePly(bytes)) return ReadPly(bytes, name);
  if (LooksLikeOff(bytes)) return ReadOff(bytes, name);
  if (LooksLikeObj(bytes)) return ReadObj(bytes, name);
  return ReadStl(bytes, name);
}

}  // namespace

RawMesh ReadMesh(std::string_view bytes, const std::string& name, const StepOptions& step) {
  RawMesh mesh = Read(bytes, name, step);
  if (mesh.triangles.faces.empty()) throw InputError({name}, "the file holds no triangles");
  return mesh;
}

}  // namespace millpose
