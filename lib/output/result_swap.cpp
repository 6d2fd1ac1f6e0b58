// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/result_swap.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "output/manifest.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kStaging = ".staging";
constexpr const char* kReplaced = ".replaced";
constexpr const char* kJournal = ".journal";

// Where a name of the new set stands tells how far the swap came: still staged, or in its place. So each step
// can be done again, forwards and back, and nothing else need be written down.
class Swap {
 public:
  Swap(fs::path folder, std::vector<std::string> fresh, std::vector<std::string> old)
      : folder_(std::move(folder)), fresh_(std::move(fresh)), old_(std::move(old)) {}

  // Programs go first and come last: they never stand beside reports of another plan.
  void Forward() const {
    MakeFolders(folder_ / kReplaced);
    for (const std::string& name : ProgramsFirst(old_)) {
      const bool is_new = IsIn(fresh_, name) && !Exists(folder_ / kStaging / name);
      if (!is_new) Move(folder_ / name, folder_ / kReplaced / name);
    }
    std::vector<std::string> fresh = ProgramsFirst(fresh_);
    std::ranges::reverse(fresh);
    for (const std::string& name : fresh) Move(folder_ / kStaging / name, folder_ / name);
    SyncFolder(folder_);
  }

  void Back() const {
    MakeFolders(folder_ / kStaging);
    for (const std::string& name : ProgramsFirst(fresh_))
      if (!Exists(folder_ / kStaging / name)) Move(folder_ / name, folder_ / kStaging / name);
    std::vector<std::string> old = ProgramsFirst(old_);
    std::ranges::reverse(old);
    for (const std::string& name : old) Move(folder_ / kReplaced / name, folder_ / name);
    SyncFolder(folder_);
  }

  // Whether every file of the new set is there.
  bool CanGoForward() const {
    return std::ranges::all_of(fresh_, [&](const std::string& name) {
      return Exists(folder_ / kStaging / name) || Exists(folder_ / name);
    });
  }

 private:
  static bool IsIn(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  }
  static std::vector<std::string> ProgramsFirst(std::vector<std::string> names) {
    std::stable_partition(names.begin(), names.end(),
                          [](const std::string& name) { return name == kProgramsFolder; });
    return names;
  }
  static void Move(const fs::path& from, const fs::path& to) {
    if (Exists(from)) Rename(from, to);
  }

  fs::path folder_;
  std::vector<std::string> fresh_, old_;
};

void WriteJournal(const fs::path& folder, const std::vector<std::string>& fresh,
                  const std::vector<std::string>& old) {
  WriteFileAtomically(folder / kJournal, Json{{"new", fresh}, {"old", old}}.dump(2) + "\n");
  SyncFolder(folder);
}

Swap ReadJournal(const fs::path& folder) {
  try {
    const Json json = Json::parse(ReadFile(folder / kJournal));
    return {folder, json.at("new").get<std::vector<std::string>>(),
            json.at("old").get<std::vector<std::string>>()};
  } catch (const Json::exception& error) {
    throw InputError({(folder / kJournal).string()}, fmt::format("is damaged: {}", error.what()));
  }
}

// What stays of the other set is in nobody's way, and the next run removes it.
void RemoveRest(const fs::path& folder) {
  for (const char* name : {kReplaced, kStaging}) {
    std::error_code ignored;
    fs::remove_all(folder / name, ignored);
  }
}

}  // namespace

fs::path StagingOf(const fs::path& folder) { return folder / kStaging; }

bool IsOfSwap(const std::string& name) { return name == kStaging || name == kReplaced || name == kJournal; }

bool IsSwapOpen(const fs::path& folder) { return Exists(folder / kJournal); }

void SwapResults(const fs::path& folder, const std::vector<std::string>& old) {
  std::vector<std::string> fresh;
  for (const fs::path& entry : EntriesOf(folder / kStaging)) fresh.push_back(entry.filename().string());
  RemoveAll(folder / kReplaced);
  const Swap swap(folder, fresh, old);
  try {
    WriteJournal(folder, fresh, old);
    swap.Forward();
    RemoveAll(folder / kJournal);  // with it the swap is ended
  } catch (const InputError&) {
    swap.Back();
    RemoveAll(folder / kJournal);
    RemoveRest(folder);
    throw;
  }
  RemoveRest(folder);
}

void RecoverResults(const fs::path& folder) {
  if (IsSwapOpen(folder)) {
    const Swap swap = ReadJournal(folder);
    bool forward = swap.CanGoForward();
    try {
      if (forward) swap.Forward();
    } catch (const InputError&) {
      forward = false;
    }
    if (!forward) swap.Back();
    RemoveAll(folder / kJournal);
  }
  for (const char* name : {kReplaced, kStaging}) RemoveAll(folder / name);
}

}  // namespace millpose
