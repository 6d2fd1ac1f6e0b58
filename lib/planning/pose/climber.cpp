// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/climber.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

// Refined places lie at least this share of a freedom's range apart.
constexpr double kNicheSize = 1.0 / 60.0;

}  // namespace

const FreedomValues& Climber::Ask() {
  asked_ = place_;
  const Freedom& freedom = *problem_->freedoms[dimension_];
  inside_ = freedom.Periodic() || (line_.Ask() >= freedom.Lower() && line_.Ask() <= freedom.Upper());
  asked_[dimension_] = Confine(freedom, line_.Ask());
  return asked_;
}

void Climber::Tell(double value) {
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

LineSearch Climber::Begin() const {
  const Freedom& freedom = *problem_->freedoms[dimension_];
  const double range = freedom.Upper() - freedom.Lower();
  return LineSearch(place_[dimension_], value_, step_ * range, 0.5 * range, tolerance_ * range,
                    end_tolerance_ * range);
}

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
          const bool admissible = block.obstacle[branch][lane] == Infeasibility::kNone;
          running[k]->Tell(admissible ? block.objective[branch].v[lane] : kInfinity);
        });
  }
}

std::vector<Individual> Niches(const PoseProblem& problem, std::vector<Individual> archive, size_t count) {
  std::stable_sort(archive.begin(), archive.end(), Fitter);
  std::vector<Individual> niches;
  for (const Individual& individual : archive) {
    if (niches.size() == count || individual.obstacle != Infeasibility::kNone) break;
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

}  // namespace millpose
