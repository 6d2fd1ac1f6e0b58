// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.hpp"

#include <xxhash.h>

namespace millpose {

namespace {

std::string ToDigits(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string Hash(std::string_view bytes) { return ToDigits(XXH3_128bits(bytes.data(), bytes.size())); }

struct Hasher::State {
  XXH3_state_t* value = XXH3_createState();
  ~State() { XXH3_freeState(value); }
};

Hasher::Hasher() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->value); }
Hasher::~Hasher() = default;

void Hasher::Add(std::string_view bytes) { XXH3_128bits_update(state_->value, bytes.data(), bytes.size()); }

std::string Hasher::Digits() const { return ToDigits(XXH3_128bits_digest(state_->value)); }

}  // namespace millpose
