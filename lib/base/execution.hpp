// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>
#include <thread>

#include "base/process.hpp"
#include "base/progress.hpp"

namespace millpose {

/// How work is carried out; results never depend on it.
struct Execution {
  int threads = 0;                ///< 0: all cores
  Progress& progress = Silent();  ///< hears how far it has come
  std::stop_token stop = {};      ///< ends it with Interrupted
  double memory = 0;              ///< bytes that candidates may take at a time; 0: half of the machine's

  int Threads() const {
    return threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  }
  double Memory() const { return memory > 0 ? memory : MachineMemory() / 2; }
};

}  // namespace millpose
