// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#include <atomic>
#include <thread>

#include "base/error.hpp"

namespace millpose {

TEST(ParallelFor, VisitsEachIndexOnce) {
  for (const int threads : {1, 2, 4}) {
    std::vector<std::atomic<int>> visits(1000);
    ParallelFor(visits.size(), threads, {}, [&](size_t i) { ++visits[i]; });
    for (const auto& count : visits) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, StopsAndPassesExceptionsOn) {
  std::stop_source source;
  std::atomic<int> done = 0;
  EXPECT_THROW(ParallelFor(100000, 2, source.get_token(),
                           [&](size_t) {
                             if (++done == 10) source.request_stop();
                           }),
               Interrupted);
  EXPECT_LT(done, 1000);
  EXPECT_THROW(ParallelFor(10, 2, {}, [](size_t) { throw InputError({"f"}, "bad"); }), InputError);
}

TEST(ParallelFor, NothingToDoIsDone) {
  ParallelFor(0, 4, {}, [](size_t) { FAIL(); });
  int done = 0;
  ParallelFor(3, 0, {}, [&](size_t) { ++done; });  // no fewer than one thread
  EXPECT_EQ(done, 3);
}

TEST(ParallelFor, WorkMayHaveWorkOfItsOwn) {
  std::vector<std::atomic<int>> visits(50 * 40);
  ParallelFor(50, 3, {}, [&](size_t i) { ParallelFor(40, 2, {}, [&](size_t j) { ++visits[40 * i + j]; }); });
  for (const auto& count : visits) EXPECT_EQ(count, 1);
}

// Loops begun by several threads at once, each with loops of its own: nobody waits for whom it holds up.
TEST(ParallelFor, LoopsOfManyThreadsComeToAnEnd) {
  std::vector<std::atomic<int>> visits(8 * 6 * 50);
  std::vector<std::jthread> callers;
  for (size_t c = 0; c < 8; ++c)
    callers.emplace_back([&, c] {
      ParallelFor(6, 3, {}, [&](size_t i) {
        ParallelFor(50, 4, {}, [&](size_t j) { ++visits[(c * 6 + i) * 50 + j]; });
      });
    });
  callers.clear();
  for (const auto& count : visits) EXPECT_EQ(count, 1);
}

TEST(ParallelFor, AStopThatCameBeforeLetsNothingBegin) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(ParallelFor(10, 2, source.get_token(), [](size_t) { ADD_FAILURE(); }), Interrupted);
  EXPECT_THROW(CheckStop(source.get_token()), Interrupted);
  EXPECT_NO_THROW(CheckStop({}));
}

}  // namespace millpose
