// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/scorer.hpp"

#include <limits>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;

/// `angle` moved by full turns into [lower, upper], by as few as possible; what is missing when none fits.
struct Turned {
  double angle, shortfall;
};
Turned TurnInto(double angle, double lower, double upper) {
  if (angle >= lower && angle <= upper) return {angle, 0.0};
  const double turns = std::ceil((lower - angle) / kTurn);
  const double least = angle + turns * kTurn;  // the smallest that is not below
  if (least >= lower && least <= upper) return {least, 0.0};
  return {angle, std::max(0.0, std::min(least - upper, lower - (least - kTurn)))};
}

/// What `q` misses of the bounds on singularity and dexterity; 0 when nothing.
double SingularShortfall(const PoseProblem& problem, const Joints& q) {
  const AdmissibleBounds& bounds = problem.bounds;
  const SingularityDistance distance = DistanceToSingularity(problem.arm, q);
  double missing = std::max(0.0, bounds.wrist_min - distance.wrist) +
                   std::max(0.0, bounds.elbow_min - distance.elbow) +
                   1e-3 * std::max(0.0, bounds.shoulder_min_mm - distance.shoulder);
  if (bounds.dexterity_min > 0.0) {
    const Matrix6 J = Jacobian(problem.arm, q, problem.X_FT.translation());
    missing += std::max(0.0, bounds.dexterity_min - Dexterity(J, problem.characteristic_length));
  }
  return missing;
}

/// Puts the angles within the bounds where full turns can, and judges them.
Candidate Judge(const PoseProblem& problem, const Joints& principal) {
  Candidate candidate;
  for (int i = 0; i < 6; ++i) {
    const Turned turned = TurnInto(principal[i], problem.bounds.lower[i], problem.bounds.upper[i]);
    candidate.q[i] = turned.angle;
    candidate.shortfall += turned.shortfall;
  }
  if (candidate.shortfall > 0.0) {
    candidate.admissibility = Admissibility::kLimit;
    return candidate;
  }
  candidate.shortfall = SingularShortfall(problem, principal);
  candidate.admissibility = candidate.shortfall > 0.0 ? Admissibility::kSingular : Admissibility::kAdmissible;
  return candidate;
}

}  // namespace

PointScorer::PointScorer(const PoseProblem& problem, const MillingPoint& point,
                         const Eigen::Vector3d& rotation_reference)
    : problem_(&problem),
      X_WT_nominal_(NominalToolPose(point, rotation_reference)),
      X_BW_(problem.X_WB.inverse()),
      X_TF_(problem.X_FT.inverse()),
      p_FO_(problem.origin == StiffnessOrigin::kToolTip ? Eigen::Vector3d(problem.X_FT.translation())
                                                        : Eigen::Vector3d::Zero()) {
  context_.normal = X_BW_.linear() * point.normal;
  context_.feed = X_BW_.linear() * point.feed;
  context_.tool_axis = X_BW_.linear() * point.tool_axis;
}

Pose PointScorer::ToolPose(const double* freedoms) const {
  Pose X_WT = X_WT_nominal_;
  for (const auto& freedom : problem_->freedoms) X_WT = freedom->Apply(X_WT, *freedoms++);
  return X_WT;
}

void PointScorer::ScoreBlock(std::span<const double> values, unsigned arm_branches, ScoredBlock& out) const {
  const size_t dimensions = problem_->freedoms.size();
  for (auto& branch : out.admissibility) branch.fill(Admissibility::kUnreachable);
  for (Lanes& branch : out.shortfall) std::fill_n(branch.v, kLanes, std::numeric_limits<double>::infinity());
  ComplianceBlock compliance[4] = {};
  for (int l = 0; l < kLanes; ++l) {
    const Pose X_BF = X_BW_ * ToolPose(values.data() + l * dimensions) * X_TF_;
    const InverseResult inverse = Inverse(problem_->arm, X_BF);
    for (int s = 0; s < inverse.count; ++s) {
      const ArmSolution& solution = inverse.solutions[s];
      const int arm = solution.branch & 3;
      if (!(arm_branches >> arm & 1u)) continue;
      const Candidate candidate = Judge(*problem_, solution.q);
      out.admissibility[solution.branch][l] = candidate.admissibility;
      out.shortfall[solution.branch].v[l] = candidate.shortfall;
      for (int i = 0; i < 6; ++i) out.q[solution.branch][i].v[l] = candidate.q[i];
      const Matrix6 C = Compliance(Jacobian(problem_->arm, solution.q, p_FO_), problem_->arm.stiffness);
      ComplianceBlock& c = compliance[arm];
      c.xx.v[l] = C(0, 0), c.yy.v[l] = C(1, 1), c.zz.v[l] = C(2, 2);
      c.xy.v[l] = C(0, 1), c.xz.v[l] = C(0, 2), c.yz.v[l] = C(1, 2);
    }
  }
  for (int arm = 0; arm < 4; ++arm) {
    if (arm_branches >> arm & 1u)
      problem_->objective->Evaluate(compliance[arm], context_, out.objective[arm]);
  }
  // A compliance without an objective's value is singular, whatever the bounds say.
  for (int branch = 0; branch < 8; ++branch) {
    for (int l = 0; l < kLanes; ++l) {
      if (out.admissibility[branch][l] != Admissibility::kAdmissible) continue;
      if (!std::isfinite(out.objective[branch & 3].v[l])) {
        out.admissibility[branch][l] = Admissibility::kSingular;
        out.shortfall[branch].v[l] = 1.0;
      }
    }
  }
}

void PointScorer::Score(std::span<const FreedomValues> freedoms, std::span<Candidate> out) const {
  const size_t dimensions = problem_->freedoms.size();
  std::vector<double> values(kLanes * dimensions);
  ScoredBlock block;
  for (size_t first = 0; first < freedoms.size(); first += kLanes) {
    for (size_t l = 0; l < kLanes; ++l) {
      const FreedomValues& lane = freedoms[std::min(first + l, freedoms.size() - 1)];  // the last fills up
      std::copy_n(lane.begin(), dimensions, values.begin() + l * dimensions);
    }
    ScoreBlock(values, kAllArmBranches, block);
    for (size_t l = 0; l < kLanes && first + l < freedoms.size(); ++l) {
      for (int branch = 0; branch < 8; ++branch) {
        out[8 * (first + l) + branch] = CandidateOf(block, branch, static_cast<int>(l));
      }
    }
  }
}

Candidate PointScorer::ScoreOne(const FreedomValues& freedoms, int branch) const {
  std::vector<double> values;
  for (int l = 0; l < kLanes; ++l) values.insert(values.end(), freedoms.begin(), freedoms.end());
  ScoredBlock block;
  ScoreBlock(values, 1u << (branch & 3), block);
  return CandidateOf(block, branch, 0);
}

Candidate CandidateOf(const ScoredBlock& block, int branch, int lane) {
  Candidate candidate;
  candidate.admissibility = block.admissibility[branch][lane];
  candidate.shortfall = block.shortfall[branch].v[lane];
  if (candidate.admissibility == Admissibility::kUnreachable) return candidate;
  candidate.objective = block.objective[branch & 3].v[lane];
  for (int i = 0; i < 6; ++i) candidate.q[i] = block.q[branch][i].v[lane];
  return candidate;
}

Admissibility CheckAdmissible(const PoseProblem& problem, const Joints& q) {
  for (int i = 0; i < 6; ++i) {
    if (q[i] < problem.bounds.lower[i] || q[i] > problem.bounds.upper[i]) return Admissibility::kLimit;
  }
  return SingularShortfall(problem, q) > 0.0 ? Admissibility::kSingular : Admissibility::kAdmissible;
}

}  // namespace millpose
