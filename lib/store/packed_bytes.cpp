// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/packed_bytes.hpp"

#include <zstd.h>

#include <memory>
#include <stdexcept>

namespace millpose {
namespace {

constexpr int kWindow = 27;  // 128 MB, the most that a reader takes unasked

}  // namespace

std::string Packed(std::string_view bytes) {
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  const std::unique_ptr<ZSTD_CCtx, Free> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  // Programs of single pieces say again what stands in the whole one, megabytes before.
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_enableLongDistanceMatching, 1);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, kWindow);
  // Not a string yet: most of the room is never touched, and a plan of 10^6 points has 250 MB of programs.
  const size_t room = ZSTD_compressBound(bytes.size());
  const auto packed = std::make_unique_for_overwrite<char[]>(room);
  const size_t size = ZSTD_compress2(context.get(), packed.get(), room, bytes.data(), bytes.size());
  if (ZSTD_isError(size)) throw std::runtime_error(ZSTD_getErrorName(size));  // no memory
  return {packed.get(), size};
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
