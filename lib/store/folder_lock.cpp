// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/folder_lock.hpp"

#include <fmt/chrono.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/writer_name.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kLockFile = ".lock";
constexpr const char* kOwnerPrefix = ".owner.";
constexpr size_t kLongestOwner = 65536;  // bytes of such a file
constexpr int kTakes = 3;                // of a lock that was busy and that nobody is known to have
constexpr int kLooks = 50;               // for the one who has the lock
constexpr std::chrono::milliseconds kBetweenLooks{20};

// Who works in a folder, as its owner file says.
struct Owner {
  fs::path file;
  std::string host, since;
  int process = 0;
  bool alone = false;  // writes results
};

// Several locks of one process, on whatever folders, have a file each.
int NextNumber() {
  static std::atomic<int> next = 1;
  return next++;
}

Owner Self(const fs::path& folder, FileLock::Kind kind) {
  const std::string host = HostName();
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return {folder / fmt::format("{}{}.{}.{}", kOwnerPrefix, host, ::getpid(), NextNumber()), host,
          fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now)), ::getpid(),
          kind == FileLock::Kind::kExclusive};
}

void Write(const Owner& owner) {
  const Json json{
      {"host", owner.host}, {"process", owner.process}, {"since", owner.since}, {"alone", owner.alone}};
  WriteFileAtomically(owner.file, json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

// False where it cannot be written just now: one who has the folder may be tidying it.
bool TryWrite(const Owner& owner) {
  try {
    Write(owner);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// Whether a process of this machine is known to have ended. Of another machine nothing can be known.
bool HasEnded(const Owner& owner) {
  return owner.host == HostName() && ::kill(owner.process, 0) != 0 && errno == ESRCH;
}

// What an owner file says. None where it cannot be read: it is of one who has just ended, or was not finished
// by one who was killed.
std::optional<Owner> ReadOwner(const Folder& folder, const std::string& name) {
  try {
    const Json json = Json::parse(folder.Read(name, kLongestOwner));
    return Owner{folder.path() / name, json.at("host").get<std::string>(),
                 json.at("since").get<std::string>(), json.at("process").get<int>(),
                 json.at("alone").get<bool>()};
  } catch (const InputError&) {
  } catch (const Json::exception&) {
  }
  return std::nullopt;
}

// Those who say that they work in the folder and may still do.
std::vector<Owner> OthersIn(const fs::path& folder, const fs::path& own_file) {
  std::vector<Owner> owners;
  const Folder open(folder);
  for (const std::string& name : open.Names()) {
    if (!name.starts_with(kOwnerPrefix) || name.ends_with(".tmp") || name == own_file.filename()) continue;
    if (const std::optional<Owner> owner = ReadOwner(open, name); owner && !HasEnded(*owner))
      owners.push_back(*owner);
  }
  return owners;
}

// Who has the lock that is busy. One who has only just taken it may have to say so anew: the one before it
// tidies away what it takes for left behind.
std::vector<Owner> HoldersOf(const fs::path& folder, const fs::path& own_file) {
  std::vector<Owner> holders = OthersIn(folder, own_file);
  for (int look = 0; look < kLooks && holders.empty(); ++look) {
    std::this_thread::sleep_for(kBetweenLooks);
    holders = OthersIn(folder, own_file);
  }
  return holders;
}

[[noreturn]] void Refuse(const fs::path& folder, const std::vector<Owner>& owners, bool locks) {
  std::vector<std::string> who;
  for (const Owner& owner : owners)
    who.push_back(
        fmt::format("process {} on {} since {}{}", owner.process, owner.host, owner.since,
                    locks ? "" : fmt::format(" (if it has ended, remove {})", owner.file.string())));
  throw InputError({folder.string()},
                   fmt::format("another run works in this folder: {}; wait for its end or choose another "
                               "with -o DIR",
                               who.empty() ? "who is not known" : fmt::format("{}", fmt::join(who, ", "))));
}

// What runs that were killed left: for one who is alone here all, for others of this machine.
void RemoveOwners(const fs::path& folder, const fs::path& own_file, bool alone) {
  const Folder open(folder);
  for (const std::string& name : open.Names()) {
    if (!name.starts_with(kOwnerPrefix) || name == own_file.filename()) continue;
    try {
      const std::optional<Owner> owner = ReadOwner(open, name);
      if (alone || (owner && HasEnded(*owner))) open.RemoveAll(name);
    } catch (const InputError&) {  // one that stays only misleads where somebody else is named
    }
  }
}

}  // namespace

bool IsOfLock(const std::string& name) { return name == kLockFile || name.starts_with(kOwnerPrefix); }

FolderLock::FolderLock(const fs::path& folder, FileLock::Kind kind) : lock_(folder / kLockFile) {
  const Owner self = Self(folder, kind);
  owner_file_ = self.file;
  // Before the lock is asked for: who has it has always said so, and of two that come at once where there are
  // no locks at least one sees the other.
  const bool said = TryWrite(self);
  FileLock::Outcome outcome = lock_.Take(kind);
  std::vector<Owner> others;
  for (int again = 0; outcome == FileLock::Outcome::kBusy && again <= kTakes; ++again) {
    others = HoldersOf(folder, self.file);
    if (!others.empty()) break;
    outcome = lock_.Take(kind);  // who had it has ended since
  }
  if (outcome == FileLock::Outcome::kNoLocksHere) {
    others = OthersIn(folder, self.file);
    warning_ = fmt::format("{}: the file system has no locks: only {} keeps two runs in this folder apart",
                           folder.string(), self.file.filename().string());
    std::erase_if(others, [&](const Owner& other) { return !other.alone && !self.alone; });
  }
  if (outcome == FileLock::Outcome::kBusy || !others.empty()) {
    RemoveAll(owner_file_);
    Refuse(folder, others, outcome == FileLock::Outcome::kBusy);
  }
  if (!said || !fs::exists(self.file)) Write(self);
  RemoveOwners(folder, self.file, self.alone);
}

FolderLock::~FolderLock() {
  std::error_code ignored;  // a file that stays is removed by the next run
  if (!owner_file_.empty()) fs::remove(owner_file_, ignored);
}

}  // namespace millpose
