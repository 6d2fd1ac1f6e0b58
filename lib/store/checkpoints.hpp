// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace millpose {

/// Where finished passes, gaps and stages are kept, so that they are not worked out again. Under each key of
/// a pass or gap, and of each stage, the last two results are kept: what an edit replaced is found again
/// where the edit is undone. Called from several threads.
class CheckpointStore {
 public:
  /// Is handed bytes that were kept; returns whether they serve.
  using Take = std::function<bool(const std::string& bytes)>;

  virtual ~CheckpointStore() = default;
  /// Hands over what is kept under this key, the last result first, until one serves; returns whether one
  /// did.
  virtual bool Read(const std::string& key, const Take& take) const = 0;
  virtual void Write(const std::string& key, std::string_view bytes) const = 0;

  /// The same of a stage, of those results that were written under this key.
  virtual bool ReadStage(const std::string& stage, const std::string& key, const Take& take) const = 0;
  virtual void WriteStage(const std::string& stage, const std::string& key, std::string_view bytes) const = 0;
};

/// Keeps nothing.
class NoCheckpoints final : public CheckpointStore {
 public:
  bool Read(const std::string&, const Take&) const override { return false; }
  void Write(const std::string&, std::string_view) const override {}
  bool ReadStage(const std::string&, const std::string&, const Take&) const override { return false; }
  void WriteStage(const std::string&, const std::string&, std::string_view) const override {}
};

}  // namespace millpose
