// SPDX-License-Identifier: GPL-3.0-or-later
#include <numeric>

#include "base/units.hpp"
#include "planning/pose/climber.hpp"
#include "planning/pose/generations.hpp"

namespace millpose {
namespace {

// The share of the evaluations that generations may spend, with one freedom and with several, whose
// refinement costs more; the local refinement has the rest.
constexpr double kGenerationShare = 0.6, kSeveralShare = 0.35;
constexpr int kArmBranches = 4;  // of a setting; one evaluation each

class Population {
 public:
  Population(const PoseProblem& problem, const GeneticOptions& options, RandomStream& random,
             Evaluator& evaluator)
      : problem_(problem),
        options_(options),
        random_(random),
        evaluator_(evaluator),
        size_(options.population * static_cast<int>(problem.freedoms.size())),
        generations_(options.generations * static_cast<int>(problem.freedoms.size())) {}

  /// Starts with the best places of a coarse table, which may take half of what the generations may spend;
  /// where not even the smallest does, with none.
  void Seed(const PointScorer& scorer, std::vector<Individual>& archive) {
    const int most = std::min(options_.table, Budget() / (2 * kArmBranches));
    if (most < 1 << problem_.freedoms.size()) return;
    const CandidateTable table = CandidateTable::OfSize(scorer, most);
    evaluator_.Count(kArmBranches * static_cast<int>(table.settings()));
    for (const CandidateTable::Entry& entry : table.entries()) {
      Individual individual;
      individual.freedoms = table.Setting(entry.setting);
      individual.branch = entry.branch;
      individual.arm_branch = entry.branch & 3;
      individual.obstacle = Infeasibility::kNone;
      individual.objective = entry.objective;
      individual.shortfall = 0;
      archive.push_back(std::move(individual));
    }
    current_ = Niches(problem_, archive, static_cast<size_t>(size_ / 2));
  }

  /// Runs all generations; every individual ever evaluated stays in `archive`.
  void Evolve(std::vector<Individual>& archive, std::vector<GenerationRecord>* history) {
    const int budget = Budget();
    const int first = std::min(size_, budget - evaluator_.evaluations());
    while (static_cast<int>(current_.size()) < first) current_.push_back(RandomIndividual());
    current_.resize(static_cast<size_t>(std::max(0, first)));
    std::vector<size_t> fresh(current_.size());
    std::iota(fresh.begin(), fresh.end(), size_t{0});
    for (int generation = 0;; ++generation) {
      Evaluate(fresh, archive);
      std::stable_sort(current_.begin(), current_.end(), Fitter);
      if (history) history->push_back(Record());
      const int children = std::max(0, static_cast<int>(current_.size()) - options_.elite);
      if (generation + 1 >= generations_ || evaluator_.evaluations() + children > budget) return;
      Breed(1.0 - static_cast<double>(generation) / generations_, fresh);
    }
  }

 private:
  int Budget() const {
    const double share = problem_.freedoms.size() == 1 ? kGenerationShare : kSeveralShare;
    return static_cast<int>(share * options_.max_evaluations);
  }

  Individual RandomIndividual() {
    Individual individual;
    for (const auto& freedom : problem_.freedoms) {
      individual.freedoms.push_back(random_.Uniform(freedom->Lower(), freedom->Upper()));
    }
    individual.arm_branch = random_.Below(kArmBranches);
    return individual;
  }

  void Evaluate(const std::vector<size_t>& fresh, std::vector<Individual>& archive) {
    evaluator_.Run(
        fresh.size(), [&](size_t k) -> const FreedomValues& { return current_[fresh[k]].freedoms; },
        [&](size_t k) { return current_[fresh[k]].arm_branch; },
        [&](size_t k, const ScoredBlock& block, int lane) {
          Individual& individual = current_[fresh[k]];
          individual.objective = individual.shortfall = kInfinity;
          individual.obstacle = Infeasibility::kUnreachable;  // not the parent's
          for (const int branch : {individual.arm_branch, individual.arm_branch + 4}) {
            const Infeasibility obstacle = block.obstacle[branch][lane];
            const double shortfall = block.shortfall[branch].v[lane];
            const double objective =
                obstacle == Infeasibility::kNone ? block.objective[branch].v[lane] : kInfinity;
            if (shortfall > individual.shortfall ||
                (shortfall == individual.shortfall && objective >= individual.objective))
              continue;
            individual.branch = branch;
            individual.obstacle = obstacle;
            individual.shortfall = shortfall;
            individual.objective = objective;
          }
          archive.push_back(individual);
        });
  }

  GenerationRecord Record() const {
    GenerationRecord record;
    for (const Individual& individual : current_) {
      if (individual.obstacle != Infeasibility::kNone) continue;
      if (record.admissible++ == 0) record.best = individual.objective;
      record.mean += individual.objective;
    }
    if (record.admissible > 0) record.mean /= record.admissible;
    return record;
  }

  /// The fitter of two drawn at random.
  const Individual& Select() {
    const Individual& a = current_[random_.Below(static_cast<int>(current_.size()))];
    const Individual& b = current_[random_.Below(static_cast<int>(current_.size()))];
    return Fitter(b, a) ? b : a;
  }

  /// Replaces all but the elite; `fresh` lists the children that differ from their parents. `cooling` falls
  /// from 1 to 0 over the generations.
  void Breed(double cooling, std::vector<size_t>& fresh) {
    std::vector<Individual> next(current_.begin(),
                                 current_.begin() + std::min<size_t>(options_.elite, current_.size()));
    fresh.clear();
    while (next.size() < current_.size()) {
      const Individual& mother = Select();
      const Individual& father = Select();
      Individual child = mother;
      if (random_.Uniform() < options_.crossover_rate) Cross(father, child);
      Mutate(cooling, child);
      if (child.freedoms != mother.freedoms || child.arm_branch != mother.arm_branch) {
        fresh.push_back(next.size());
      }
      next.push_back(std::move(child));
    }
    current_ = std::move(next);
  }

  /// Blend crossover (BLX-0.5, Eshelman and Schaffer 1993): each freedom between the parents or up to half
  /// their distance beyond; the arm branch from either.
  void Cross(const Individual& father, Individual& child) {
    for (size_t d = 0; d < child.freedoms.size(); ++d) {
      const Freedom& freedom = *problem_.freedoms[d];
      const double apart = Difference(freedom, child.freedoms[d], father.freedoms[d]);
      if (apart != 0.0) {
        child.freedoms[d] = Confine(freedom, child.freedoms[d] + random_.Uniform(-0.5, 1.5) * apart);
      }
    }
    if (random_.Uniform() < 0.5) child.arm_branch = father.arm_branch;
  }

  /// Each gene with the mutation rate: half of the changes anywhere, half nearby and ever nearer.
  void Mutate(double cooling, Individual& child) {
    for (size_t d = 0; d < child.freedoms.size(); ++d) {
      if (random_.Uniform() >= options_.mutation_rate) continue;
      const Freedom& freedom = *problem_.freedoms[d];
      const double range = freedom.Upper() - freedom.Lower();
      child.freedoms[d] =
          random_.Uniform() < 0.5
              ? random_.Uniform(freedom.Lower(), freedom.Upper())
              : Confine(freedom, child.freedoms[d] + 0.05 * cooling * range * random_.Normal());
    }
    if (random_.Uniform() < options_.mutation_rate) child.arm_branch = random_.Below(kArmBranches);
  }

  const PoseProblem& problem_;
  const GeneticOptions& options_;
  RandomStream& random_;
  Evaluator& evaluator_;
  int size_, generations_;
  std::vector<Individual> current_;
};

}  // namespace

PointOptimum GeneticSearch(const PointScorer& scorer, const PoseProblem& problem,
                           const GeneticOptions& options, RandomStream stream,
                           std::vector<GenerationRecord>* history) {
  constexpr size_t kNiches = 12;
  const bool several = problem.freedoms.size() > 1;
  const int polish_reserve = several ? options.max_evaluations / 2 : 100;
  PointOptimum best;
  Evaluator evaluator(scorer, best);
  std::vector<Individual> archive;
  Population population(problem, options, stream, evaluator);
  population.Seed(scorer, archive);
  population.Evolve(archive, history);

  // First roughly from several places, so that the right one wins; then exactly from the winner.
  std::vector<Climber> climbers;
  for (const Individual& niche : Niches(problem, std::move(archive), kNiches)) {
    climbers.emplace_back(problem, niche, 1.0 / 720, 1.0 / 3600, 1.0 / 7200);
  }
  Climb(climbers, evaluator, options.max_evaluations - polish_reserve);
  if (!best.found) return best;
  if (several) return Descend(scorer, best, options.max_evaluations);
  Individual winner;
  winner.freedoms = best.freedoms;
  winner.branch = best.branch;
  winner.objective = best.objective;
  std::vector<Climber> last;
  last.emplace_back(problem, winner, 1.0 / 7200, 1e-8, 1e-13);
  Climb(last, evaluator, options.max_evaluations);
  return best;
}

std::vector<GenerationRecord> Generations(const PointScorer& scorer, const PoseProblem& problem,
                                          const GeneticOptions& options, RandomStream stream) {
  PointOptimum best;
  Evaluator evaluator(scorer, best);
  std::vector<Individual> archive;
  std::vector<GenerationRecord> records;
  Population population(problem, options, stream, evaluator);
  population.Seed(scorer, archive);
  population.Evolve(archive, &records);
  return records;
}

}  // namespace millpose
