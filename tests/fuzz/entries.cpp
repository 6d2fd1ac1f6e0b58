// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/entries.hpp"

#include <cmath>
#include <cstdlib>

#include "base/csv.hpp"
#include "base/error.hpp"
#include "config/batch_settings.hpp"
#include "config/config.hpp"
#include "config/measurements.hpp"
#include "surface/mesh_import.hpp"
#include "surface/obj_reader.hpp"
#include "surface/off_reader.hpp"
#include "surface/ply_reader.hpp"
#include "surface/step_reader.hpp"
#include "surface/stl_reader.hpp"
#include "tests/program/sample_plan.hpp"
#include "toolpath/cam_import.hpp"

namespace millpose {
namespace {

void Demand(bool holds) {
  if (!holds) std::abort();
}

template <class Read>
void LetRefuse(Read read) {
  try {
    read();
  } catch (const InputError& error) {
    Demand(!error.problems().empty());
  }
}

// Reads a mesh, looks at what it promises, and repairs it.
template <RawMesh (*kRead)(std::string_view, const std::string&)>
void Mesh(std::string_view bytes) {
  LetRefuse([&] {
    RawMesh raw = kRead(bytes, "fuzz");
    for (const auto& p : raw.triangles.vertices) Demand(p.allFinite());
    for (const auto& face : raw.triangles.faces)
      for (const int v : face) Demand(v >= 0 && static_cast<size_t>(v) < raw.triangles.vertices.size());
    if (raw.triangles.faces.size() < 20'000) ImportMesh(std::move(raw), {}, "fuzz");
  });
}

void Path(const CamPath& path) {
  Demand(!path.points.empty());
  for (const CamPoint& point : path.points) {
    Demand(point.position.allFinite() && std::isfinite(point.feed_rate));
    Demand(std::abs(point.axis.norm() - 1) < 1e-6);
  }
  if (path.points.size() > 20'000) return;
  CamImportOptions options;
  options.spacing = 1e9;
  ImportCamPath(path, nullptr, options, nullptr);
}

void Gcode(std::string_view bytes) {
  CamReadOptions options;
  options.chord_tolerance = 0.1;
  options.rotary_axes = RotaryAxes({{'C', -Eigen::Vector3d::UnitZ(), {10, 0, 0}, true},
                                    {'B', Eigen::Vector3d::UnitY(), {0, 0, 200}, false}});
  LetRefuse([&] { Path(ReadGcode(bytes, "fuzz", options)); });
}

void Program(const char* controller, const char* file, std::string_view bytes) {
  LetRefuse([&] {
    MakePost(controller)->Read({{file, std::string(bytes)}}, SampleArm(), SampleSettings(controller));
  });
}

}  // namespace

const std::vector<FuzzEntry>& FuzzEntries() {
  static const std::vector<FuzzEntry> entries{
      {"job", [](std::string_view bytes) { LetRefuse([&] { ParseJob(bytes, "fuzz"); }); }},
      {"cell", [](std::string_view bytes) { LetRefuse([&] { ParseCell(bytes, "fuzz"); }); }},
      {"batch", [](std::string_view bytes) { LetRefuse([&] { ParseBatch(bytes, "fuzz"); }); }},
      {"measurements", [](std::string_view bytes) { LetRefuse([&] { ParseMeasurements(bytes, "fuzz"); }); }},
      {"csv",
       [](std::string_view bytes) {
         LetRefuse([&] { ReadCsv(bytes, "fuzz", {{"x_mm", "y_mm"}, {"z_mm"}}); });
         LetRefuse([&] { ParseMeasurementsCsv(bytes, "fuzz"); });
       }},
      {"stl", Mesh<ReadStl>},
      {"obj", Mesh<ReadObj>},
      {"ply", Mesh<ReadPly>},
      {"off", Mesh<ReadOff>},
      {"step_answer", Mesh<ReadStepTriangles>},
      {"apt", [](std::string_view bytes) { LetRefuse([&] { Path(ReadApt(bytes, "fuzz", 0.1)); }); }},
      {"gcode", Gcode},
      {"cam_csv", [](std::string_view bytes) { LetRefuse([&] { Path(ReadCamCsv(bytes, "fuzz")); }); }},
      {"krl", [](std::string_view bytes) { Program("krl", "a.src", bytes); }},
      {"sinumerik", [](std::string_view bytes) { Program("sinumerik", "a.mpf", bytes); }},
      {"linuxcnc", [](std::string_view bytes) { Program("linuxcnc", "a.ngc", bytes); }}};
  return entries;
}

}  // namespace millpose
