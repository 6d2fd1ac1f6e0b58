// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

namespace millpose {

/// Calls `work(i)` for every i in 0..count-1 on `threads` threads. Which thread takes which i is not fixed,
/// so `work` must write only what belongs to i. Throws Interrupted when `stop` was requested; an exception of
/// `work` is passed on.
void ParallelFor(size_t count, int threads, std::stop_token stop, const std::function<void(size_t)>& work);

/// Throws Interrupted when a stop was requested.
void CheckStop(const std::stop_token& stop);

}  // namespace millpose
