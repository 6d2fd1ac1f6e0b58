// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>

namespace millpose {

/// Receives how far long work has come. Thread-safe; the library never prints by itself.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage begins that consists of `total` units of work (points, passes, gaps; 0 when it cannot be
  /// counted).
  virtual void Begin(std::string_view stage, size_t total) = 0;
  /// `count` more units of the running stage are done.
  virtual void Advance(size_t count) = 0;
  /// The running stage, which cannot be counted, has come so far.
  virtual void Percent(int /*percent*/) {}
  /// The running stage is done; `outcome` is one line for the user.
  virtual void End(std::string_view outcome) = 0;
};

/// A Progress that ignores everything.
Progress& Silent();

}  // namespace millpose
