// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "config/config.hpp"
#include "pipeline/cell_texts.hpp"
#include "pipeline/origin.hpp"
#include "pipeline/resolve_urdf.hpp"

namespace millpose {
namespace {

// Runs `step`; what is wrong with its input joins `problems` so that the user sees everything at once.
template <class Step>
void Collect(std::vector<Problem>& problems, Step step) {
  try {
    step();
  } catch (const InputError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
}

}  // namespace

CellSettings LoadCell(const std::filesystem::path& cell_file,
                      std::map<std::string, std::string>* body_bytes) {
  CellSettings cell = ParseCell(ReadFile(cell_file), cell_file.string());
  ResolveUrdf(cell_file.parent_path(), &cell);
  std::vector<Problem> problems = CheckCellTexts(cell);
  for (const BodySettings& body : cell.bodies) {
    if (body.shape.kind != "mesh" || body_bytes->contains(body.shape.mesh_file)) continue;
    Collect(problems, [&] {
      (*body_bytes)[body.shape.mesh_file] = ReadFile(cell_file.parent_path() / body.shape.mesh_file);
    });
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return cell;
}

JobInputs LoadJobInputs(const std::filesystem::path& job_file, const std::vector<Override>& overrides,
                        const std::optional<std::filesystem::path>& origin) {
  JobInputs inputs;
  inputs.job_file = job_file;
  inputs.job = ParseJob(ReadFile(job_file), job_file.string(), overrides);
  inputs.folder = origin ? *origin : OriginOf(job_file, inputs.job.cell_file);
  const std::filesystem::path& folder = inputs.folder;
  std::vector<Problem> problems;
  Collect(problems, [&] { inputs.cell = LoadCell(folder / inputs.job.cell_file, &inputs.body_bytes); });
  if (!inputs.job.workpiece.mesh_file.empty())
    Collect(problems, [&] { inputs.workpiece_bytes = ReadFile(folder / inputs.job.workpiece.mesh_file); });
  if (!inputs.job.workpiece.stock_file.empty())
    Collect(problems, [&] { inputs.stock_bytes = ReadFile(folder / inputs.job.workpiece.stock_file); });
  if (inputs.job.toolpath.strategy == "cam")
    Collect(problems, [&] { inputs.cam_bytes = ReadFile(folder / inputs.job.toolpath.cam_file); });
  if (!problems.empty()) throw InputError(std::move(problems));

  std::string all = WriteJob(inputs.job) + '\0' + WriteCell(inputs.cell) + '\0' +
                    Hash(inputs.workpiece_bytes) + '\0' + Hash(inputs.stock_bytes) + '\0' +
                    Hash(inputs.cam_bytes);
  for (const auto& [name, bytes] : inputs.body_bytes) all += '\0' + name + '\0' + Hash(bytes);
  inputs.hash = Hash(all);
  return inputs;
}

}  // namespace millpose
