// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/result_swap.hpp"

#include <nlohmann/json.hpp>
#include <set>

#include "base/error.hpp"
#include "store/folder_lock.hpp"
#include "store/manifest.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;
using Kind = Folder::Kind;
using Names = std::vector<std::string>;
constexpr const char* kReplaced = ".replaced";
constexpr const char* kJournal = ".journal";
constexpr size_t kLongestJournal = size_t{16} << 20;  // bytes

bool IsIn(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

bool Stands(const Folder& folder, const std::string& name) { return folder.KindOf(name) != Kind::kNothing; }

// What the folder holds; nothing where it is none.
Names NamesIn(const Folder& folder, const std::string& below) {
  return folder.KindOf(below) == Kind::kFolder ? folder.Below(below).Names() : Names();
}

// The manifest first, then what the robot runs, then what tells about it.
Names InOrder(Names names) {
  const Names first{kManifestFile, kProgramsFolder, kOperationsFolder};
  std::ranges::stable_sort(
      names, {}, [&](const std::string& name) { return std::ranges::find(first, name) - first.begin(); });
  return names;
}

// Where a name of the new set stands tells how far the swap came: still staged, or in its place. So each step
// can be done again, forwards and back, and nothing else need be written down.
class Swap {
 public:
  Swap(const Folder& folder, Names fresh, Names old)
      : folder_(folder),
        staging_(FolderFor(folder, kStagingFolder)),
        replaced_(FolderFor(folder, kReplaced)),
        fresh_(InOrder(std::move(fresh))),
        old_(InOrder(std::move(old))) {}

  // Programs are never beside reports of another plan, and a manifest never beside another's files.
  void Forward() const {
    for (const std::string& name : old_)
      if (!IsPlaced(name)) Move(folder_, name, replaced_);
    for (auto name = fresh_.rbegin(); name != fresh_.rend(); ++name) Move(staging_, *name, folder_);
    folder_.Sync();
  }

  void Back() const {
    for (const std::string& name : fresh_)
      if (IsPlaced(name) && CameBefore(name)) Move(folder_, name, staging_);
    for (auto name = old_.rbegin(); name != old_.rend(); ++name) Move(replaced_, *name, folder_);
    folder_.Sync();
  }

  // Whether every file of the new set is there.
  bool CanGoForward() const {
    return std::ranges::all_of(fresh_, [&](const std::string& name) {
      return Stands(staging_, name) || (Stands(folder_, name) && CameBefore(name));
    });
  }

 private:
  bool IsPlaced(const std::string& name) const { return IsIn(fresh_, name) && !Stands(staging_, name); }
  // Whether what stands in place of a name that is not staged is the new one: the old one has gone.
  bool CameBefore(const std::string& name) const { return !IsIn(old_, name) || Stands(replaced_, name); }
  static void Move(const Folder& from, const std::string& name, const Folder& to) {
    if (Stands(from, name)) from.Move(name, to);
  }

  const Folder& folder_;
  Folder staging_, replaced_;
  Names fresh_, old_;
};

void WriteJournal(const Folder& folder, const Names& fresh, const Names& old) {
  folder.RemoveAll(kJournal);  // whatever stands there in place of a file
  folder.Write(kJournal, Json{{"new", fresh}, {"old", old}}.dump(2) + "\n");
  folder.Sync();
}

Names CheckedNames(const Json& json) {
  auto names = json.get<Names>();
  for (const std::string& name : names)
    if (!IsOfSet(name)) throw InputError({kJournal}, fmt::format("names {:?}, which is no result", name));
  return names;
}

// What the journal says; throws InputError for one that is damaged, or names what no swap moves.
std::pair<Names, Names> ReadJournal(const Folder& folder) {
  try {
    const Json json = Json::parse(folder.Read(kJournal, kLongestJournal));
    return {CheckedNames(json.at("new")), CheckedNames(json.at("old"))};
  } catch (const Json::exception&) {
    throw InputError({kJournal}, "is no journal of millpose");
  }
}

// The names of a set by its manifest and by what is there of it.
Names NamesBy(const Folder& folder, const std::string& below) {
  const Folder part = folder.Below(below);
  const std::vector<std::string> there = part.Names();
  std::set<std::string> names(there.begin(), there.end());
  const Manifest manifest = ParseManifest(part.Read(kManifestFile), kManifestFile);
  for (const auto& [name, file] : manifest.files) names.insert(std::filesystem::path(name).begin()->string());
  Names own(names.begin(), names.end());
  std::erase_if(own, [](const std::string& name) { return !IsOfSet(name); });
  return own;
}

// What a damaged journal said, as far as it can be told: both manifests are out of their place.
std::optional<std::pair<Names, Names>> TellFromManifests(const Folder& folder) {
  try {
    return std::pair{NamesBy(folder, kStagingFolder), NamesBy(folder, kReplaced)};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// Where nothing tells what was to be done: what has gone and nothing has come for comes back.
void GiveBack(const Folder& folder) {
  for (const std::string& name : NamesIn(folder, kReplaced))
    if (IsOfSet(name) && !Stands(folder, name)) folder.Below(kReplaced).Move(name, folder);
}

// What stays of the other set is in nobody's way, and the next run removes it.
void RemoveRest(const Folder& folder) {
  for (const char* name : {kReplaced, kStagingFolder}) try {
      folder.RemoveAll(name);
    } catch (const InputError&) {
    }
}

void Finish(const Folder& folder, const std::pair<Names, Names>& names) {
  const Swap swap(folder, names.first, names.second);
  bool forward = swap.CanGoForward();
  try {
    if (forward) swap.Forward();
  } catch (const InputError&) {
    forward = false;
  }
  if (!forward) swap.Back();
}

// Where the journal does not say it.
void FinishWithoutJournal(const Folder& folder) {
  if (Stands(folder, kManifestFile)) return;  // nothing was moved yet, or all
  if (const auto names = TellFromManifests(folder))
    Finish(folder, *names);
  else
    GiveBack(folder);
}

}  // namespace

Folder FolderFor(const Folder& folder, const std::string& name) {
  if (folder.KindOf(name) != Kind::kFolder) folder.RemoveAll(name);
  return folder.MakeBelow(name);
}

bool IsOfSet(const std::string& name) {
  constexpr size_t kLongestName = 255;  // that a file system has, bytes
  return IsPlainName(name) && name.size() <= kLongestName && name != kStagingFolder && name != kReplaced &&
         name != kJournal && name != kMark && name != kCheckpointsFolder && !IsOfLock(name);
}

bool IsSwapOpen(const Folder& folder) { return Stands(folder, kJournal); }

void SwapResults(const Folder& folder, const Names& old) {
  Names fresh = NamesIn(folder, kStagingFolder);
  std::erase_if(fresh, [](const std::string& name) { return !IsOfSet(name); });
  folder.RemoveAll(kReplaced);
  const Swap swap(folder, fresh, old);
  try {
    WriteJournal(folder, fresh, old);
    swap.Forward();
    folder.RemoveAll(kJournal);  // with it the swap is ended
  } catch (const InputError&) {
    swap.Back();
    folder.RemoveAll(kJournal);
    RemoveRest(folder);
    throw;
  }
  RemoveRest(folder);
}

std::string RecoverResults(const Folder& folder) {
  std::string damage;
  if (IsSwapOpen(folder)) {
    std::optional<std::pair<Names, Names>> names;
    try {
      names = ReadJournal(folder);
    } catch (const InputError& error) {
      damage = fmt::format("{}: {}; it was put aside", (folder.path() / kJournal).string(),
                           error.problems().front().message);
    }
    names ? Finish(folder, *names) : FinishWithoutJournal(folder);
    folder.RemoveAll(kJournal);
  }
  for (const char* name : {kReplaced, kStagingFolder}) folder.RemoveAll(name);
  return damage;
}

}  // namespace millpose
