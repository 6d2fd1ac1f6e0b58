// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

namespace millpose {

/// What is known of a batch while it runs; times in s.
struct BatchState {
  std::vector<double> ended;    ///< how long each job took that this run planned
  std::vector<double> running;  ///< how long each has run so far
  size_t waiting = 0;           ///< jobs that have not begun
  size_t places = 1;            ///< jobs that run at a time
};

/// How long until the last job ends, s, about; empty until one has ended. A job is taken to last as long as
/// those that ended did in the mean, where those that run already longer count with what they have run. One
/// that has run longer than that is taken to need half as long again.
std::optional<double> TimeLeft(const BatchState& state);

}  // namespace millpose
