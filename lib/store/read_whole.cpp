// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/read_whole.hpp"

#include <chrono>
#include <thread>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "store/manifest.hpp"
#include "store/output_folder.hpp"
#include "store/result_swap.hpp"

namespace millpose {
namespace {

constexpr int kAttempts = 3;
constexpr std::chrono::milliseconds kPauseBetween{100};

// Which set stands there, as far as a reader can tell without reading all of it. A swap moves the manifest
// even where it puts the same one back, and that changes what the system says of it.
struct Standing {
  std::string identity, text;
  bool being_replaced = false;
  bool operator==(const Standing&) const = default;
};

Standing StandingIn(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_directory(path, none)) return {"", "", false};  // an operation's, just now moved
  const Folder folder(path);
  Standing standing{folder.Identity(kManifestFile), "", false};
  if (folder.KindOf(kManifestFile) == Folder::Kind::kFile) try {
      standing.text = folder.Read(kManifestFile);
    } catch (const InputError&) {  // moved this moment, or not to be read: then `reading` says so
    }
  standing.being_replaced = standing.identity.empty() && IsSwapOpen(folder);
  return standing;
}

constexpr const char* kUnpacked = "plan.cbor";  // how earlier versions named the plan

// What a reader is about to open must be of this folder and of this version.
void RefuseOthers(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_directory(path, none)) return;
  const Folder folder(path);
  for (const std::string& name : folder.Names())
    if (IsPlanName(name) && folder.KindOf(name) == Folder::Kind::kOther)
      folder.Read(name);  // says what it is
  if (folder.KindOf(kUnpacked) == Folder::Kind::kFile && folder.KindOf(kPlanFile) == Folder::Kind::kNothing)
    throw InputError({(path / kUnpacked).string()},
                     "is of an earlier version; allowed: the folder planned again by this one");
}

}  // namespace

void ReadWhole(const std::filesystem::path& folder, const std::function<void()>& reading) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(attempt * kPauseBetween);
    const Standing before = StandingIn(folder);
    if (before.being_replaced) continue;
    std::exception_ptr refusal;
    try {
      RefuseOthers(folder);
      reading();
    } catch (const InputError&) {
      refusal = std::current_exception();
    } catch (const std::filesystem::filesystem_error&) {  // a folder that went while it was listed
      refusal = std::current_exception();
    }
    if (StandingIn(folder) != before) continue;
    if (refusal) std::rethrow_exception(refusal);
    return;
  }
  throw InputError({folder.string()},
                   "is being replaced by another run, or was when that was ended; try again later, or plan "
                   "again, which finishes it");
}

PlanResult ReadPlanIn(const std::filesystem::path& folder, const FileRoot& root) {
  const std::filesystem::path file = folder / kPlanFile;
  return ParsePlanFile(root.Read(file), file.string());
}

}  // namespace millpose
