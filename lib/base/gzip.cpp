// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/gzip.hpp"

#include <zlib.h>

#include <algorithm>
#include <stdexcept>

namespace millpose {
namespace {

// Doubles hardly pack: the quickest level makes a plan as small as the best but for some percent.
constexpr int kLevel = Z_BEST_SPEED;
constexpr int kZlibStream = MAX_WBITS, kGzipFile = MAX_WBITS + 16;  // what `windowBits` of zlib stands for
constexpr size_t kZlibMost = size_t{1} << 30;                       // bytes; zlib counts them in 32 bits

Bytef* In(std::string_view bytes) { return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data())); }

std::string Deflated(std::string_view bytes, int window) {
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, window, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  size_t read = 0, written = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    const size_t in = std::min(kZlibMost, bytes.size() - read),
                 out = std::min(kZlibMost, packed.size() - written);
    stream.next_in = In(bytes.substr(read));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(packed.data() + written);
    stream.avail_out = static_cast<uInt>(out);
    status = deflate(&stream, read + in == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    read += in - stream.avail_in;
    written += out - stream.avail_out;
  }
  deflateEnd(&stream);
  packed.resize(written);
  return packed;
}

}  // namespace

std::string Gzip(std::string_view bytes) { return Deflated(bytes, kGzipFile); }

std::string ZlibBytes(std::string_view bytes) { return Deflated(bytes, kZlibStream); }

std::optional<std::string> Gunzip(std::string_view file) {
  constexpr size_t kMostTimes = 200, kPart = 1 << 20;
  z_stream stream{};
  if (inflateInit2(&stream, kGzipFile) != Z_OK) throw std::bad_alloc();
  const size_t most = kMostTimes * file.size();
  std::string bytes;
  size_t read = 0, written = 0;
  int status = Z_BUF_ERROR;
  while (read < file.size() && written <= most) {
    const size_t in = std::min(kZlibMost, file.size() - read);
    if (bytes.size() < written + kPart) bytes.resize(std::max(2 * bytes.size(), written + kPart));
    const size_t out = std::min(kZlibMost, bytes.size() - written);
    stream.next_in = In(file.substr(read));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + written);
    stream.avail_out = static_cast<uInt>(out);
    status = inflate(&stream, Z_NO_FLUSH);
    read += in - stream.avail_in;
    written += out - stream.avail_out;
    if (status == Z_STREAM_END)
      inflateReset(&stream);  // another member may follow
    else if (status != Z_OK)
      break;
  }
  inflateEnd(&stream);
  if (status != Z_STREAM_END || read != file.size() || written > most) return {};
  bytes.resize(written);
  return bytes;
}

}  // namespace millpose
