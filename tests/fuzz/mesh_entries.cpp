// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/obj_reader.hpp"
#include "geometry/import/off_reader.hpp"
#include "geometry/import/ply_reader.hpp"
#include "geometry/import/step_reader.hpp"
#include "geometry/import/stl_reader.hpp"
#include "tests/fuzz/entries.hpp"

namespace millpose {
namespace {

// Reads a mesh, looks at what it promises, and repairs it.
template <RawMesh (*kRead)(std::string_view, const std::string&)>
void ReadAndImport(std::string_view bytes) {
  LetRefuse([&] {
    RawMesh raw = kRead(bytes, "fuzz");
    for (const auto& p : raw.triangles.vertices) Demand(p.allFinite());
    for (const auto& face : raw.triangles.faces)
      for (const int v : face) Demand(v >= 0 && static_cast<size_t>(v) < raw.triangles.vertices.size());
    if (raw.triangles.faces.size() < 20'000) ImportMesh(std::move(raw), {}, "fuzz");
  });
}

}  // namespace

std::vector<FuzzEntry> MeshEntries() {
  return {{"stl", ReadAndImport<ReadStl>},
          {"obj", ReadAndImport<ReadObj>},
          {"ply", ReadAndImport<ReadPly>},
          {"off", ReadAndImport<ReadOff>},
          {"step_answer", ReadAndImport<ReadStepTriangles>}};
}

}  // namespace millpose
