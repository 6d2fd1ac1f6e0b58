// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace millpose {

/// Where finished passes and gaps are kept, so that they are not planned again. Called from several threads.
class CheckpointStore {
 public:
  virtual ~CheckpointStore() = default;
  /// The bytes kept under this key, if there are any.
  virtual std::optional<std::string> Read(const std::string& key) const = 0;
  virtual void Write(const std::string& key, std::string_view bytes) const = 0;
};

/// Keeps nothing.
class NoCheckpoints final : public CheckpointStore {
 public:
  std::optional<std::string> Read(const std::string&) const override { return std::nullopt; }
  void Write(const std::string&, std::string_view) const override {}
};

}  // namespace millpose
