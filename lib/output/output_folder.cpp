// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/output_folder.hpp"

#include <set>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_parts.hpp"
#include "base/hash.hpp"
#include "output/result_swap.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr const char* kMark = ".millpose";
constexpr const char* kCheckpoints = "checkpoints";

// What a killed run had not finished writing (see WriteFileAtomically).
void RemoveUnfinished(const fs::path& folder) {
  for (const fs::path& entry : EntriesOf(folder))
    if (entry.extension() == ".tmp") RemoveAll(entry);
}

// Whether nothing stands in the folder, or only a mark that a killed run had not finished writing.
bool IsUnused(const fs::path& folder) {
  return std::ranges::all_of(EntriesOf(folder), [](const fs::path& entry) {
    const std::string name = entry.filename().string();
    return name.starts_with(kMark) && name.ends_with(".tmp");
  });
}

std::string HashUnder(const std::string& key, std::string_view bytes) {
  Hasher hasher;
  hasher.Add(key);
  hasher.Add(bytes);
  return hasher.Digits();
}

void MakeOwn(const fs::path& folder) {
  if (Exists(folder) && !fs::is_directory(folder))
    throw InputError({folder.string()}, "exists and is not a folder; choose another with -o DIR");
  // In this order: another run may be making it just now.
  if (!IsUnused(folder) && !IsOutputFolder(folder))
    throw InputError({folder.string()}, "exists and was not written by millpose; choose another with -o DIR");
  MakeFolders(folder);
  if (IsOutputFolder(folder)) return;
  try {
    WriteFileAtomically(folder / kMark, "This folder is written by millpose; a new plan overwrites it.\n");
  } catch (const InputError&) {
    if (!IsOutputFolder(folder)) throw;  // else a run that came at the same time has marked and tidied it
  }
}

// The names that make up the set which stands in the folder. Without a manifest, as earlier versions left it,
// all but what never belongs to a set.
std::vector<std::string> NamesOfSet(const fs::path& folder) {
  std::set<std::string> names;
  if (Exists(folder / kManifestFile)) {
    const fs::path file = folder / kManifestFile;
    for (const auto& [name, content] : ParseManifest(ReadFile(file), file.string()).files)
      names.insert(fs::path(name).begin()->string());
    names.insert({kManifestFile, kRunFile, kProgramsFolder});
    for (const fs::path& entry : EntriesOf(StagingOf(folder))) names.insert(entry.filename().string());
    return {names.begin(), names.end()};
  }
  for (const fs::path& entry : EntriesOf(folder)) {
    const std::string name = entry.filename().string();
    if (name != kMark && name != kCheckpoints && name != kOperationsFolder && name != kPlansFolder &&
        !IsOfLock(name) && !IsOfSwap(name))
      names.insert(name);
  }
  return {names.begin(), names.end()};
}

}  // namespace

bool IsOutputFolder(const fs::path& folder) { return Exists(folder / kMark); }

// A run that was ended between its results and its tidying up has left both.
bool HoldsSeveral(const fs::path& folder) {
  return Exists(folder / kOperationsFolder) && !Exists(folder / kPlanFile);
}

void RefuseSeveral(const fs::path& folder) {
  if (!HoldsSeveral(folder)) return;
  std::vector<std::string> own;
  for (const fs::path& entry : EntriesOf(folder / kOperationsFolder)) own.push_back(entry.string());
  std::ranges::sort(own);
  throw InputError({folder.string()}, fmt::format("holds several operations; allowed: the folder of one: {}",
                                                  fmt::join(own, ", ")));
}

void RecoverOutputFolder(const fs::path& folder) {
  if (IsOutputFolder(folder) && IsSwapOpen(folder)) OutputFolder(folder, FolderUse::kResults);
}

OutputFolder::OutputFolder(fs::path folder, FolderUse use) : folder_(std::move(folder)) {
  MakeOwn(folder_);
  const bool alone = use == FolderUse::kResults;
  lock_.emplace(folder_, alone ? FileLock::Kind::kExclusive : FileLock::Kind::kShared);
  if (!alone) return;
  RecoverResults(folder_);
  RemoveUnfinished(folder_);
  RemoveUnfinished(folder_ / kCheckpoints);
}

void OutputFolder::Write(const std::string& name, std::string_view bytes) const {
  const fs::path path = folder_ / name;
  MakeFolders(path.parent_path());
  WriteFileAtomically(path, bytes);
}

// A checkpoint begins with the hash of its key and the rest, so that damage is found, and one that stands
// under another's name.
std::optional<std::string> OutputFolder::ReadKept(const std::string& file, const std::string& key) const {
  const fs::path path = folder_ / kCheckpoints / file;
  if (!Exists(path)) return std::nullopt;
  std::string bytes = ReadFile(path);
  const size_t digits = Hash({}).size();
  if (bytes.size() < digits) return std::nullopt;
  const std::string stated = bytes.substr(0, digits);
  bytes.erase(0, digits);
  if (HashUnder(key, bytes) != stated) return std::nullopt;
  return bytes;
}

void OutputFolder::WriteKept(const std::string& file, const std::string& key, std::string_view bytes) const {
  const fs::path path = folder_ / kCheckpoints / file;
  MakeFolders(path.parent_path());
  WriteFileAtomically(path, [&](const ByteSink& sink) {
    sink(HashUnder(key, bytes));
    sink(bytes);
  });
}

std::optional<std::string> OutputFolder::ReadCheckpoint(const std::string& key) const {
  return ReadKept(key + ".cbor", key);
}

void OutputFolder::WriteCheckpoint(const std::string& key, std::string_view bytes) const {
  WriteKept(key + ".cbor", key, bytes);
}

std::optional<std::string> OutputFolder::ReadStage(const std::string& stage, const std::string& key) const {
  return ReadKept(stage + ".stage", key);
}

void OutputFolder::WriteStage(const std::string& stage, const std::string& key,
                              std::string_view bytes) const {
  WriteKept(stage + ".stage", key, bytes);
}

void OutputFolder::RemoveCheckpoints() const { RemoveAll(folder_ / kCheckpoints); }

ResultSet::ResultSet(const OutputFolder& folder) : folder_(folder) {
  RemoveAll(StagingOf(folder.path()));
  MakeFolders(StagingOf(folder.path()));
}

// A swap that could not be ended needs its files: they are left to whoever repairs it.
ResultSet::~ResultSet() {
  std::error_code ignored;
  if (!published_) fs::remove_all(StagingOf(folder_.path()), ignored);
}

void ResultSet::Stage(const std::string& name, const ByteSource& write) const {
  const fs::path path = StagingOf(folder_.path()) / name;
  MakeFolders(path.parent_path());
  WriteFileAtomically(path, write);
}

void ResultSet::Add(const std::string& name, std::string_view bytes) {
  Add(name, [&](const ByteSink& sink) { sink(bytes); });
}

void ResultSet::Add(const std::string& name, const ByteSource& write) {
  Hasher hasher;
  size_t size = 0;
  Stage(name, [&](const ByteSink& sink) {
    write([&](std::string_view bytes) {
      hasher.Add(bytes);
      size += bytes.size();
      sink(bytes);
    });
  });
  manifest_.files[name] = {size, hasher.Digits()};
}

std::string ResultSet::AddManifest(const std::string& key) {
  manifest_.key = key;
  const std::string text = ManifestJson(manifest_);
  Stage(kManifestFile, [&](const ByteSink& sink) { sink(text); });
  return Hash(text);
}

void ResultSet::Publish() {
  const fs::path staging = StagingOf(folder_.path());
  std::set<fs::path> folders{staging};
  for (const auto& [name, file] : manifest_.files)
    for (fs::path path = (staging / name).parent_path(); path != staging; path = path.parent_path())
      folders.insert(path);
  for (const fs::path& folder : folders) SyncFolder(folder);
  const std::vector<std::string> old = NamesOfSet(folder_.path());
  published_ = true;
  SwapResults(folder_.path(), old);
}

}  // namespace millpose
