// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/execution.hpp"
#include "base/named_progress.hpp"

namespace millpose {
namespace {

/// Writes down what it hears.
class Heard final : public Progress {
 public:
  void Begin(std::string_view stage, size_t total) override { Add(fmt::format("begin {} {}", stage, total)); }
  void Advance(size_t count) override { Add(fmt::format("advance {}", count)); }
  void Percent(int percent) override { Add(fmt::format("percent {}", percent)); }
  void End(std::string_view outcome) override { Add(fmt::format("end {}", outcome)); }
  std::vector<std::string> lines;

 private:
  void Add(std::string line) { lines.push_back(std::move(line)); }
};

TEST(NamedProgress, PutsItsNameBeforeTheStageAndHandsOnTheRest) {
  Heard heard;
  NamedProgress inner(heard, "pad"), outer(inner, "1 of 2");
  inner.Begin("passes", 7);
  inner.Advance(3);
  outer.Begin("gaps", 0);
  outer.Percent(40);
  outer.End("2 gaps");
  EXPECT_EQ(heard.lines, (std::vector<std::string>{"begin pad: passes 7", "advance 3",
                                                   "begin pad: 1 of 2: gaps 0", "percent 40", "end 2 gaps"}));
}

TEST(Execution, TakesAllCoresUnlessAskedForSome) {
  EXPECT_EQ(Execution{.threads = 3}.Threads(), 3);
  EXPECT_EQ(Execution{}.Threads(), static_cast<int>(std::thread::hardware_concurrency()));
  EXPECT_EQ(&Execution{}.progress, &Silent());
  EXPECT_FALSE(Execution{}.stop.stop_possible());
}

}  // namespace
}  // namespace millpose
