// SPDX-License-Identifier: GPL-3.0-or-later
// Random mutants of programs: what changes on the machine is never let out, what changes nothing passes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <fstream>

#include "base/parallel.hpp"
#include "tests/base/tier.hpp"
#include "tests/campaign/bed.hpp"
#include "tests/campaign/mutations.hpp"

namespace millpose::campaign {
namespace {

constexpr double kLongest = 2;  // s of CPU: whatever number a program of 100 lines holds
const char* const kEffects[] = {"same", "border", "changed", "refused"};

struct Case {
  Mutant mutant;
  Judgement judgement;
  Answer answer;
  double seconds = 0;

  bool FalseAccept() const { return judgement.effect == Effect::kChanged && answer.accepted; }
  bool FalseRefusal() const { return judgement.effect == Effect::kSame && !answer.accepted; }
  std::string Text(const std::string& variant) const {
    return fmt::format("{} {}:{} [{}] '{}' -> '{}': {} ({}); {}", variant, mutant.file, mutant.line,
                       mutant.kind, mutant.before, mutant.after, kEffects[static_cast<int>(judgement.effect)],
                       judgement.why, answer.accepted ? "ACCEPTED" : "refused: " + answer.why);
  }
};

/// Of this thread.
double SecondsOfThread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Case Try(const Bed& bed, uint64_t seed, size_t index) {
  RandomStream random(seed, index);
  Case result;
  result.mutant = Mutate(bed.files(), bed.other(), bed.controller(), random);
  result.judgement = Judge(bed.trace(), bed.Run(result.mutant.files), bed.machine());
  if (result.judgement.effect == Effect::kSame && !result.mutant.MustPass())
    result.judgement = {Effect::kBorder, "nothing changes, but its place is another"};
  const double start = SecondsOfThread();
  result.answer = bed.Ask(result.mutant.files);
  result.seconds = SecondsOfThread() - start;
  return result;
}

/// Effects by answers of every kind of mutant.
class Table {
 public:
  void Add(const Bed& bed, const Case& result) {
    ++counts_[bed.controller() + " " + result.mutant.kind][static_cast<size_t>(result.judgement.effect)]
             [result.answer.accepted ? 1 : 0];
    ++sums_[static_cast<size_t>(result.judgement.effect)][result.answer.accepted ? 1 : 0];
  }
  size_t Of(Effect effect, bool accepted) const {
    return sums_[static_cast<size_t>(effect)][accepted ? 1 : 0];
  }
  std::string Text() const {
    std::string text = fmt::format("{:<60}", "kind (refused/accepted)");
    for (const char* effect : kEffects) text += fmt::format("{:>14}", effect);
    text += "\n";
    const auto row = [&](const std::string& name, const Counts& counts) {
      text += fmt::format("{:<60}", name);
      for (const auto& pair : counts) text += fmt::format("{:>14}", fmt::format("{}/{}", pair[0], pair[1]));
      text += "\n";
    };
    for (const auto& [kind, counts] : counts_) row(kind, counts);
    row("all", sums_);
    return text;
  }

 private:
  using Counts = std::array<std::array<size_t, 2>, 4>;
  std::map<std::string, Counts> counts_;
  Counts sums_{};
};

/// Runs `count` mutants over all beds. Where MILLPOSE_CAMPAIGN names a file, everything that is worth a look
/// goes there.
void RunCampaign(size_t count, uint64_t seed) {
  Beds();
  std::vector<Case> cases(count);
  ParallelFor(count, 2, {}, [&](size_t i) { cases[i] = Try(*Beds()[i % Beds().size()], seed, i); });
  Table table;
  std::string told;
  size_t accepts = 0, refusals = 0;
  double slowest = 0;
  for (size_t i = 0; i < count; ++i) {
    const Bed& bed = *Beds()[i % Beds().size()];
    table.Add(bed, cases[i]);
    accepts += cases[i].FalseAccept();
    refusals += cases[i].FalseRefusal();
    slowest = std::max(slowest, cases[i].seconds);
    const bool lax = cases[i].judgement.effect == Effect::kRefused && cases[i].answer.accepted;
    if (cases[i].seconds > kLongest)
      told += fmt::format("{:.1f} s: {}\n", cases[i].seconds, cases[i].Text(bed.variant()));
    if (cases[i].FalseAccept() || cases[i].FalseRefusal() || lax) told += cases[i].Text(bed.variant()) + "\n";
  }
  if (const char* file = std::getenv("MILLPOSE_CAMPAIGN"))
    std::ofstream(file) << table.Text() << "\n" << told;
  EXPECT_EQ(accepts, 0u) << told;
  EXPECT_LT(slowest, kLongest) << told;
  const size_t harmless = table.Of(Effect::kSame, true) + table.Of(Effect::kSame, false);
  EXPECT_GT(harmless, count / 20);
  EXPECT_GT(table.Of(Effect::kChanged, false), count / 5);
  // Of a few hundred mutants one or two more are chance.
  EXPECT_LT(static_cast<double>(refusals), 2 + 0.005 * static_cast<double>(harmless)) << told;
}

TEST(Campaign, TheProgramsThemselvesRunAndAreConfirmed) {
  for (const auto& bed : Beds()) {
    EXPECT_EQ(bed->trace().refused, "") << bed->variant();
    EXPECT_TRUE(bed->Ask(bed->files()).accepted) << bed->variant() << bed->Ask(bed->files()).why;
    size_t lines = 0;
    for (const auto& [name, text] : bed->files())
      if (!name.ends_with(".dat")) lines += static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
    const bool positions = bed->controller() == "fanuc";  // of six lines each
    EXPECT_LE(lines, positions ? 500u : bed->variant().ends_with("_plant") ? 160u : 100u) << bed->variant();
  }
}

/// MILLPOSE_MUTANTS: another number of them.
TEST(Campaign, NoMutantThatMattersIsConfirmed) {
  const char* count = std::getenv("MILLPOSE_MUTANTS");
  RunCampaign(count ? std::stoul(count) : OfTier(2000, 100000), OfTier(1, 2));
}

}  // namespace
}  // namespace millpose::campaign
