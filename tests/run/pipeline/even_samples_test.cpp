// SPDX-License-Identifier: GPL-3.0-or-later
// The sample jobs' tool paths: how long their steps are, and how fast the tool axis turns.
#include "job/workpiece.hpp"
#include "tests/run/pipeline/small_job.hpp"
#include "tests/toolpath/step_census.hpp"

namespace millpose::test {
namespace {

std::vector<std::string> Samples() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SamplePath("toolpaths")))
    if (std::filesystem::exists(entry.path() / "job.yaml")) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

Mesh PartOf(const JobInputs& inputs) {
  const std::string& name = inputs.job.workpiece.mesh_file;
  if (name.empty()) return Mesh(Triangles{});
  ImportOptions options;
  options.unit = inputs.job.workpiece.unit;
  options.weld_tolerance = inputs.job.workpiece.weld_tolerance;
  options.flip = inputs.job.workpiece.flip;
  return ImportMesh(ReadMesh(inputs.workpiece_bytes, name, {}), options, name).mesh;
}

TEST(EvenSamples, NoStepIsShortButAtCornersAndTheAxisTurnsAsTheSurfaceDoes) {
  size_t paths = 0;
  for (const std::string& name : Samples()) {
    SCOPED_TRACE(name);
    const std::filesystem::path file = SamplePath("toolpaths/" + name + "/job.yaml");
    if (ReadFile(file).find("\noperations:") != std::string::npos) continue;
    const JobInputs inputs = LoadJobInputs(file);
    const Mesh mesh = PartOf(inputs);
    const Toolpath toolpath = MakeJobToolpath(inputs, mesh, {}, 1).toolpath;
    const StepCensus census = CensusOf(toolpath, &mesh);
    fmt::print("{:16} {}\n", name, ToText(census));
    ++paths;
    EXPECT_TRUE(census.uneven.empty()) << census.uneven.size() << " places:\n"
                                       << fmt::format("{}", fmt::join(census.uneven, "\n"));
  }
  EXPECT_GT(paths, 8);
}

}  // namespace
}  // namespace millpose::test
