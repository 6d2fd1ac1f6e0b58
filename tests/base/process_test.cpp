// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process.hpp"

#include <chrono>
#include <thread>

#include "base/error.hpp"

namespace millpose {

TEST(Process, StatusAndBothStreamsAreKeptApart) {
  const ProcessResult result = RunProcess({"sh", "-c", "echo out; echo err >&2; exit 7"}, {});
  EXPECT_EQ(result.status, 7);
  EXPECT_EQ(result.output, "out\n");
  EXPECT_EQ(result.errors, "err\n");
  EXPECT_GT(result.peak_memory_MB, 0);
}

TEST(Process, MuchOutputOnBothStreamsDoesNotBlock) {
  const ProcessResult result =
      RunProcess({"sh", "-c", "head -c 3000000 /dev/zero; head -c 2000000 /dev/zero >&2"}, {});
  EXPECT_EQ(result.output.size(), 3000000u);
  EXPECT_EQ(result.errors.size(), 2000000u);
}

TEST(Process, DeathBySignalIsAStatusAboveShells128) {
  EXPECT_EQ(RunProcess({"sh", "-c", "kill -9 $$"}, {}).status, 128 + 9);
}

TEST(Process, WhatCannotBeStartedIsNamed) { EXPECT_THROW(RunProcess({"/no/such/program"}, {}), InputError); }

TEST(Process, StopEndsTheChild) {
  std::stop_source source;
  std::jthread stopper([&source] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    source.request_stop();
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(RunProcess({"sleep", "60"}, source.get_token()), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

}  // namespace millpose
