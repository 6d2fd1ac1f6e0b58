// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/packed_bytes.hpp"

#include <zstd.h>

#include <stdexcept>

namespace millpose {

std::string Packed(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size)) throw std::runtime_error(ZSTD_getErrorName(size));  // no memory
  packed.resize(size);
  return packed;
}

std::optional<std::string> Unpacked(std::string_view packed) {
  constexpr unsigned long long kMost = 1ULL << 32;  // bytes: what a damaged frame may ask for
  const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR || stated == ZSTD_CONTENTSIZE_UNKNOWN || stated > kMost) return {};
  std::string bytes(stated, '\0');
  const size_t size = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) || size != stated) return {};
  return bytes;
}

}  // namespace millpose
