// SPDX-License-Identifier: GPL-3.0-or-later
#include <glob.h>

#include <set>

#include "base/error.hpp"
#include "program/calling_program.hpp"
#include "program/program_name.hpp"
#include "run/batch/batch.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

// Whether a line of the text begins with "key:".
bool HasKey(const std::string& text, const std::string& key) {
  return text.starts_with(key + ":") || text.find("\n" + key + ":") != std::string::npos;
}

// The name that a job gives itself; its file's name when it cannot be read (its own run will say why).
std::string OwnName(const fs::path& file, const std::vector<Override>& overrides, const FileRoot& root) {
  try {
    const std::string text = root.Read(file);
    const JobOutline outline = OutlineOf(text, file.string(), overrides);
    if (outline.operations.empty()) return ParseJob(text, file.string(), overrides).name;
    ParseJob(text, file.string(), overrides, 0);
    return outline.name;
  } catch (const InputError&) {
    const std::string stem = file.stem().string();
    return stem == "job" && file.has_parent_path() ? file.parent_path().filename().string() : stem;
  }
}

FileRoot RootOf(const BatchSettings& manifest, const fs::path& file, const FileRoot& root) {
  return manifest.untrusted ? FileRoot(file.has_parent_path() ? file.parent_path() : ".") : root;
}

void AddFile(const fs::path& file, const FileRoot& root, std::vector<BatchJob>* jobs) {
  const std::string text = root.Read(file);
  if (!HasKey(text, "millpose_batch")) {
    jobs->push_back({OwnName(file, {}, root), file, {}, 0, root});
    return;
  }
  const BatchSettings manifest = ParseBatch(text, file.string());
  const FileRoot own_root = RootOf(manifest, file, root);
  for (const BatchEntry& entry : manifest.jobs) {
    BatchJob job{entry.name, file.parent_path() / entry.job_file, entry.overrides, entry.shares, own_root};
    own_root.Check(job.file);
    if (entry.name.empty())
      job.name = OwnName(job.file, job.overrides, own_root);
    else
      job.overrides.push_back({"name", '"' + entry.name + '"'});
    jobs->push_back(std::move(job));
  }
}

// The bound of a folder's jobs: the folder itself where a manifest in it says that they are not trusted.
FileRoot RootOfFolder(const fs::path& folder, const FileRoot& root) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const fs::path& file : files)
    if (const std::string text = root.Read(file); HasKey(text, "millpose_batch"))
      if (const BatchSettings manifest = ParseBatch(text, file.string()); manifest.untrusted)
        return RootOf(manifest, file, root);
  return root;
}

void AddFolder(const fs::path& folder, const FileRoot& outer_root, std::vector<BatchJob>* jobs) {
  const FileRoot root = RootOfFolder(folder, outer_root);
  std::vector<fs::path> files;
  for (auto entry = fs::recursive_directory_iterator(folder); entry != fs::recursive_directory_iterator();
       ++entry) {
    if (entry->is_directory() && IsOutputFolder(entry->path())) entry.disable_recursion_pending();
    if (entry->is_regular_file() && entry->path().extension() == ".yaml") files.push_back(entry->path());
  }
  std::ranges::sort(files);
  const size_t before = jobs->size();
  for (const fs::path& file : files)
    if (HasKey(root.Read(file), "millpose_job")) AddFile(file, root, jobs);
  if (jobs->size() == before)
    throw InputError(SourceLocation{folder.string()}, "holds no job file (*.yaml with the key millpose_job)");
}

void AddPattern(const std::string& pattern, const FileRoot& root, std::vector<BatchJob>* jobs) {
  glob_t found{};
  const int status = ::glob(pattern.c_str(), 0, nullptr, &found);
  std::vector<std::string> files;
  for (size_t i = 0; status == 0 && i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  if (files.empty())
    throw InputError(SourceLocation{pattern},
                     "names nothing; allowed: job files, manifests, folders, patterns like 'parts/*.yaml'");
  for (const std::string& file : files)
    if (fs::is_directory(file))
      AddFolder(file, root, jobs);
    else
      AddFile(file, root, jobs);
}

void RefuseDoubles(const std::vector<BatchJob>& jobs) {
  std::vector<Problem> problems;
  std::map<std::string, fs::path> seen;
  for (const BatchJob& job : jobs) {
    const auto [first, is_new] = seen.emplace(job.name, job.file);
    // What stands in the batch's own folder besides those of its jobs.
    if (job.name == "slurm" || job.name == "batch.json" || job.name == "batch.csv" ||
        job.name == "index.html" || job.name == "junit.xml")
      problems.push_back({SourceLocation{job.file.string()},
                          fmt::format("name: {} is what the batch calls a file of its own; give the "
                                      "job another in a manifest",
                                      job.name)});
    else if (!is_new)
      problems.push_back(
          {SourceLocation{job.file.string()},
           fmt::format("name: {} is also the name of {}; give one of them another in a manifest", job.name,
                       first->second.string())});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

/// The files, as a controller tells them apart, that the job's main program and those of its operations are
/// in: "krl/panel". None where the job cannot be read: its own run will say why.
std::vector<std::string> ProgramFilesOf(const BatchJob& job) {
  try {
    const std::string text = job.root.Read(job.file), file = job.file.string();
    const JobOutline outline = OutlineOf(text, file, job.overrides);
    const bool several = !outline.operations.empty();
    std::vector<std::string> names{outline.name}, files;
    for (const std::string& operation : outline.operations)
      names.push_back(OperationName(outline.name, operation));
    for (const std::string& controller :
         (several ? ParseJob(text, file, job.overrides, 0) : ParseJob(text, file, job.overrides)).programs) {
      const CallingSyntax syntax = MakePost(controller)->Calling();
      for (const std::string& name : names)
        files.push_back(controller + '/' + AsTold(ProgramName(syntax, name)));
    }
    return files;
  } catch (const InputError&) {
    return {};
  }
}

/// Loaded onto one controller, the programs of one job would take the place of the other's.
void RefuseMeetingPrograms(const std::vector<BatchJob>& jobs) {
  std::map<std::string, size_t> first;  // job by file
  std::vector<std::vector<std::string>> files;
  for (size_t i = 0; i < jobs.size(); ++i) {
    files.push_back(ProgramFilesOf(jobs[i]));
    for (const std::string& file : files.back()) first.emplace(file, i);
  }
  std::vector<Problem> problems;
  for (size_t i = 0; i < jobs.size(); ++i)
    for (const std::string& file : files[i]) {
      auto other = first.find(file);
      if (other->second == i) other = first.find(WithoutPart(file));
      if (other == first.end() || other->second == i) continue;
      const BatchJob& one = jobs[other->second];
      problems.push_back(
          {SourceLocation{jobs[i].file.string()},
           fmt::format("name: programs of {} and of {} ({}) are both called {}; give one of the "
                       "jobs another name",
                       jobs[i].name, one.name, one.file.string(), other->first)});
      break;
    }
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace

std::vector<BatchJob> CollectJobs(const std::vector<std::string>& arguments, const FileRoot& root) {
  std::vector<BatchJob> jobs;
  std::vector<Problem> problems;
  for (const std::string& argument : arguments) {
    try {
      if (fs::is_directory(argument))
        AddFolder(argument, root, &jobs);
      else if (fs::exists(argument))
        AddFile(argument, root, &jobs);
      else
        AddPattern(argument, root, &jobs);
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  if (jobs.empty()) throw InputError(SourceLocation{}, "batch: no job is given");
  RefuseDoubles(jobs);
  RefuseMeetingPrograms(jobs);
  return jobs;
}

}  // namespace millpose
