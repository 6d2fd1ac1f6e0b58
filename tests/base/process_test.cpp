// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process.hpp"

#include <chrono>
#include <filesystem>
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

TEST(Process, ReadsItsInputAndEachLineOfItsErrorsIsHeard) {
  std::vector<std::string> heard;
  const std::string input(200000, 'x');
  const ProcessResult result =
      RunProcess({"sh", "-c", "wc -c; echo one >&2; echo two >&2; printf rest >&2"}, {}, input,
                 [&](std::string_view line) { heard.emplace_back(line); });
  EXPECT_EQ(result.output, "200000\n");
  EXPECT_EQ(result.errors, "one\ntwo\nrest");
  EXPECT_EQ(heard, (std::vector<std::string>{"one", "two"}));
}

TEST(Process, AChildThatDoesNotReadItsInputIsNoHarm) {
  EXPECT_EQ(RunProcess({"true"}, {}, std::string(300000, 'x')).status, 0);
}

// Its streams are closed, so nothing more is heard of it.
TEST(Process, StopEndsAChildThatClosedItsStreamsToo) {
  std::stop_source source;
  std::jthread stopper([&source] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    source.request_stop();
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(RunProcess({"sh", "-c", "exec sleep 20 >&- 2>&-"}, source.get_token()), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Process, KnowsItselfAndItsMachine) {
  EXPECT_EQ(std::filesystem::path(OwnProgram()).filename(), "test_base");
  EXPECT_EQ(ProgramId().size(), 32u);
  EXPECT_EQ(ProgramId(), ProgramId());
  EXPECT_GT(MachineMemory(), 1e8);
}

}  // namespace millpose
