// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#if defined(MILLPOSE_OWN_LOOP)
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include "base/error.hpp"

namespace millpose {

void CheckStop(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Interrupted();
}

#if defined(MILLPOSE_OWN_LOOP)
// Debian's TBB is not instrumented: the sanitizer would see races where there are none, and miss others.
void ParallelFor(size_t count, int threads, std::stop_token stop, const std::function<void(size_t)>& work) {
  std::atomic<size_t> next = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto run = [&] {
    try {
      for (size_t i = next++; i < count; i = next++) {
        CheckStop(stop);
        work(i);
      }
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::jthread> others;
  for (size_t t = 1; t < std::min(count, static_cast<size_t>(std::max(1, threads))); ++t)
    others.emplace_back(run);
  run();
  others.clear();
  if (failure) std::rethrow_exception(failure);
}
#else
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
#endif

}  // namespace millpose
