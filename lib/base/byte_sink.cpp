// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/byte_sink.hpp"

#include <algorithm>

#include "base/parallel.hpp"

namespace millpose {
namespace {

constexpr size_t kAtOnce = 8;  // texts a thread that wait to be written: few, as each may be a megabyte

}  // namespace

std::string BytesOf(const ByteSource& source) {
  std::string bytes;
  source([&](std::string_view part) { bytes += part; });
  return bytes;
}

void WriteInOrder(size_t count, int threads, const std::stop_token& stop,
                  const std::function<std::string(size_t)>& make, const ByteSink& sink) {
  const size_t most = kAtOnce * static_cast<size_t>(std::max(1, threads));
  for (size_t first = 0; first < count; first += most) {
    std::vector<std::string> texts(std::min(most, count - first));
    ParallelFor(texts.size(), threads, stop, [&](size_t i) { texts[i] = make(first + i); });
    for (const std::string& text : texts) sink(text);
  }
}

}  // namespace millpose
