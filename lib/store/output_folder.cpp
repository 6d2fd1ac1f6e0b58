// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/output_folder.hpp"

#include <set>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/writer_name.hpp"
#include "store/packed_bytes.hpp"
#include "store/result_swap.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPassEnding = ".kept";  // of a file in checkpoints/: a pass, a gap, triangles
constexpr const char* kMarkText = "This folder is written by millpose; a new plan overwrites it.\n";

std::string FileOf(const std::string& name, Kept which, const char* ending) {
  return name + (which == Kept::kEarlier ? ".earlier" : "") + ending;
}

// Another run that adds checkpoints may have put the file aside in the meantime, or have written it anew.
void PutAside(const Folder& folder, const std::string& file, const std::string& as) {
  const std::string before = folder.Identity(file);
  try {
    folder.Move(file, folder, as);
  } catch (const InputError&) {
    if (!before.empty() && folder.Identity(file) == before) throw;
  }
}

bool IsMarked(const Folder& folder) { return folder.KindOf(kMark) == Folder::Kind::kFile; }

// What a run that has ended had not finished writing. Of other machines only one who is alone knows; of this
// one, who waits for the folder may be writing that it does.
void RemoveUnfinished(const Folder& folder, bool alone) {
  for (const std::string& name : folder.Names())
    if (alone ? IsOfNoWriterHere(name) : IsOfEndedWriter(name)) folder.RemoveAll(name);
}

void RemoveUnfinishedCheckpoints(const Folder& folder, bool alone) {
  const std::optional<Folder> checkpoints = folder.FindBelow(kCheckpointsFolder);
  if (!checkpoints) return;
  RemoveUnfinished(*checkpoints, alone);
  for (const std::string& name : checkpoints->Names())
    if (checkpoints->KindOf(name) == Folder::Kind::kFolder) RemoveUnfinished(checkpoints->Below(name), alone);
}

void RemoveStagesIn(const Folder& checkpoints) {
  for (const std::string& name : checkpoints.Names())
    if (name.ends_with(kStageEnding) && checkpoints.KindOf(name) == Folder::Kind::kFile)
      checkpoints.RemoveAll(name);
}

// Whether nothing stands in the folder, or only what a run leaves that was killed while it took it over or
// removed it.
bool IsUnused(const Folder& folder) {
  return std::ranges::all_of(folder.Names(),
                             [](const std::string& name) { return IsTemporaryName(name) || IsOfLock(name); });
}

std::string HashUnder(const std::string& key, std::string_view bytes) {
  Hasher hasher;
  hasher.Add(key);
  hasher.Add(bytes);
  return hasher.Digits();
}

std::shared_ptr<const Folder> MakeOwn(const fs::path& path) {
  if (Exists(path) && !fs::is_directory(path))
    throw InputError({path.string()}, "exists and is not a folder; choose another with -o DIR");
  auto folder = std::make_shared<const Folder>(Folder::Made(path));
  // In this order: another run may be making it just now.
  if (!IsUnused(*folder) && !IsMarked(*folder))
    throw InputError({path.string()}, "exists and was not written by millpose; choose another with -o DIR");
  if (IsMarked(*folder)) return folder;
  try {
    folder->Write(kMark, kMarkText);
  } catch (const InputError&) {
    if (!IsMarked(*folder)) throw;  // else a run that came at the same time has marked and tidied it
  }
  return folder;
}

bool Matches(const std::string& name, const SetNames& names) {
  return std::ranges::any_of(names, [&](const std::string& known) {
    return known.ends_with('*') ? name.starts_with(known.substr(0, known.size() - 1)) : name == known;
  });
}

// The first components of what the folder's manifest lists; none where it cannot be read, which `damage` then
// says.
std::set<std::string> ListedIn(const Folder& folder, std::string* damage) {
  std::set<std::string> names;
  if (folder.KindOf(kManifestFile) == Folder::Kind::kNothing) return names;
  const std::string file = (folder.path() / kManifestFile).string();
  try {
    for (const auto& [name, content] : ParseManifest(folder.Read(kManifestFile), file).files)
      names.insert(fs::path(name).begin()->string());
  } catch (const InputError& error) {
    *damage = error.what();
  }
  return names;
}

// Has to be a folder where it is there at all: what is written below it is to stay in the output folder.
void RefuseInPlaceOfFolder(const Folder& folder, const char* name) {
  if (folder.KindOf(name) != Folder::Kind::kNothing) folder.Below(name);
}

}  // namespace

const SetNames kPlanNames{
    "job.yaml",       "cell.yaml",        kPlanFile,     "starts.cbor",   "points.csv",     "path.vtp",
    "deflection.csv", "compensation.csv", "face.csv",    "summary.json",  "report.html",    "trajectory-*",
    "meshes",         kRunFile,           kManifestFile, kProgramsFolder, kOperationsFolder};

bool IsPlanName(const std::string& name) { return Matches(name, kPlanNames); }

bool IsOutputFolder(const fs::path& folder) { return fs::is_directory(folder) && IsMarked(Folder(folder)); }

bool HoldsSeveral(const fs::path& folder) {
  if (!fs::is_directory(folder)) return false;
  const Folder open(folder);
  return open.KindOf(kOperationsFolder) == Folder::Kind::kFolder &&
         open.KindOf(kPlanFile) == Folder::Kind::kNothing;
}

void RefuseSeveral(const fs::path& folder) {
  if (!HoldsSeveral(folder)) return;
  std::vector<std::string> own;
  for (const std::string& name : Folder(folder).Below(kOperationsFolder).Names())
    own.push_back((folder / kOperationsFolder / name).string());
  throw InputError({folder.string()}, fmt::format("holds several operations; allowed: the folder of one: {}",
                                                  fmt::join(own, ", ")));
}

void FinishSwap(const fs::path& folder, const FileRoot& root) {
  if (!IsOutputFolder(folder) || !IsSwapOpen(Folder(folder))) return;
  root.CheckFolder(folder);
  OutputFolder(folder, FolderUse::kResults);
}

OutputFolder::OutputFolder(const fs::path& path, FolderUse use)
    : folder_(MakeOwn(path)), checkpoints_(kCheckpointsFolder) {
  const bool alone = use == FolderUse::kResults;
  lock_ =
      std::make_shared<const FolderLock>(path, alone ? FileLock::Kind::kExclusive : FileLock::Kind::kShared);
  if (!lock_->warning().empty()) warnings_->push_back(lock_->warning());
  RefuseInPlaceOfFolder(*folder_, kCheckpointsFolder);
  if (alone)
    if (const std::string damage = RecoverResults(*folder_); !damage.empty()) warnings_->push_back(damage);
  RemoveUnfinished(*folder_, alone);
  RemoveUnfinishedCheckpoints(*folder_, alone);
}

OutputFolder OutputFolder::Operation(const std::string& name) const {
  OutputFolder operation = *this;
  operation.below_ = fs::path(kOperationsFolder) / name;
  operation.checkpoints_ = fs::path(kCheckpointsFolder) / name;
  return operation;
}

void OutputFolder::Write(const std::string& name, std::string_view bytes) const {
  folder_->Write(below_ / name, bytes);
}

// A checkpoint begins with the hash of its key and the rest, so that damage is found, and one that stands
// under another's name. So nobody waits until it is on the disk: a plan of 10,000 points writes 400.
std::optional<std::string> OutputFolder::ReadCached(const std::string& file, const std::string& key) const {
  if (folder_->KindOf(checkpoints_ / file) != Folder::Kind::kFile) return std::nullopt;
  std::string bytes = folder_->Read(checkpoints_ / file);
  const size_t digits = Hash({}).size();
  if (bytes.size() < digits) return std::nullopt;
  const std::string stated = bytes.substr(0, digits);
  bytes.erase(0, digits);
  if (HashUnder(key, bytes) != stated) return std::nullopt;
  return Unpacked(bytes);
}

void OutputFolder::WriteCached(const std::string& file, const std::string& earlier, const std::string& key,
                               std::string_view bytes) const {
  const Folder folder = folder_->MakeBelow(checkpoints_);
  const Folder::Kind kind = folder.KindOf(file);
  if (kind == Folder::Kind::kFolder) folder.RemoveAll(file);  // no checkpoint of ours
  if (kind == Folder::Kind::kFile) PutAside(folder, file, earlier);
  const std::string packed = Packed(bytes);
  folder.Write(
      file,
      [&](const ByteSink& sink) {
        sink(HashUnder(key, packed));
        sink(packed);
      },
      OnDisk::kLater);
}

std::optional<std::string> OutputFolder::ReadCheckpoint(const std::string& key, Kept which) const {
  return ReadCached(FileOf(key, which, kPassEnding), key);
}

void OutputFolder::WriteCheckpoint(const std::string& key, std::string_view bytes) const {
  WriteCached(FileOf(key, Kept::kLast, kPassEnding), FileOf(key, Kept::kEarlier, kPassEnding), key, bytes);
}

std::optional<std::string> OutputFolder::ReadStage(const std::string& stage, const std::string& key,
                                                   Kept which) const {
  return ReadCached(FileOf(stage, which, kStageEnding), key);
}

void OutputFolder::WriteStage(const std::string& stage, const std::string& key,
                              std::string_view bytes) const {
  WriteCached(FileOf(stage, Kept::kLast, kStageEnding), FileOf(stage, Kept::kEarlier, kStageEnding), key,
              bytes);
}

void OutputFolder::RemoveCheckpoints() const {
  if (const std::optional<Folder> parent = folder_->FindBelow(checkpoints_.parent_path()))
    parent->RemoveAll(checkpoints_.filename().string());
}

void OutputFolder::RemoveStages() const {
  const std::optional<Folder> checkpoints = folder_->FindBelow(checkpoints_);
  if (!checkpoints) return;
  RemoveStagesIn(*checkpoints);
  for (const std::string& name : checkpoints->Names())
    if (checkpoints->KindOf(name) == Folder::Kind::kFolder) RemoveStagesIn(checkpoints->Below(name));
}

void OutputFolder::KeepOperations(const std::vector<std::string>& names) const {
  try {
    const std::optional<Folder> checkpoints = folder_->FindBelow(kCheckpointsFolder);
    if (!checkpoints) return;
    for (const std::string& name : checkpoints->Names())
      if (checkpoints->KindOf(name) == Folder::Kind::kFolder && std::ranges::find(names, name) == names.end())
        checkpoints->RemoveAll(name);
  } catch (const InputError&) {  // the results stand; what stays is in nobody's way
  }
}

ResultSet::ResultSet(const OutputFolder& folder, const SetNames& names) : folder_(folder), names_(names) {}

ResultSet::ResultSet(ResultSet& whole, const OutputFolder& operation) : folder_(operation), whole_(&whole) {
  Stage(kMark, [](const ByteSink& sink) { sink(kMarkText); });
}

// A swap that could not be ended needs its files: they are left to whoever repairs it.
ResultSet::~ResultSet() {
  if (whole_ || published_ || !staging_) return;
  try {
    folder_.folder().RemoveAll(kStagingFolder);
  } catch (const InputError&) {  // the next run removes it
  }
}

// Made for the first file: until then another set may be staged, or none is.
const Folder& ResultSet::Staging() {
  if (whole_) return whole_->Staging();
  if (!staging_) {
    folder_.folder().RemoveAll(kStagingFolder);
    staging_.emplace(FolderFor(folder_.folder(), kStagingFolder));
  }
  return *staging_;
}

void ResultSet::Stage(const std::string& name, const ByteSource& write) {
  Staging().Write(folder_.below_ / name, write, OnDisk::kLater);  // Publish() waits for all of them
}

void ResultSet::List(const std::string& name, const Manifest::File& file) {
  manifest_.files[name] = file;
  if (whole_) whole_->manifest_.files[(folder_.below_ / name).string()] = file;
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
  List(name, {size, hasher.Digits()});
}

std::string ResultSet::AddManifest(const std::string& key) {
  manifest_.key = key;
  const std::string text = ManifestJson(manifest_);
  Stage(kManifestFile, [&](const ByteSink& sink) { sink(text); });
  if (whole_) List(kManifestFile, {text.size(), Hash(text)});
  return Hash(text);
}

void ResultSet::AddRun(std::string_view bytes) {
  Stage(kRunFile, [&](const ByteSink& sink) { sink(bytes); });
}

void ResultSet::AddStanding() {
  const Folder standing = folder_.folder().Below(folder_.below_);
  const Manifest manifest = ParseManifest(standing.Read(kManifestFile), kManifestFile);
  for (const auto& [name, file] : manifest.files) {
    Add(name, standing.Read(name));
    if (manifest_.files.at(name).hash != file.hash)
      throw InputError({(standing.path() / name).string()}, "was changed while it was read");
  }
  AddManifest(manifest.key);
  AddRun(standing.Read(kRunFile));
}

fs::path ResultSet::staged() const { return folder_.folder().path() / kStagingFolder / folder_.below_; }

// The names of the set that stands there. Throws nothing where the manifest is damaged: then names tell.
std::vector<std::string> ResultSet::NamesOfOld() const {
  const Folder& folder = folder_.folder();
  std::string damage;
  const std::set<std::string> listed = ListedIn(folder, &damage);
  const std::vector<std::string> fresh = folder.Below(kStagingFolder).Names();
  std::vector<std::string> old, foreign;
  for (const std::string& name : folder.Names()) {
    if (!IsOfSet(name) || IsTemporaryName(name)) continue;
    const bool ours = Matches(name, names_) || listed.contains(name) || std::ranges::count(fresh, name) > 0;
    (ours ? old : foreign).push_back(name);
  }
  if (!damage.empty())
    folder_.warnings_->push_back(
        damage +
        (foreign.empty() ? "" : fmt::format("; not millpose's and left: {}", fmt::join(foreign, ", "))));
  return old;
}

void ResultSet::Publish() {
  Staging().SyncAll();
  const std::vector<std::string> old = NamesOfOld();
  published_ = true;
  SwapResults(folder_.folder(), old);
}

}  // namespace millpose
