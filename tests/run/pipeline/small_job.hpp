// SPDX-License-Identifier: GPL-3.0-or-later
// A job that is planned in a moment: the sample support_pad with six points, and a folder of its own for it.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <mutex>

#include "base/error.hpp"
#include "base/file.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose::test {

/// Two passes of three points, one controller.
inline std::vector<Override> SmallOverrides() {
  return {{"toolpath.stepover_mm", "40"}, {"toolpath.spacing_mm", "40"}, {"programs", "[linuxcnc]"}};
}

inline std::filesystem::path SamplePath(const std::string& name) {
  return std::filesystem::path(SourceDir()) / name;
}

inline JobInputs SmallInputs(std::vector<Override> more = {}) {
  std::vector<Override> overrides = SmallOverrides();
  overrides.insert(overrides.end(), more.begin(), more.end());
  return LoadJobInputs(SamplePath("toolpaths/support_pad/job.yaml"), overrides);
}

/// A folder that is gone when the test is over.
class TestFolder {
 public:
  explicit TestFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / fmt::format("millpose_{}_{}", name, ::getpid())) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void Write(const std::string& name, std::string_view text) const {
    WriteFileAtomically(path_ / name, text);
  }
  std::string Read(const std::string& name) const { return ReadFile(path_ / name); }
  /// Replaces the one place where `from` is in a file.
  void Change(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = Read(name);
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    Write(name, text.replace(at, from.size(), to));
  }

 private:
  std::filesystem::path path_;
};

/// Copies of support_pad's job (six points), cell and mesh in one folder: job.yaml, cell.yaml,
/// support_pad.stl.
inline void CopySmallJob(const TestFolder& folder) {
  folder.Write("cell.yaml", ReadFile(SamplePath("cells/kr500_r2830.yaml")));
  folder.Write("support_pad.stl", ReadFile(SamplePath("toolpaths/support_pad/support_pad.stl")));
  folder.Write("job.yaml", ReadFile(SamplePath("toolpaths/support_pad/job.yaml")));
  folder.Change("job.yaml", "cell: ../../cells/kr500_r2830.yaml", "cell: cell.yaml");
  folder.Change("job.yaml", "stepover_mm: 8", "stepover_mm: 40");
  folder.Change("job.yaml", "spacing_mm: 4", "spacing_mm: 40");
  folder.Change("job.yaml", "programs: [krl, sinumerik, linuxcnc]", "programs: [linuxcnc]");
}

/// Checkpoints in memory, for all threads.
class MemoryCheckpoints final : public CheckpointStore {
 public:
  bool Read(const std::string& key, const Take& take) const override { return Offer(kept, key, take); }
  void Write(const std::string& key, std::string_view bytes) const override {
    const std::lock_guard lock(mutex_);
    Put(kept, key, std::string(bytes));
    ++writes;
  }

  bool ReadStage(const std::string& stage, const std::string& key, const Take& take) const override {
    return Offer(stages, stage, [&](const std::pair<std::string, std::string>& of) {
      return of.first == key && take(of.second);
    });
  }
  void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const override {
    const std::lock_guard lock(mutex_);
    Put(stages, stage, {key, std::string(bytes)});
  }

  template <class Value>
  using LastTwo = std::map<std::string, std::vector<Value>>;  ///< the last first
  mutable LastTwo<std::string> kept;                          ///< of passes and gaps
  mutable LastTwo<std::pair<std::string, std::string>> stages;
  mutable int writes = 0;  ///< of passes and gaps

 private:
  template <class Value>
  static void Put(LastTwo<Value>& all, const std::string& name, Value value) {
    std::vector<Value>& of = all[name];
    of.insert(of.begin(), std::move(value));
    of.resize(std::min<size_t>(of.size(), 2));
  }
  template <class Value, class Serves>
  bool Offer(const LastTwo<Value>& all, const std::string& name, const Serves& serves) const {
    std::vector<Value> of;
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = all.find(name); found != all.end()) of = found->second;
    }
    return std::ranges::any_of(of, serves);
  }

  mutable std::mutex mutex_;
};

/// The small job's plan, made once in a test program.
inline const PlannedJob& FreshPlan() {
  static const PlannedJob job = PlanJob(SmallInputs(), NoCheckpoints(), {.threads = 2});
  return job;
}

/// Everything that a planned job consists of, as bytes.
inline std::string BytesOf(const PlannedJob& job) {
  std::string bytes = Serialise(job.plan) + Serialise(job.starts.ways);
  for (const CheckedProgram& program : job.programs.programs)
    for (const auto& [name, text] : program.files) bytes += name + text;
  for (const auto& [controller, programs] : job.starts.programs)
    for (const StartProgram& start : programs)
      for (const auto& [name, text] : start.files) bytes += name + text;
  return bytes;
}

}  // namespace millpose::test
