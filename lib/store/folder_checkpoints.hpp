// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "store/checkpoints.hpp"
#include "store/output_folder.hpp"

namespace millpose {

/// Checkpoints in an output folder; `read`: earlier ones count.
class FolderCheckpoints final : public CheckpointStore {
 public:
  FolderCheckpoints(const OutputFolder& folder, bool read) : folder_(folder), read_(read) {}
  std::optional<std::string> Read(const std::string& key) const override {
    return read_ ? folder_.ReadCheckpoint(key) : std::nullopt;
  }
  void Write(const std::string& key, std::string_view bytes) const override {
    folder_.WriteCheckpoint(key, bytes);
  }
  std::optional<std::string> ReadStage(const std::string& stage, const std::string& key) const override {
    return read_ ? folder_.ReadStage(stage, key) : std::nullopt;
  }
  void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const override {
    folder_.WriteStage(stage, key, bytes);
  }

 private:
  const OutputFolder& folder_;
  bool read_;
};

}  // namespace millpose
