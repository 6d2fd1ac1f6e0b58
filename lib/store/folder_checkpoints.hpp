// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "store/checkpoints.hpp"
#include "store/output_folder.hpp"

namespace millpose {

/// Checkpoints in an output folder; `read`: earlier ones count.
class FolderCheckpoints final : public CheckpointStore {
 public:
  FolderCheckpoints(const OutputFolder& folder, bool read) : folder_(folder), read_(read) {}
  bool Read(const std::string& key, const Take& take) const override {
    return Any([&](Kept which) { return folder_.ReadCheckpoint(key, which); }, take);
  }
  void Write(const std::string& key, std::string_view bytes) const override {
    folder_.WriteCheckpoint(key, bytes);
  }
  bool ReadStage(const std::string& stage, const std::string& key, const Take& take) const override {
    return Any([&](Kept which) { return folder_.ReadStage(stage, key, which); }, take);
  }
  void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const override {
    folder_.WriteStage(stage, key, bytes);
  }

 private:
  bool Any(const std::function<std::optional<std::string>(Kept)>& read, const Take& take) const {
    if (!read_) return false;
    for (const Kept which : {Kept::kLast, Kept::kEarlier})
      if (const auto bytes = read(which); bytes && take(*bytes)) return true;
    return false;
  }

  const OutputFolder& folder_;
  bool read_;
};

}  // namespace millpose
