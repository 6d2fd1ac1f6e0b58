// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "base/error.hpp"

namespace millpose {

void CheckStop(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Interrupted();
}

void ParallelFor(size_t count, int threads, std::stop_token stop, const std::function<void(size_t)>& work) {
  // More threads than cores are allowed when asked for: the arena alone sets the number.
  static const tbb::global_control any_number(tbb::global_control::max_allowed_parallelism, 1024);
  tbb::task_arena arena(std::max(1, threads));
  arena.execute([&] {
    tbb::parallel_for(size_t{0}, count, [&](size_t i) {
      CheckStop(stop);
      work(i);
    });
  });
}

}  // namespace millpose
