// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/output_folder.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr const char* kMark = ".millpose";
constexpr const char* kCheckpoints = "checkpoints";
constexpr const char* kPrograms = "programs";
constexpr const char* kProgramsUnfinished = "programs.unfinished";

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError({folder.string()}, "cannot make this folder: " + error.message());
}

// What a killed run had not finished writing (see WriteFileAtomically).
void RemoveUnfinished(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".tmp") fs::remove(entry.path());
}

// Whether nothing stands in the folder, or only a mark that a killed run had not finished writing.
bool IsUnused(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kMark) || !name.ends_with(".tmp")) return false;
  }
  return true;
}

}  // namespace

bool IsOutputFolder(const fs::path& folder) { return fs::exists(folder / kMark); }

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  if (fs::exists(folder_) && !fs::is_directory(folder_))
    throw InputError({folder_.string()}, "exists and is not a folder; choose another with -o DIR");
  if (fs::exists(folder_) && !IsOutputFolder(folder_) && !IsUnused(folder_))
    throw InputError({folder_.string()},
                     "exists and was not written by millpose; choose another with -o DIR or remove it");
  MakeFolder(folder_);
  if (!IsOutputFolder(folder_))
    WriteFileAtomically(folder_ / kMark, "This folder is written by millpose; a new plan overwrites it.\n");
}

void OutputFolder::Write(const std::string& name, std::string_view bytes) const {
  const fs::path path = folder_ / name;
  MakeFolder(path.parent_path());
  WriteFileAtomically(path, bytes);
}

void OutputFolder::RemoveResults() const {
  RemoveUnfinished(folder_ / kCheckpoints);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    if (entry.path().filename() != kMark && entry.path().filename() != kCheckpoints)
      fs::remove_all(entry.path());
}

void OutputFolder::WritePrograms(const std::map<std::string, std::string>& files) const {
  const fs::path unfinished = folder_ / kProgramsUnfinished;
  fs::remove_all(unfinished);
  for (const auto& [name, bytes] : files) Write((fs::path(kProgramsUnfinished) / name).string(), bytes);
  if (!files.empty()) fs::rename(unfinished, folder_ / kPrograms);
}

// A checkpoint begins with the hash of the rest, so that damage is found.
std::optional<std::string> OutputFolder::ReadCheckpoint(const std::string& key) const {
  const fs::path path = folder_ / kCheckpoints / (key + ".cbor");
  if (!fs::exists(path)) return std::nullopt;
  std::string bytes = ReadFile(path);
  const size_t digits = Hash({}).size();
  if (bytes.size() < digits || Hash(std::string_view(bytes).substr(digits)) != bytes.substr(0, digits))
    return std::nullopt;
  return bytes.substr(digits);
}

void OutputFolder::WriteCheckpoint(const std::string& key, std::string_view bytes) const {
  Write((fs::path(kCheckpoints) / (key + ".cbor")).string(), Hash(bytes) + std::string(bytes));
}

void OutputFolder::RemoveCheckpoints() const { fs::remove_all(folder_ / kCheckpoints); }

}  // namespace millpose
