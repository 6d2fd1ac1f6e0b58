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

/// What is missed of the bounds on singularity and dexterity; 0 when nothing. Less than rounding is nothing:
/// the same joints come here from the block kernels, from scalar code and with other full turns.
double SingularShortfall(const AdmissibleBounds& bounds, const SingularityDistance& distance,
                         double dexterity) {
  constexpr double kRounding = 1e-10;
  const double missing = std::max(0.0, bounds.wrist_min - distance.wrist) +
                         std::max(0.0, bounds.elbow_min - distance.elbow) +
                         1e-3 * std::max(0.0, bounds.shoulder_min_mm - distance.shoulder) +
                         std::max(0.0, bounds.dexterity_min - dexterity);
  return missing > kRounding ? missing : 0.0;
}

/// Puts the angles within the bounds where full turns can. Returns what is missed of them.
double TurnIntoBounds(const AdmissibleBounds& bounds, Joints& q) {
  double shortfall = 0;
  for (int i = 0; i < 6; ++i) {
    const Turned turned = TurnInto(q[i], bounds.lower[i], bounds.upper[i]);
    q[i] = turned.angle;
    shortfall += turned.shortfall;
  }
  return shortfall;
}

Joints LaneOf(const AnglesBlock& angles, bool flipped, int lane) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = angles.unflipped[i].v[lane];
  if (flipped) q.tail<3>() << angles.flipped4.v[lane], angles.flipped5.v[lane], angles.flipped6.v[lane];
  return q;
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
  const Arm& arm = problem_->arm;
  const size_t dimensions = problem_->freedoms.size();
  for (auto& branch : out.admissibility) branch.fill(Admissibility::kUnreachable);
  for (Lanes& branch : out.shortfall) std::fill_n(branch.v, kLanes, std::numeric_limits<double>::infinity());
  FlangeBlock flange;
  for (int l = 0; l < kLanes; ++l) flange.Set(l, X_BW_ * ToolPose(values.data() + l * dimensions) * X_TF_);
  ArmBranches branches;
  InverseBlock(arm, flange, branches);
  for (int b = 0; b < 4; ++b) {
    if (!(arm_branches >> b & 1u)) continue;
    const ArmBranchBlock& branch = branches[b];
    ComplianceBlock compliance;
    LinearCompliance(arm, flange, branch, p_FO_, compliance);
    problem_->objective->Evaluate(compliance, context_, out.objective[b]);
    AnglesBlock angles;
    AnglesOfBranch(arm, branch, angles);
    Lanes dexterity = {};
    if (problem_->bounds.dexterity_min > 0.0)
      DexterityOfBlock(arm, flange, branch, problem_->X_FT.translation(), problem_->characteristic_length,
                       dexterity);
    for (int l = 0; l < kLanes; ++l) {
      if (branch.reached.v[l] != 0.0) JudgeLane(branch, angles, dexterity.v[l], b, l, out);
    }
  }
}

void PointScorer::JudgeLane(const ArmBranchBlock& branch, const AnglesBlock& angles, double dexterity, int b,
                            int l, ScoredBlock& out) const {
  const AdmissibleBounds& bounds = problem_->bounds;
  double singular =
      SingularShortfall(bounds, {branch.wrist.v[l], branch.elbow.v[l], branch.shoulder.v[l]}, dexterity);
  // A compliance without an objective's value is singular, whatever the bounds say.
  if (!std::isfinite(out.objective[b].v[l])) singular = std::max(singular, 1.0);
  for (const int status : {b, b + 4}) {
    Joints q = LaneOf(angles, status >= 4, l);
    const double beyond = TurnIntoBounds(bounds, q);
    for (int i = 0; i < 6; ++i) out.q[status][i].v[l] = q[i];
    out.shortfall[status].v[l] = beyond > 0.0 ? beyond : singular;
    out.admissibility[status][l] = beyond > 0.0     ? Admissibility::kLimit
                                   : singular > 0.0 ? Admissibility::kSingular
                                                    : Admissibility::kAdmissible;
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
  double dexterity = 0;
  if (problem.bounds.dexterity_min > 0.0)
    dexterity =
        Dexterity(Jacobian(problem.arm, q, problem.X_FT.translation()), problem.characteristic_length);
  const double missing = SingularShortfall(problem.bounds, DistanceToSingularity(problem.arm, q), dexterity);
  return missing > 0.0 ? Admissibility::kSingular : Admissibility::kAdmissible;
}

}  // namespace millpose
