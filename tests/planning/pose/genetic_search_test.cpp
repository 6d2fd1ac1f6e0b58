// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/generations.hpp"
#include "tests/planning/pose/admissible_reference.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

struct Sample {
  MillingPoint point;
  double optimum;  ///< by the exhaustive search
};

/// Points of the panel in front of the arm with their exhaustive optima.
std::vector<Sample> MakeSamples(const PoseProblem& problem, int count) {
  RandomStream stream(5, 0);
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) {
    Sample sample;
    const std::array<double, 4> at{stream.Uniform(-450, 450), stream.Uniform(-300, 300),
                                   stream.Uniform(1500, 2200), stream.Uniform(700, 1500)};
    sample.point = PanelPoint(at[0], at[1], at[2], at[3]);
    const PointScorer scorer(problem, sample.point, Eigen::Vector3d::UnitZ());
    const PointOptimum best = ExhaustiveSearch(scorer, DegToRad(0.25));
    if (!best.found) continue;
    sample.optimum = best.objective;
    samples.push_back(sample);
  }
  return samples;
}

constexpr uint64_t kSeeds = 4;

struct LinkMoves {
  double share;  ///< of points within 0.1 % of the optimum
  double worst;  ///< relative
  int most_evaluations;
};
LinkMoves Measure(const PoseProblem& problem, const std::vector<Sample>& samples,
                  const GeneticOptions& options) {
  LinkMoves gaps{0, 0, 0};
  for (uint64_t seed = 1; seed <= kSeeds; ++seed)
    for (size_t k = 0; k < samples.size(); ++k) {
      const PointScorer scorer(problem, samples[k].point, Eigen::Vector3d::UnitZ());
      const PointOptimum best = GeneticSearch(scorer, problem, options, RandomStream(seed, k));
      const double gap = best.found ? best.objective / samples[k].optimum - 1 : 1e9;
      gaps.share += gap <= 1e-3;
      gaps.worst = std::max(gaps.worst, gap);
      gaps.most_evaluations = std::max(gaps.most_evaluations, best.evaluations);
    }
  gaps.share /= static_cast<double>(kSeeds * samples.size());
  return gaps;
}

TEST(GeneticSearch, ComesWithinATenthOfAPercentOfTheExhaustiveSearch) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const std::vector<Sample> samples = MakeSamples(problem, 300);
  ASSERT_GT(samples.size(), 250u);
  const LinkMoves full = Measure(problem, samples, {});
  EXPECT_GE(full.share, 0.995);
  EXPECT_LE(full.most_evaluations, 2000);

  // Mutation earns its keep: without a table and with fewer evaluations (so that neither makes up for it) the
  // share falls when it is switched off. Crossover does not with one freedom: 98.6 % with it, 99.2 % without.
  GeneticOptions frugal, no_mutation;
  frugal.table = 0;
  frugal.population = 40;
  frugal.generations = 30;
  frugal.max_evaluations = 500;
  no_mutation = frugal;
  no_mutation.mutation_rate = 0;
  const double both = Measure(problem, samples, frugal).share;
  EXPECT_GE(both, 0.98);
  EXPECT_LT(Measure(problem, samples, no_mutation).share, both);
}

TEST(GeneticSearch, DependsOnItsStreamAlone) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(30, 20), Eigen::Vector3d::UnitZ());
  std::vector<GenerationRecord> first, again, other;
  const PointOptimum a = GeneticSearch(scorer, problem, {}, RandomStream(1, 7), &first);
  const PointOptimum b = GeneticSearch(scorer, problem, {}, RandomStream(1, 7), &again);
  GeneticSearch(scorer, problem, {}, RandomStream(1, 8), &other);
  EXPECT_EQ(a.objective, b.objective);
  EXPECT_EQ(a.q, b.q);
  const std::vector<GenerationRecord> alone = Generations(scorer, problem, {}, RandomStream(1, 7));
  ASSERT_EQ(first.size(), again.size());
  ASSERT_EQ(first.size(), alone.size());
  ASSERT_GT(first.size(), 5u);
  for (size_t g = 0; g < first.size(); ++g) {
    EXPECT_EQ(first[g].best, alone[g].best);
    EXPECT_EQ(first[g].mean, alone[g].mean);
    EXPECT_EQ(first[g].admissible, alone[g].admissible);
    EXPECT_EQ(first[g].best, again[g].best);
    EXPECT_EQ(first[g].mean, again[g].mean);
    EXPECT_LE(first[g].best, first[g].mean);
    EXPECT_LE(first[g].best, first[g > 0 ? g - 1 : 0].best);  // elitism
  }
  EXPECT_NE(first[0].mean, other[0].mean);
  EXPECT_EQ(a.objective, scorer.ScoreOne(a.freedoms, a.branch).objective);
  EXPECT_EQ(ReferenceInfeasibility(problem, a.q), Infeasibility::kNone);
}

TEST(GeneticSearch, RecordsOnlyAdmissibleIndividuals) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  for (uint64_t k = 0; k < 20; ++k) {
    const PointScorer scorer(problem, PanelPoint(-400 + 40.0 * static_cast<double>(k), 450),
                             Eigen::Vector3d::UnitZ());
    std::vector<GenerationRecord> history;
    GeneticSearch(scorer, problem, {}, RandomStream(7, k), &history);
    for (const GenerationRecord& record : history) EXPECT_TRUE(std::isfinite(record.mean)) << k;
  }
}

TEST(GeneticSearch, SpendsNoMoreThanItMay) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(30, 20), Eigen::Vector3d::UnitZ());
  for (const int most : {10, 20, 50, 200, 390, 500, 2000}) {
    GeneticOptions options;
    options.max_evaluations = most;
    const PointOptimum best = GeneticSearch(scorer, problem, options, RandomStream(1, 7));
    EXPECT_LE(best.evaluations, most);
    EXPECT_GT(best.evaluations, most / 4);
  }
}

TEST(GeneticSearch, SaysWhyNothingWasFound) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(0, 0, 6000), Eigen::Vector3d::UnitZ());
  const PointOptimum best = GeneticSearch(scorer, problem, {}, RandomStream(1, 0));
  EXPECT_FALSE(best.found);
  EXPECT_EQ(best.reason, Infeasibility::kUnreachable);
  EXPECT_LE(best.evaluations, 2000);
}

}  // namespace
}  // namespace millpose
