// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes that come in parts, so that large files need never be in memory as a whole.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

namespace millpose {

/// Takes bytes in the order in which they are to stand.
using ByteSink = std::function<void(std::string_view)>;
/// Hands its bytes to a sink, in as many parts as it likes.
using ByteSource = std::function<void(const ByteSink&)>;

/// All of them together.
std::string BytesOf(const ByteSource& source);

/// Hands the texts that `make(i)` returns for i in 0..count-1 to `sink` in the order of i. They are made on
/// `threads` threads, a few at a time. Throws as ParallelFor() does.
void WriteInOrder(size_t count, int threads, const std::stop_token& stop,
                  const std::function<std::string(size_t)>& make, const ByteSink& sink);

}  // namespace millpose
