// SPDX-License-Identifier: GPL-3.0-or-later
// LinuxCNC's own interpreter judges the campaign's one, and a sample of the mutants that are confirmed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <regex>

#include "tests/base/tier.hpp"
#include "tests/campaign/bed.hpp"
#include "tests/campaign/mutations.hpp"
#include "tests/campaign/runner.hpp"
#include "tests/program/interpreter.hpp"

namespace millpose::campaign {
namespace {

constexpr double kSame = 1e-4;      // rs274 prints four decimals
constexpr double kSpindle = 1.6;    // 1/min: the judge's bound
constexpr double kStanding = 2e-4;  // of motions that go nowhere

/// X … C of every canonical move of rs274.
std::vector<Joints> MovesOf(const std::string& canonical) {
  std::vector<Joints> moves;
  for (const std::string& line : LinesOf(canonical)) {
    const size_t begin = line.find("STRAIGHT_");
    if (begin == std::string::npos) continue;
    Joints words;
    if (std::sscanf(line.c_str() + line.find('(', begin), "(%lf, %lf, %lf, %lf, %lf, %lf)", &words[0],
                    &words[1], &words[2], &words[3], &words[4], &words[5]) == 6)
      moves.push_back(words);
  }
  return moves;
}

/// Likewise of a trace.
std::vector<Joints> MovesOf(const Trace& trace) {
  std::vector<Joints> moves;
  for (const Step& step : trace.steps)
    if (step.programmed) moves.push_back(*step.programmed);
  return moves;
}

/// Without those that go nowhere; rs274 begins at 0.
std::vector<Joints> Moving(const std::vector<Joints>& moves) {
  std::vector<Joints> moving;
  Joints last = Joints::Zero();
  for (const Joints& move : moves) {
    if ((move - last).cwiseAbs().maxCoeff() <= kStanding) continue;
    moving.push_back(move);
    last = move;
  }
  return moving;
}

bool StartsFromAnywhere(const Trace& trace) {
  return std::any_of(trace.steps.begin(), trace.steps.end(),
                     [](const Step& step) { return step.words == "from where the machine stands"; });
}

void ExpectSameMoves(const std::string& canonical, const Trace& trace, const std::string& what) {
  const std::vector<Joints> theirs = Moving(MovesOf(canonical)), ours = Moving(MovesOf(trace));
  ASSERT_EQ(theirs.size(), ours.size()) << what;
  for (size_t k = 0; k < ours.size(); ++k)
    EXPECT_LT((theirs[k] - ours[k]).cwiseAbs().maxCoeff(), kSame) << what << " move " << k;
}

struct Call {
  std::string name, arguments;
};

/// What a program switches and sets, in order; what is set again as it is, feeds, waits and rounding left
/// out.
std::vector<Call> CallsOf(const std::string& canonical) {
  std::vector<Call> calls;
  std::map<std::string, std::string> held;
  for (const std::string& line : LinesOf(canonical)) {
    const size_t open = line.find('('), blank = line.rfind(' ', open);  // "   12 N..... NAME(arguments)"
    if (open == std::string::npos || blank == std::string::npos) continue;
    const std::string name = line.substr(blank + 1, open - blank - 1);
    static const std::set<std::string> left_out = {"STRAIGHT_FEED",
                                                   "STRAIGHT_TRAVERSE",
                                                   "SET_FEED_RATE",
                                                   "SET_FEED_MODE",
                                                   "COMMENT",
                                                   "MESSAGE",
                                                   "SELECT_PLANE",
                                                   "DWELL",
                                                   "PROGRAM_STOP",
                                                   "ON_RESET",
                                                   "OPTIONAL_PROGRAM_STOP",
                                                   "SET_MOTION_CONTROL_MODE",
                                                   "SET_NAIVECAM_TOLERANCE"};
    if (left_out.contains(name)) continue;
    const std::string arguments = line.substr(open, line.find(')') - open);
    const bool sets = name.starts_with("USE_") || name.starts_with("SET_G") || name.starts_with("SET_XY");
    if (sets && held[name] == arguments) continue;
    held[name] = arguments;
    calls.push_back({name, arguments});
  }
  return calls;
}

bool Same(const Call& a, const Call& b) {
  double x = 0, y = 0;
  const bool speed = a.name == "SET_SPINDLE_SPEED" && b.name == a.name &&
                     std::sscanf(a.arguments.c_str(), "(0, %lf", &x) == 1 &&
                     std::sscanf(b.arguments.c_str(), "(0, %lf", &y) == 1;
  return speed ? std::abs(x - y) < kSpindle : a.name == b.name && a.arguments == b.arguments;
}

const Bed& LinuxCncBed(size_t i) { return *Beds()[Beds().size() - 1 - i % 2]; }

/// The own interpreter runs what rs274 runs, to the same places, and refuses what it refuses.
TEST(Campaign, TheOwnInterpreterAgreesWithRs274) {
  const size_t count = static_cast<size_t>(OfTier(40, 300));
  size_t compared = 0, accepted = 0;
  for (size_t i = 0; compared < count; ++i) {
    const Bed& bed = LinuxCncBed(i);
    RandomStream random(static_cast<uint64_t>(OfTier(3, 4)), i);
    const Mutant mutant = Mutate(bed.files(), bed.other(), bed.controller(), random);
    const std::string& text = mutant.files.begin()->second;
    bool moot = false;  // the operator's switch, inches, parameters, a tool table, places that are stored
    for (const char* word :
         {"\n/", "G20", "#", "o100", "o<", "G41", "G43", "T1", "G7\n", "G7 ", "G28", "G30", "G38", "G52"})
      moot = moot || text.find(word) != std::string::npos;
    if (moot || mutant.file.empty()) continue;
    ++compared;
    const Trace trace = bed.Run(mutant.files);
    const Interpreted judge = Interpret(text);
    const std::string what =
        fmt::format("[{}] '{}' -> '{}': {}", mutant.kind, mutant.before, mutant.after, trace.refused);
    if (judge.status != 0) {
      EXPECT_NE(trace.refused, "") << what
                                   << judge.canonical.substr(judge.canonical.size() -
                                                             std::min<size_t>(300, judge.canonical.size()));
      continue;
    }
    const bool reach = trace.refused.find("reach") != std::string::npos ||       // rs274 has no arm,
                       trace.refused.find("from nowhere") != std::string::npos;  // and begins at 0
    if (!reach) {
      EXPECT_EQ(trace.refused, "") << what;
    }
    if (!trace.refused.empty() || StartsFromAnywhere(trace)) continue;
    ++accepted;
    ExpectSameMoves(judge.canonical, trace, what);
  }
  EXPECT_GT(accepted, count / 4);
}

/// What millpose confirms rs274 runs, with the moves that were judged, and sets and switches as in the
/// original.
TEST(Campaign, Rs274RunsConfirmedMutantsAsJudged) {
  std::array<std::vector<Call>, 2> originals;
  for (size_t i = 0; i < 2; ++i)
    originals[i] = CallsOf(Interpret(LinuxCncBed(i).files().begin()->second).canonical);
  EXPECT_GT(originals[0].size(), 20u);
  const size_t count = static_cast<size_t>(OfTier(20, 200));
  size_t confirmed = 0;
  for (size_t i = 0; confirmed < count; ++i) {
    const Bed& bed = LinuxCncBed(i);
    RandomStream random(static_cast<uint64_t>(OfTier(5, 6)), i);
    const Mutant mutant = Mutate(bed.files(), bed.other(), bed.controller(), random);
    if (mutant.file.empty() || !bed.Ask(mutant.files).accepted) continue;
    ++confirmed;
    const std::string what = fmt::format("{} [{}] line {} '{}' -> '{}'", bed.variant(), mutant.kind,
                                         mutant.line, mutant.before, mutant.after);
    const Interpreted judge = Interpret(mutant.files.begin()->second);
    ASSERT_EQ(judge.status, 0) << what << judge.canonical;
    ExpectSameMoves(judge.canonical, bed.Run(mutant.files), what);
    EXPECT_EQ(std::regex_replace(judge.canonical, std::regex("NAIVECAM_TOLERANCE\\(-?0\\.0000\\)"), "")
                  .find("NAIVECAM"),
              std::string::npos)
        << what;
    const std::vector<Call> calls = CallsOf(judge.canonical), &planned = originals[i % 2];
    ASSERT_EQ(calls.size(), planned.size()) << what;
    for (size_t k = 0; k < calls.size(); ++k)
      EXPECT_TRUE(Same(calls[k], planned[k])) << what << ": " << calls[k].name << calls[k].arguments;
  }
}

}  // namespace
}  // namespace millpose::campaign
