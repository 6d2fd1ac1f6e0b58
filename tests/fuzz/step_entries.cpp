// SPDX-License-Identifier: GPL-3.0-or-later
// STEP files through millpose-step, as every reader of them goes. OpenCASCADE may end that process on a
// damaged file, which is what the process is for; so it cannot be read in the fuzzer's own. What counts:
// whatever it does, its parent answers in time with triangles or an InputError.
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/step_reader.hpp"
#include "tests/fuzz/entries.hpp"

namespace millpose {
namespace {

void Step(std::string_view bytes) {
  StepOptions options;
  options.chord_tolerance = 0.5;
  options.memory_MB = 512;
  options.seconds = 5;
  options.program = MILLPOSE_STEP_PROGRAM;
  LetRefuse([&] {
    RawMesh raw = ReadStep(bytes, "fuzz", options);
    for (const auto& p : raw.triangles.vertices) Demand(p.allFinite());
    if (raw.triangles.faces.size() < 20'000) ImportMesh(std::move(raw), {}, "fuzz");
  });
}

}  // namespace

std::vector<FuzzEntry> StepEntries() { return {{"step", Step, 5}}; }

}  // namespace millpose
