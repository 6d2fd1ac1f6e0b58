// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>
#include <thread>

#include "base/progress.hpp"

namespace millpose {

/// How work is carried out; results never depend on it.
struct Execution {
  int threads = 0;                ///< 0: all cores
  Progress& progress = Silent();  ///< hears how far it has come
  std::stop_token stop = {};      ///< ends it with Interrupted

  int Threads() const {
    return threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  }
};

}  // namespace millpose
