// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace millpose {

/// 32 hexadecimal digits that identify `bytes` (XXH3, 128 bits): for checkpoints and program headers, not
/// against forgery.
std::string Hash(std::string_view bytes);

/// The same of bytes that come in parts.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  void Add(std::string_view bytes);
  /// Hash() of all bytes added so far.
  std::string Digits() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace millpose
