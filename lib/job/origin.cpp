// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/origin.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "store/manifest.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

RunFigures::JobFolder ReadJobFolder(const fs::path& run_file, const FileRoot& root) {
  try {
    root.Check(run_file);
    const nlohmann::json run = nlohmann::json::parse(Folder(run_file.parent_path()).Read(kRunFile));
    const nlohmann::json& folder = run.at("job_folder");
    return {folder.at("absolute").get<std::string>(), folder.at("relative").get<std::string>()};
  } catch (const nlohmann::json::exception& error) {
    throw InputError(SourceLocation{run_file.string()},
                     fmt::format("does not say where the job stood (job_folder): {}", error.what()));
  }
}

// The job whose plan stands in the folder, if one does that says so.
std::optional<RunFigures::JobFile> PlannedThere(const fs::path& out) {
  if (!Exists(out) || Folder(out).KindOf(kRunFile) != Folder::Kind::kFile) return std::nullopt;
  const nlohmann::json run = nlohmann::json::parse(Folder(out).Read(kRunFile), nullptr, false);
  if (!run.is_object() || !run.contains("job")) return std::nullopt;
  const nlohmann::json& job = run["job"];
  return RunFigures::JobFile{job.value("name", ""), job.value("file", "")};
}

}  // namespace

fs::path OriginOf(const fs::path& job_file, const fs::path& named, const FileRoot& root) {
  fs::path folder = job_file.parent_path();
  if (job_file.filename() != "job.yaml" || !IsOutputFolder(folder.empty() ? "." : folder)) return folder;
  const RunFigures::JobFolder kept = ReadJobFolder(folder / kRunFile, root);
  // The same place by both names, unless something was moved.
  for (const fs::path& origin : {fs::path(kept.absolute), (folder / kept.relative).lexically_normal()})
    if (fs::exists(origin / named)) return origin;
  throw InputError(
      SourceLocation{job_file.string()},
      fmt::format("the files that it names were read from {}, where {} is not any more; plan the "
                  "job that made this folder",
                  kept.absolute, named.string()));
}

RunFigures::JobFolder KeepOrigin(const fs::path& job_folder, const fs::path& out) {
  const fs::path from = fs::weakly_canonical(job_folder.empty() ? "." : job_folder);
  return {from.string(), from.lexically_proximate(fs::weakly_canonical(out)).string()};
}

RunFigures::JobFile JobFileFor(const fs::path& file, const std::string& name, const fs::path& out) {
  const fs::path own = fs::weakly_canonical(file), folder = fs::weakly_canonical(out);
  const std::optional<RunFigures::JobFile> earlier = PlannedThere(out);
  // Also the resolved job of several operations, of which the folder holds one.
  const bool one_of_several = folder.parent_path().filename() == kOperationsFolder;
  const bool resolved = own.parent_path() == folder ||
                        (one_of_several && own.parent_path() == folder.parent_path().parent_path());
  if (earlier && resolved) return {name, earlier->file};
  if (earlier && earlier->name == name) {
    const fs::path other = fs::weakly_canonical(folder / earlier->file);
    if (other != own && other.parent_path() != folder && Exists(other))
      throw InputError(SourceLocation{file.string()},
                       fmt::format("name: {} is also the name of {}, whose plan {} holds; give one of them "
                                   "another name, or another folder with -o DIR",
                                   name, other.string(), out.string()));
  }
  return {name, own.lexically_proximate(folder).string()};
}

}  // namespace millpose
