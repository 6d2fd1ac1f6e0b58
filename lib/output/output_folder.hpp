// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/byte_sink.hpp"
#include "output/folder_lock.hpp"
#include "output/manifest.hpp"

namespace millpose {

/// The name of the plan in its output folder, from which programs can be verified again.
inline constexpr const char* kPlanFile = "plan.cbor";

/// In the output folder of a job with several operations: the output folders of these.
inline constexpr const char* kOperationsFolder = "operations";

/// In the output folder of `millpose place`: the output folders of the places that it planned.
inline constexpr const char* kPlansFolder = "plans";

/// Whether `folder` was written by millpose.
bool IsOutputFolder(const std::filesystem::path& folder);

/// Whether `folder` is the output folder of a job with several operations.
bool HoldsSeveral(const std::filesystem::path& folder);

/// Throws InputError for the output folder of a job with several operations, naming those of these.
void RefuseSeveral(const std::filesystem::path& folder);

/// Finishes what a run that was ended while it put its results in place had begun, where there is any.
/// Throws InputError where that cannot be done, or another run works there.
void RecoverOutputFolder(const std::filesystem::path& folder);

/// What a run does in an output folder.
enum class FolderUse : uint8_t {
  kCheckpoints,  ///< adds checkpoints, beside other runs that do
  kResults,      ///< alone: writes results, and may remove checkpoints
};

/// The folder that a plan writes into. It is marked as millpose's own, so that no other folder is ever
/// overwritten, and locked as long as this object lives.
class OutputFolder {
 public:
  /// Makes the folder, or takes it over when it carries the mark; one who is to write results first repairs
  /// it (RecoverOutputFolder). Throws InputError when it exists, is not empty and is not millpose's, and when
  /// another run works there.
  OutputFolder(std::filesystem::path folder, FolderUse use);

  const std::filesystem::path& path() const { return folder_; }
  /// What is to be reported about the lock; empty when all is well.
  const std::string& warning() const { return lock_->warning(); }

  /// Writes one file (name relative to the folder) atomically.
  void Write(const std::string& name, std::string_view bytes) const;

  /// A checkpoint's bytes; empty when there is none, or none that was written under this key.
  std::optional<std::string> ReadCheckpoint(const std::string& key) const;
  void WriteCheckpoint(const std::string& key, std::string_view bytes) const;
  /// The same for the last result of a stage, a word, whose file is named by it.
  std::optional<std::string> ReadStage(const std::string& stage, const std::string& key) const;
  void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const;
  void RemoveCheckpoints() const;

 private:
  std::optional<std::string> ReadKept(const std::string& file, const std::string& key) const;
  void WriteKept(const std::string& file, const std::string& key, std::string_view bytes) const;

  std::filesystem::path folder_;
  std::optional<FolderLock> lock_;
};

/// The files of one plan, collected beside those of the last one and put in their place all at once.
class ResultSet {
 public:
  /// `folder` is used for results and outlives this.
  explicit ResultSet(const OutputFolder& folder);
  /// Removes what was not published.
  ~ResultSet();
  ResultSet(const ResultSet&) = delete;
  ResultSet& operator=(const ResultSet&) = delete;

  /// Adds a file; it is on the disk when this returns. Throws InputError.
  void Add(const std::string& name, std::string_view bytes);
  void Add(const std::string& name, const ByteSource& write);

  /// Writes the manifest of all files added so far; returns its hash, which run.json is to hold.
  std::string AddManifest(const std::string& key);

  /// Puts the set in the place of the one before. Where it throws (InputError), that one stands as it was.
  void Publish();

 private:
  void Stage(const std::string& name, const ByteSource& write) const;

  const OutputFolder& folder_;
  Manifest manifest_;
  bool published_ = false;
};

}  // namespace millpose
