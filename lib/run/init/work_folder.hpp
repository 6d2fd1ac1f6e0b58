// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "store/output_folder.hpp"

namespace millpose {

/// What init leaves in its folder.
inline constexpr std::array kWritten = {"cell.yaml", "job.yaml"};

/// The folder that init works in: beside the one to come, so that relative paths hold in both. It outlives a
/// kill and an interrupt: the next init for the same folder finds what was planned there, goes on, and
/// removes it.
class WorkFolder {
 public:
  static std::filesystem::path PathFor(const std::filesystem::path& out);

  explicit WorkFolder(const std::filesystem::path& out);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  /// Leaves it to the next init.
  void Stay() { stays_ = true; }

  std::filesystem::path CellFile() const { return path_ / kWritten[0]; }
  /// Not job.yaml: in a folder of millpose's that is the resolved job of a plan.
  std::filesystem::path Job() const { return path_ / "first_job.yaml"; }
  void WriteCell(const std::string& text) const { folder_->Write(kWritten[0], text); }
  void WriteJob(const std::string& text) const { folder_->Write("first_job.yaml", text); }
  /// The folder of a trial, from 1.
  std::filesystem::path Trial(int number) const;

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  ///< parents that were missing, the innermost first
  std::optional<OutputFolder> folder_;
  bool stays_ = false;
};

}  // namespace millpose
