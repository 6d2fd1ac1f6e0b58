// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <numeric>

#include "pose/line_search.hpp"
#include "pose/search.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The share of the evaluations that generations may spend; the local refinement has the rest.
constexpr double kGenerationShare = 0.6;
// Refined places lie at least this share of a freedom's range apart.
constexpr double kNicheSize = 1.0 / 60.0;

/// The genome is the freedoms and the arm branch (shoulder and elbow). Of the two wrist flips it stands for
/// the one that is admissible, or nearer to it, and of two admissible ones for the better.
struct Individual {
  FreedomValues freedoms;
  int arm_branch = 0;
  int branch = 0;
  Admissibility admissibility = Admissibility::kUnreachable;
  double objective = kInfinity;  ///< +inf unless admissible
  double shortfall = kInfinity;
};

/// Admissible before not admissible; then by objective, or by how little is missing.
bool Fitter(const Individual& a, const Individual& b) {
  if (a.objective != b.objective) return a.objective < b.objective;
  return a.shortfall < b.shortfall;
}

/// What is looked at: `freedoms` on one arm branch. Fills in blocks and counts one evaluation for each.
class Evaluator {
 public:
  Evaluator(const PointScorer& scorer, PointOptimum& best)
      : scorer_(scorer),
        dimensions_(scorer.problem().freedoms.size()),
        best_(best),
        lanes_(kLanes * dimensions_) {}

  int evaluations() const { return best_.evaluations; }

  /// Calls `take(k, block, lane)` for each of `count` requests; `freedoms(k)` and `arm_branch(k)` say what is
  /// asked.
  template <typename Freedoms, typename ArmBranch, typename Take>
  void Run(size_t count, const Freedoms& freedoms, const ArmBranch& arm_branch, const Take& take) {
    for (size_t first = 0; first < count; first += kLanes) {
      const size_t used = std::min<size_t>(kLanes, count - first);
      unsigned arms = 0;
      for (size_t l = 0; l < kLanes; ++l) {
        const size_t k = first + std::min(l, used - 1);
        const FreedomValues& values = freedoms(k);
        std::copy(values.begin(), values.end(), lanes_.begin() + l * dimensions_);
        arms |= 1u << arm_branch(k);
      }
      scorer_.ScoreBlock(lanes_, arms, block_);
      best_.evaluations += static_cast<int>(used);
      for (size_t l = 0; l < used; ++l) {
        const int arm = arm_branch(first + l);
        for (const int branch : {arm, arm + 4}) Consider(branch, static_cast<int>(l), freedoms(first + l));
        take(first + l, block_, static_cast<int>(l));
      }
    }
  }

 private:
  void Consider(int branch, int lane, const FreedomValues& freedoms) {
    const Admissibility admissibility = block_.admissibility[branch][lane];
    if (admissibility != Admissibility::kAdmissible) {
      if (!best_.found && admissibility > best_.reason) best_.reason = admissibility;
      return;
    }
    const double value = block_.objective[branch].v[lane];
    if (best_.found && value >= best_.objective) return;
    best_.found = true;
    best_.reason = Admissibility::kAdmissible;
    best_.freedoms = freedoms;
    best_.branch = branch;
    best_.objective = value;
    best_.q = CandidateOf(block_, branch, lane).q;
  }

  const PointScorer& scorer_;
  size_t dimensions_;
  PointOptimum& best_;
  std::vector<double> lanes_;
  ScoredBlock block_;
};

/// Brings a periodic freedom back into its range and stops the others at theirs.
double Confine(const Freedom& freedom, double value) {
  const double range = freedom.Upper() - freedom.Lower();
  if (!freedom.Periodic()) return std::clamp(value, freedom.Lower(), freedom.Upper());
  return value - range * std::floor((value - freedom.Lower()) / range);
}

/// b − a, the short way round where the freedom is periodic.
double Difference(const Freedom& freedom, double a, double b) {
  const double range = freedom.Upper() - freedom.Lower();
  return freedom.Periodic() ? (b - a) - range * std::round((b - a) / range) : b - a;
}

class Population {
 public:
  Population(const PoseProblem& problem, const GeneticOptions& options, RandomStream& random,
             Evaluator& evaluator)
      : problem_(problem), options_(options), random_(random), evaluator_(evaluator) {}

  /// Runs all generations; every individual ever evaluated stays in `archive`.
  void Evolve(std::vector<Individual>& archive, std::vector<GenerationRecord>* history) {
    const int budget = static_cast<int>(kGenerationShare * options_.max_evaluations);
    for (int k = 0; k < std::min(options_.population, budget); ++k) current_.push_back(RandomIndividual());
    std::vector<size_t> fresh(current_.size());
    std::iota(fresh.begin(), fresh.end(), size_t{0});
    for (int generation = 0;; ++generation) {
      Evaluate(fresh, archive);
      std::stable_sort(current_.begin(), current_.end(), Fitter);
      if (history) history->push_back(Record());
      const int children = std::max(0, static_cast<int>(current_.size()) - options_.elite);
      if (generation + 1 >= options_.generations || evaluator_.evaluations() + children > budget) return;
      Breed(1.0 - static_cast<double>(generation) / options_.generations, fresh);
    }
  }

 private:
  Individual RandomIndividual() {
    Individual individual;
    for (const auto& freedom : problem_.freedoms) {
      individual.freedoms.push_back(random_.Uniform(freedom->Lower(), freedom->Upper()));
    }
    individual.arm_branch = random_.Below(4);
    return individual;
  }

  void Evaluate(const std::vector<size_t>& fresh, std::vector<Individual>& archive) {
    evaluator_.Run(
        fresh.size(), [&](size_t k) -> const FreedomValues& { return current_[fresh[k]].freedoms; },
        [&](size_t k) { return current_[fresh[k]].arm_branch; },
        [&](size_t k, const ScoredBlock& block, int lane) {
          Individual& individual = current_[fresh[k]];
          individual.objective = individual.shortfall = kInfinity;
          individual.admissibility = Admissibility::kUnreachable;  // not the parent's
          for (const int branch : {individual.arm_branch, individual.arm_branch + 4}) {
            const Admissibility admissibility = block.admissibility[branch][lane];
            const double shortfall = block.shortfall[branch].v[lane];
            const double objective =
                admissibility == Admissibility::kAdmissible ? block.objective[branch].v[lane] : kInfinity;
            if (shortfall > individual.shortfall ||
                (shortfall == individual.shortfall && objective >= individual.objective))
              continue;
            individual.branch = branch;
            individual.admissibility = admissibility;
            individual.shortfall = shortfall;
            individual.objective = objective;
          }
          archive.push_back(individual);
        });
  }

  GenerationRecord Record() const {
    GenerationRecord record{0, 0};
    int count = 0;
    for (const Individual& individual : current_) {
      if (individual.admissibility != Admissibility::kAdmissible) continue;
      if (count++ == 0) record.best = individual.objective;
      record.mean += individual.objective;
    }
    if (count > 0) record.mean /= count;
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
    if (random_.Uniform() < options_.mutation_rate) child.arm_branch = random_.Below(4);
  }

  const PoseProblem& problem_;
  const GeneticOptions& options_;
  RandomStream& random_;
  Evaluator& evaluator_;
  std::vector<Individual> current_;
};

/// One local refinement: line searches along one freedom after the other on one branch.
class Climber {
 public:
  Climber(const PoseProblem& problem, const Individual& start, double step, double tolerance,
          double end_tolerance)
      : problem_(&problem),
        step_(step),
        tolerance_(tolerance),
        end_tolerance_(end_tolerance),
        place_(start.freedoms),
        branch_(start.branch),
        value_(start.objective),
        line_(Begin()) {}

  bool done() const { return done_; }
  int branch() const { return branch_; }
  const FreedomValues& freedoms() const { return place_; }
  double value() const { return value_; }
  const FreedomValues& Ask() {
    asked_ = place_;
    const Freedom& freedom = *problem_->freedoms[dimension_];
    inside_ = freedom.Periodic() || (line_.Ask() >= freedom.Lower() && line_.Ask() <= freedom.Upper());
    asked_[dimension_] = Confine(freedom, line_.Ask());
    return asked_;
  }

  void Tell(double value) {
    line_.Tell(inside_ ? value : kInfinity);
    if (!line_.done()) return;
    const Freedom& freedom = *problem_->freedoms[dimension_];
    place_[dimension_] = Confine(freedom, line_.best());
    value_ = line_.best_value();
    // With one freedom one line is all. With more, go round until a round brings nothing.
    if (++dimension_ == place_.size()) {
      dimension_ = 0;
      done_ = place_.size() == 1 || round_start_ - value_ <= 1e-7 * value_;
      round_start_ = value_;
    }
    if (!done_) line_ = Begin();
  }

 private:
  LineSearch Begin() const {
    const Freedom& freedom = *problem_->freedoms[dimension_];
    const double range = freedom.Upper() - freedom.Lower();
    return LineSearch(place_[dimension_], value_, step_ * range, 0.5 * range, tolerance_ * range,
                      end_tolerance_ * range);
  }

  const PoseProblem* problem_;
  double step_, tolerance_, end_tolerance_;  // shares of a freedom's range
  FreedomValues place_, asked_;
  int branch_;
  double value_;
  double round_start_ = kInfinity;
  size_t dimension_ = 0;
  bool inside_ = true, done_ = false;
  LineSearch line_;
};

/// Lets all climbers finish side by side, or until the evaluations are spent.
void Climb(std::vector<Climber>& climbers, Evaluator& evaluator, int max_evaluations) {
  std::vector<Climber*> running;
  while (true) {
    running.clear();
    for (Climber& climber : climbers) {
      if (!climber.done()) running.push_back(&climber);
    }
    const int left = max_evaluations - evaluator.evaluations();
    if (running.empty() || left <= 0) return;
    if (running.size() > static_cast<size_t>(left)) running.resize(left);
    evaluator.Run(
        running.size(), [&](size_t k) -> const FreedomValues& { return running[k]->Ask(); },
        [&](size_t k) { return running[k]->branch() & 3; },
        [&](size_t k, const ScoredBlock& block, int lane) {
          const int branch = running[k]->branch();
          const bool admissible = block.admissibility[branch][lane] == Admissibility::kAdmissible;
          running[k]->Tell(admissible ? block.objective[branch].v[lane] : kInfinity);
        });
  }
}

/// The best of the archive, each at least a niche away from the ones before on its branch.
std::vector<Individual> Niches(const PoseProblem& problem, std::vector<Individual> archive, size_t count) {
  std::stable_sort(archive.begin(), archive.end(), Fitter);
  std::vector<Individual> niches;
  for (const Individual& individual : archive) {
    if (niches.size() == count || individual.admissibility != Admissibility::kAdmissible) break;
    const auto near = [&](const Individual& other) {
      if (other.branch != individual.branch) return false;
      for (size_t d = 0; d < individual.freedoms.size(); ++d) {
        const Freedom& freedom = *problem.freedoms[d];
        const double apart = Difference(freedom, individual.freedoms[d], other.freedoms[d]);
        if (std::abs(apart) > kNicheSize * (freedom.Upper() - freedom.Lower())) return false;
      }
      return true;
    };
    if (std::none_of(niches.begin(), niches.end(), near)) niches.push_back(individual);
  }
  return niches;
}

}  // namespace

PointOptimum GeneticSearch(const PointScorer& scorer, const PoseProblem& problem,
                           const GeneticOptions& options, RandomStream stream,
                           std::vector<GenerationRecord>* history) {
  constexpr size_t kNiches = 16;
  constexpr int kPolishReserve = 100;
  PointOptimum best;
  Evaluator evaluator(scorer, best);
  std::vector<Individual> archive;
  Population(problem, options, stream, evaluator).Evolve(archive, history);

  // First roughly from several places, so that the right one wins; then exactly from the winner.
  std::vector<Climber> climbers;
  for (const Individual& niche : Niches(problem, std::move(archive), kNiches)) {
    climbers.emplace_back(problem, niche, 1.0 / 720, 1.0 / 3600, 1.0 / 7200);
  }
  Climb(climbers, evaluator, options.max_evaluations - kPolishReserve);
  if (!best.found) return best;
  Individual winner;
  winner.freedoms = best.freedoms;
  winner.branch = best.branch;
  winner.objective = best.objective;
  std::vector<Climber> last;
  last.emplace_back(problem, winner, 1.0 / 7200, 1e-8, 1e-13);
  Climb(last, evaluator, options.max_evaluations);
  return best;
}

}  // namespace millpose
