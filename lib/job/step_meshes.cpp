// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/step_meshes.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/step_reader.hpp"
#include "job/assemble.hpp"

namespace millpose {
namespace {

// One file that the job names, and how it is cut where it is STEP.
struct Source {
  std::string name;
  std::string* bytes;
  StepOptions options;
  bool is_part;  // whose lost faces the tool path looks at
};

std::vector<Source> SourcesOf(JobInputs* inputs) {
  const StepOptions options = MakeStepOptions(inputs->job.workpiece);
  std::vector<Source> sources{{inputs->job.workpiece.mesh_file, &inputs->workpiece_bytes, options, true},
                              {inputs->job.workpiece.stock_file, &inputs->stock_bytes, options, false}};
  for (auto* bodies : {&inputs->body_bytes, &inputs->fixture_bytes})
    for (auto& [name, bytes] : *bodies) sources.push_back({name, &bytes, {}, false});
  std::erase_if(sources, [](const Source& source) { return !LooksLikeCad(*source.bytes); });
  return sources;
}

// Of the file and of what its triangles depend on, but for the machine.
std::string KeyOf(const Source& source) {
  return Hash(std::string(kStepTriangles) + ' ' + ShortestNumber(source.options.chord_tolerance) + '\n' +
              *source.bytes);
}

std::string FileOf(const std::string& key) { return "meshes/" + key + ".mesh"; }

void Replace(const Source& source, std::string mesh, JobInputs* inputs) {
  inputs->step_meshes[KeyOf(source)] = Hash(mesh);
  *source.bytes = std::move(mesh);
}

void TakeFrom(const std::function<std::optional<std::string>(const std::string& key)>& kept,
              JobInputs* inputs) {
  for (const Source& source : SourcesOf(inputs))
    if (std::optional<std::string> mesh = kept(KeyOf(source)); mesh && IsStepTriangles(*mesh))
      Replace(source, std::move(*mesh), inputs);
  inputs->hash = HashOf(*inputs);
}

std::optional<std::string> InResults(const std::filesystem::path& folder, const std::string& key) {
  if (!Exists(folder) || Folder(folder).KindOf(FileOf(key)) != Folder::Kind::kFile) return std::nullopt;
  return Folder(folder).Read(FileOf(key));
}

// A body without one of its faces would be passed through there.
void RefuseLost(const Source& source, const std::string& mesh) {
  const RawMesh raw = ReadStepTriangles(mesh, source.name);
  std::vector<Problem> problems;
  for (size_t i = 0; i < raw.triangles.source_faces.size(); ++i)
    if (raw.triangles.source_faces[i].lost)
      problems.push_back({{source.name}, DescribeLost(raw.triangles, i) + "; give this body as a mesh"});
  if (!problems.empty()) throw InputError(std::move(problems));
}

// The triangles of a key, wherever the inputs hold them.
const std::string& MeshOf(const JobInputs& inputs, const std::string& hash) {
  if (Hash(inputs.workpiece_bytes) == hash) return inputs.workpiece_bytes;
  if (Hash(inputs.stock_bytes) == hash) return inputs.stock_bytes;
  for (const auto* bodies : {&inputs.body_bytes, &inputs.fixture_bytes})
    for (const auto& [name, bytes] : *bodies)
      if (Hash(bytes) == hash) return bytes;
  throw std::logic_error("the triangles of a STEP file are gone");
}

}  // namespace

void TakeCachedMeshes(const std::filesystem::path& folder, JobInputs* inputs) {
  TakeFrom([&](const std::string& key) { return InResults(folder, key); }, inputs);
}

void TakeCachedMeshes(const OutputFolder& folder, JobInputs* inputs) {
  TakeFrom(
      [&](const std::string& key) {
        std::optional<std::string> mesh = folder.ReadCheckpoint(key);
        return mesh ? mesh : InResults(folder.path(), key);
      },
      inputs);
}

void CutStepFiles(JobInputs* inputs, const std::function<void(int)>& percent, const std::stop_token& stop) {
  for (Source& source : SourcesOf(inputs)) {
    source.options.percent = percent;
    source.options.stop = stop;
    std::string mesh = CutStep(*source.bytes, source.name, source.options);
    if (!source.is_part) RefuseLost(source, mesh);
    Replace(source, std::move(mesh), inputs);
  }
  inputs->hash = HashOf(*inputs);
}

void KeepMeshes(const JobInputs& inputs, const OutputFolder& folder) {
  for (const auto& [key, hash] : inputs.step_meshes)
    if (!folder.ReadCheckpoint(key)) folder.WriteCheckpoint(key, MeshOf(inputs, hash));
}

void AddMeshes(const JobInputs& inputs, ResultSet* results) {
  for (const auto& [key, hash] : inputs.step_meshes) results->Add(FileOf(key), MeshOf(inputs, hash));
}

}  // namespace millpose
