// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/file_root.hpp"
#include "program/post.hpp"

namespace millpose {

/// An operation as its output folder holds it.
struct DoneOperation {
  std::string name, folder;                      ///< of the operation; below the job's output folder
  std::string job, tool;                         ///< names
  std::string setup;                             ///< its name; empty: the job has none
  std::string summary;                           ///< summary.json
  std::string points;                            ///< points.csv
  std::map<std::string, ProgramFiles> programs;  ///< confirmed ones, by controller
  int exit_status = 0;
};

/// Reads what the manifest of the operation's folder names. Throws InputError for a folder that was changed;
/// with `changed`, programs that were are listed there (CheckManifest).
DoneOperation ReadOperation(const std::filesystem::path& out, const std::string& folder, const FileRoot& root,
                            std::vector<std::string>* changed = nullptr);

/// Those of all operations in `out`, in their order, with their setups as its job.yaml has them. Throws as
/// ReadOperation().
std::vector<DoneOperation> ReadOperations(const std::filesystem::path& out, const FileRoot& root,
                                          std::vector<std::string>* changed = nullptr);

/// The folders of all operations in `out`, in their order; none where the plan there is one of a single
/// operation.
std::vector<std::string> OperationFolders(const std::filesystem::path& out);

}  // namespace millpose
