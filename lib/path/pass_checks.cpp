// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/pass_checks.hpp"

#include "base/cpu_time.hpp"
#include "base/parallel.hpp"

namespace millpose {

CheckCounts CheckInParallel(const World& world, size_t count, int threads, std::stop_token stop,
                            const std::function<void(Checker&, size_t)>& work) {
  // Chunks of fixed size, a checker each: what a checker remembers cannot depend on the number of threads.
  constexpr size_t kChunk = 16;
  const size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<CheckCounts> counts(chunks);
  ParallelFor(chunks, threads, stop, [&](size_t chunk) {
    const CpuTimer timer(CpuPart::kInterference);
    Checker checker(world);
    for (size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) work(checker, i);
    counts[chunk] = checker.counts();
  });
  CheckCounts sum;
  for (const CheckCounts& chunk : counts) sum += chunk;
  return sum;
}

std::string Describe(const Interference& interference) {
  return fmt::format("{} and {} {} at ({:.1f}, {:.1f}, {:.1f}) mm", interference.first, interference.second,
                     interference.distance > 0 ? fmt::format("come within {:.2f} mm", interference.distance)
                                               : std::string("touch"),
                     interference.place().x(), interference.place().y(), interference.place().z());
}

}  // namespace millpose
