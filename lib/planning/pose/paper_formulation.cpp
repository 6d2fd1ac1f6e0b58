// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/paper_formulation.hpp"

#include <limits>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

struct Individual {
  Joints psi;
  PaperResult result;
};

Vector3d OriginInFlange(const PoseProblem& problem) {
  return problem.origin == StiffnessOrigin::kToolTip ? Vector3d(problem.X_FT.translation())
                                                     : Vector3d::Zero();
}

PaperResult Judge(const PoseProblem& problem, const PaperTarget& target,
                  const PaperFormulationOptions& options, const Joints& psi) {
  PaperResult result;
  for (int i = 0; i < 6; ++i)
    result.q[i] = FromUnbounded(psi[i], problem.bounds.lower[i], problem.bounds.upper[i]);
  const Pose X_BT = ForwardFlange(problem.arm, result.q) * problem.X_FT;
  const Vector3d axis = X_BT.linear().col(2);
  result.position_error = (X_BT.translation() - target.tip).norm();
  result.angle_error = Atan2(axis.cross(target.axis).norm(), axis.dot(target.axis));
  result.within_tolerance =
      result.position_error <= options.position_tolerance && result.angle_error <= options.angle_tolerance;
  const Vector3d p_FO = OriginInFlange(problem);
  Matrix6 C = Compliance(Jacobian(problem.arm, result.q, p_FO), problem.arm.stiffness);
  if (!problem.compliances.empty()) C += SeriesComplianceAt(problem.arm, result.q, p_FO, problem.compliances);
  const auto indices = IndicesInPlane(C.topLeftCorner<3, 3>(), target.normal);
  result.objective = indices ? options.w1 * indices->lambda_t2 + options.w2 * indices->lambda_n
                             : std::numeric_limits<double>::infinity();
  const double position = result.position_error / options.position_tolerance;
  const double angle = result.angle_error / options.angle_tolerance;
  const double error = result.within_tolerance ? 0.0 : position * position + angle * angle;  // eq. 32
  result.fitness = std::max(0.0, options.c_max - result.objective) - options.penalty * error;
  return result;
}

class PaperPopulation {
 public:
  PaperPopulation(const PoseProblem& problem, const PaperTarget& target,
                  const PaperFormulationOptions& options, RandomStream stream)
      : problem_(problem),
        lower_(problem.bounds.lower),
        upper_(problem.bounds.upper),
        target_(target),
        options_(options),
        stream_(stream) {
    for (int i = 0; i < options.population; ++i) {
      Joints psi;
      for (int k = 0; k < 6; ++k)
        psi[k] = ToUnbounded(stream_.Uniform(lower_[k], upper_[k]), lower_[k], upper_[k]);
      all_.push_back(Made(psi));
    }
    Sort();
  }

  void Advance(double spread) {
    std::vector<Individual> next(all_.begin(), all_.begin() + options_.elite);
    while (next.size() < all_.size()) {
      const Joints& mother = Parent();
      if (stream_.Uniform() < options_.crossover_rate) {
        const Joints& father = Parent();
        Joints child;
        for (int k = 0; k < 6; ++k) child[k] = stream_.Below(2) == 0 ? mother[k] : father[k];
        next.push_back(Made(child));
      } else {
        next.push_back(Made(Mutated(mother, spread)));
      }
    }
    all_ = std::move(next);
    Sort();
  }

  PaperResult best() const {
    PaperResult result = all_.front().result;
    result.evaluations = evaluations_;
    return result;
  }

 private:
  Individual Made(const Joints& psi) {
    ++evaluations_;
    return {psi, Judge(problem_, target_, options_, psi)};
  }

  /// By rank: the square of a uniform number prefers the front.
  const Joints& Parent() {
    const double u = stream_.Uniform();
    return all_[static_cast<size_t>(u * u * static_cast<double>(all_.size()))].psi;
  }

  /// Moves the joint angles themselves by a normal step, then maps back.
  Joints Mutated(const Joints& psi, double spread) {
    Joints mutated;
    for (int k = 0; k < 6; ++k) {
      const double lower = lower_[k], upper = upper_[k];
      const double theta = FromUnbounded(psi[k], lower, upper) + spread * (upper - lower) * stream_.Normal();
      const double inside = 1e-9 * (upper - lower);
      mutated[k] = ToUnbounded(std::clamp(theta, lower + inside, upper - inside), lower, upper);
    }
    return mutated;
  }

  void Sort() {
    std::stable_sort(all_.begin(), all_.end(), [](const Individual& a, const Individual& b) {
      return a.result.fitness > b.result.fitness;
    });
  }

  const PoseProblem& problem_;
  Joints lower_, upper_;
  const PaperTarget& target_;
  const PaperFormulationOptions& options_;
  RandomStream stream_;
  int evaluations_ = 0;
  std::vector<Individual> all_;
};

}  // namespace

double FromUnbounded(double psi, double lower, double upper) {
  return 0.5 * (lower + upper) + (upper - lower) / kPi * Atan2(psi, 1);
}

double ToUnbounded(double theta, double lower, double upper) {
  const auto [sine, cosine] = SinCos((theta - 0.5 * (lower + upper)) * kPi / (upper - lower));
  return sine / cosine;
}

PaperTarget MakePaperTarget(const PoseProblem& problem, const MillingPoint& point) {
  const Pose X_BW = problem.X_WB.inverse();
  return {X_BW * point.position, X_BW.linear() * point.tool_axis, X_BW.linear() * point.normal};
}

PaperResult PaperSearch(const PoseProblem& problem, const PaperTarget& target,
                        const PaperFormulationOptions& options, RandomStream stream) {
  PaperPopulation population(problem, target, options, stream);
  double spread = 0.2;  // of each joint's range; shrinks to some 1e-6 of it
  const double shrink = Pow(5e-6, 1.0 / options.generations);
  for (int generation = 1; generation < options.generations; ++generation, spread *= shrink)
    population.Advance(spread);
  return population.best();
}

PointOptimum OnExactPose(const PointScorer& scorer, const PaperResult& result) {
  const PoseProblem& problem = scorer.problem();
  assert(problem.freedoms.size() == 1 && problem.freedoms[0]->IsToolRotation());
  PointOptimum optimum;
  optimum.evaluations = result.evaluations;
  if (!result.within_tolerance) return optimum;
  const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, result.q) * problem.X_FT;
  const Vector3d x = scorer.ToolPose({0.0}).linear().transpose() * X_WT.linear().col(0);
  optimum.freedoms = {Atan2(x.y(), x.x())};
  std::array<Candidate, 8> candidates;
  scorer.Score({&optimum.freedoms, 1}, candidates);
  double least = std::numeric_limits<double>::infinity();
  for (int branch = 0; branch < 8; ++branch) {
    const Candidate& candidate = candidates[branch];
    if (candidate.obstacle == Infeasibility::kUnreachable) continue;
    double away = 0;  // modulo full revolutions
    for (int i = 0; i < 6; ++i) {
      const auto [sine, cosine] = SinCos(candidate.q[i] - result.q[i]);
      away += std::abs(Atan2(sine, cosine));
    }
    if (away >= least) continue;
    least = away;
    optimum.branch = branch;
    optimum.reason = candidate.obstacle;
    optimum.found = candidate.obstacle == Infeasibility::kNone;
    optimum.objective = candidate.objective;
    optimum.q = candidate.q;
  }
  return optimum;
}

}  // namespace millpose
