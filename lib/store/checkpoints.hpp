// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace millpose {

/// Where finished passes, gaps and stages are kept, so that they are not worked out again. Called from
/// several threads.
class CheckpointStore {
 public:
  virtual ~CheckpointStore() = default;
  /// The bytes kept under this key, if there are any.
  virtual std::optional<std::string> Read(const std::string& key) const = 0;
  virtual void Write(const std::string& key, std::string_view bytes) const = 0;

  /// Of each stage the last result alone is kept: its bytes, where they were written under this key.
  virtual std::optional<std::string> ReadStage(const std::string& stage, const std::string& key) const = 0;
  virtual void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const = 0;
};

/// Keeps nothing.
class NoCheckpoints final : public CheckpointStore {
 public:
  std::optional<std::string> Read(const std::string&) const override { return std::nullopt; }
  void Write(const std::string&, std::string_view) const override {}
  std::optional<std::string> ReadStage(const std::string&, const std::string&) const override {
    return std::nullopt;
  }
  void WriteStage(const std::string&, const std::string&, std::string_view) const override {}
};

}  // namespace millpose
