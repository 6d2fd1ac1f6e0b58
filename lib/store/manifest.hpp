// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace millpose {

inline constexpr const char* kManifestFile = "manifest.json";
inline constexpr const char* kRunFile = "run.json";  ///< what differs from run to run; it names the manifest
inline constexpr const char* kProgramsFolder = "programs";
/// In the output folder of a job with several operations: the output folders of these.
inline constexpr const char* kOperationsFolder = "operations";

/// What one plan wrote, with all its operations, so that files of two plans are never taken for one. run.json
/// is not listed, because it differs from run to run; it holds the hash of the manifest instead.
struct Manifest {
  std::string key;  ///< of all inputs of the plan: JobInputs::hash
  struct File {
    size_t bytes = 0;
    std::string hash;
  };
  std::map<std::string, File> files;  ///< by name, relative to the folder
};

std::string ManifestJson(const Manifest& manifest);
/// Throws InputError naming `name` for what is no manifest.
Manifest ParseManifest(std::string_view text, const std::string& name);

/// Reads a folder's manifest and every file that it names, through no link. Throws InputError with all that
/// is missing or differs, programs that it does not name, and a run.json of another plan. With `changed`,
/// programs that differ are no error but listed there by their names in the folder: somebody edited them.
Manifest CheckManifest(const std::filesystem::path& folder, std::vector<std::string>* changed = nullptr);

}  // namespace millpose
