// SPDX-License-Identifier: GPL-3.0-or-later
// The one way in which millpose writes into a folder of its own: open it (OutputFolder), collect a set beside
// the one that stands (ResultSet), put it in place as a whole (Publish). docs/output-folder.md.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/byte_sink.hpp"
#include "base/file_root.hpp"
#include "base/folder.hpp"
#include "store/folder_lock.hpp"
#include "store/manifest.hpp"

namespace millpose {

/// The name of the plan in its output folder, from which programs can be verified again.
inline constexpr const char* kPlanFile = "plan.cbor.gz";

/// In the output folder of `millpose place`: the output folders of the places that it planned.
inline constexpr const char* kPlansFolder = "plans";

/// Whether `folder` was written by millpose.
bool IsOutputFolder(const std::filesystem::path& folder);

/// Whether `folder` is the output folder of a job with several operations.
bool HoldsSeveral(const std::filesystem::path& folder);

/// Throws InputError for the output folder of a job with several operations, naming those of these.
void RefuseSeveral(const std::filesystem::path& folder);

/// Opens an output folder in which a run was ended while it put its results in place, and with that finishes
/// what it had begun; nothing where there is none. For one who is about to plan a job that stands there.
/// Throws as OutputFolder does, and for a folder that does not lie in `root`.
void FinishSwap(const std::filesystem::path& folder, const FileRoot& root);

/// What a run does in an output folder.
enum class FolderUse : uint8_t {
  kCheckpoints,  ///< adds checkpoints, beside other runs that do
  kResults,      ///< alone: writes results, and may remove checkpoints
};

/// Of the two results that are kept under one name (CheckpointStore).
enum class Kept : uint8_t { kLast, kEarlier };

/// The folder that a run writes into. It is marked as millpose's own, so that no other folder is ever
/// overwritten, and locked as long as this object lives. Whatever it holds, nothing outside of it is read,
/// moved, replaced or removed (Folder); links, pipes and the like in the place of what millpose uses are
/// refused, or removed where nobody else can have a use for them (staging, journal).
class OutputFolder {
 public:
  /// Makes the folder, or takes it over when it carries the mark. One who is to write results first puts in
  /// order what runs left that were ended: a swap is finished, or taken back where it cannot be; what was not
  /// finished writing is removed. Damage of any of it is no error. Throws InputError when the folder is not
  /// empty and is not millpose's, and when another run works there. To be called after every check of where
  /// the folder may lie.
  OutputFolder(const std::filesystem::path& folder, FolderUse use);

  /// The folder of one operation of the job whose folder this is, "01_face": its results are added to those
  /// of the whole (ResultSet::Below) and stand in operations/01_face, its checkpoints in checkpoints/01_face.
  OutputFolder Operation(const std::string& name) const;

  /// Where the results stand once they are published.
  std::filesystem::path path() const { return folder_->path() / below_; }
  const Folder& folder() const { return *folder_; }
  /// What is to be reported about the lock and about damage; lines without ends.
  std::vector<std::string> warnings() const { return *warnings_; }

  /// Writes one file (name below the folder) atomically, beside whatever stands there: no part of a set.
  void Write(const std::string& name, std::string_view bytes) const;

  /// A checkpoint's bytes; empty when there is none, or none that was written under this key.
  std::optional<std::string> ReadCheckpoint(const std::string& key, Kept which = Kept::kLast) const;
  void WriteCheckpoint(const std::string& key, std::string_view bytes) const;
  /// The same for results of a stage, a word, whose files are named by it.
  std::optional<std::string> ReadStage(const std::string& stage, const std::string& key,
                                       Kept which = Kept::kLast) const;
  void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const;
  void RemoveCheckpoints() const;
  /// Removes the results of stages alone, those of operations too: passes stay.
  void RemoveStages() const;
  /// Removes checkpoints of operations but for these ("01_face", …), as far as it can.
  void KeepOperations(const std::vector<std::string>& names) const;

 private:
  friend class ResultSet;
  std::optional<std::string> ReadCached(const std::string& file, const std::string& key) const;
  /// What stood in `file` stands in `earlier` then.
  void WriteCached(const std::string& file, const std::string& earlier, const std::string& key,
                   std::string_view bytes) const;

  std::shared_ptr<const Folder> folder_;
  std::shared_ptr<const FolderLock> lock_;
  std::shared_ptr<std::vector<std::string>> warnings_ = std::make_shared<std::vector<std::string>>();
  std::filesystem::path below_, checkpoints_;  // in the folder
};

/// Names in an output folder that are always of a set of this kind, also where no manifest says so.
using SetNames = std::vector<std::string>;
/// Of a plan, of one operation or of several; names that end in '*' are beginnings.
extern const SetNames kPlanNames;
/// Whether a name is one of these.
bool IsPlanName(const std::string& name);

/// The files of one run, collected beside those of the last one and put in their place all at once.
class ResultSet {
 public:
  /// `folder` is used for results and outlives this.
  ResultSet(const OutputFolder& folder, const SetNames& names);
  /// Those of one operation (OutputFolder::Operation), among those of all of the job: `whole`, which outlives
  /// this. Its files are staged and listed with those of the whole, which is published; this is not.
  ResultSet(ResultSet& whole, const OutputFolder& operation);
  /// Removes what was not published.
  ~ResultSet();
  ResultSet(const ResultSet&) = delete;
  ResultSet& operator=(const ResultSet&) = delete;

  /// Adds a file (name below the folder). Throws InputError.
  void Add(const std::string& name, std::string_view bytes);
  void Add(const std::string& name, const ByteSource& write);

  /// Writes the manifest of all files added so far; returns its hash, which run.json is to hold.
  std::string AddManifest(const std::string& key);
  /// run.json, which no manifest lists.
  void AddRun(std::string_view bytes);
  /// Adds what stands in the folder of an operation as it is: files, manifest and run.json.
  void AddStanding();

  /// Where the files are until they are published.
  std::filesystem::path staged() const;

  /// Waits until all files are on the disk, and puts the set in the place of the one before: of what its
  /// manifest and `names` name. Everything else stays. Where it throws (InputError), the one before stands as
  /// it was.
  void Publish();

 private:
  void Stage(const std::string& name, const ByteSource& write);
  const Folder& Staging();
  void List(const std::string& name, const Manifest::File& file);
  std::vector<std::string> NamesOfOld() const;

  const OutputFolder& folder_;
  SetNames names_;
  ResultSet* whole_ = nullptr;
  std::optional<Folder> staging_;
  Manifest manifest_;
  bool published_ = false;
};

}  // namespace millpose
