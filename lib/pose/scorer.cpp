// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/scorer.hpp"

#include <limits>

#include "pose/judge_block.hpp"

namespace millpose {
namespace {

// Less than this is missed by rounding only: the same joints come from the block kernels, from scalar code
// and with other full revolutions.
constexpr double kSingularRounding = 1e-10;

/// What is missed of the bounds on singularity and dexterity; 0 when nothing.
double SingularShortfall(const AdmissibleBounds& bounds, const SingularityDistance& distance,
                         double dexterity) {
  const double missing = std::max(0.0, bounds.wrist_min - distance.wrist) +
                         std::max(0.0, bounds.elbow_min - distance.elbow) +
                         1e-3 * std::max(0.0, bounds.shoulder_min_mm - distance.shoulder) +
                         std::max(0.0, bounds.dexterity_min - dexterity);
  return missing > kSingularRounding ? missing : 0.0;
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
  context_.force = X_BW_.linear() * point.engagement.force;
  rotation_only_ = problem.freedoms.size() == 1 && problem.freedoms[0]->IsToolRotation();
  rotated_ = RotatedFlange(X_BW_ * X_WT_nominal_, X_TF_);
}

Pose PointScorer::ToolPose(const double* freedoms) const {
  Pose X_WT = X_WT_nominal_;
  for (const auto& freedom : problem_->freedoms) X_WT = freedom->Apply(X_WT, *freedoms++);
  return X_WT;
}

void PointScorer::FlangePoses(std::span<const double> values, FlangeBlock& out) const {
  if (rotation_only_) {
    Lanes angles;
    std::copy_n(values.begin(), kLanes, angles.v);
    rotated_.Set(angles, out);
    return;
  }
  const size_t dimensions = problem_->freedoms.size();
  for (int l = 0; l < kLanes; ++l) out.Set(l, X_BW_ * ToolPose(values.data() + l * dimensions) * X_TF_);
}

void PointScorer::ScoreBlock(std::span<const double> values, unsigned arm_branches, ScoredBlock& out) const {
  for (auto& branch : out.obstacle) branch.fill(Obstacle::kUnreachable);
  for (Lanes& branch : out.shortfall) std::fill_n(branch.v, kLanes, std::numeric_limits<double>::infinity());
  FlangeBlock flange;
  FlangePoses(values, flange);
  ArmBranches solved;
  InverseBlock(problem_->arm, flange, solved);
  for (int entry = 0; entry < EntryCount(problem_->arm); ++entry) {
    if (arm_branches >> (entry & 3) & 1u) ScoreEntry(entry, flange, solved[entry], out);
  }
}

/// In the order reach, limits, singularities, stiffness: what is cheap first, and no more than is asked for.
void PointScorer::ScoreEntry(int entry, const FlangeBlock& flange, const ArmBranchBlock& solved,
                             ScoredBlock& out) const {
  if (std::none_of(solved.reached.v, solved.reached.v + kLanes, [](double r) { return r > 0.0; })) return;
  AnglesBlock angles;
  AnglesOfBranch(problem_->arm, solved, angles);
  JudgedBranch judged;
  Judge(problem_->bounds, solved, angles, judged);
  if (problem_->bounds.dexterity_min > 0.0) {
    Lanes dexterity;
    DexterityOfBlock(problem_->arm, flange, solved, problem_->X_FT.translation(),
                     problem_->characteristic_length, dexterity);
    for (int l = 0; l < kLanes; ++l) {
      judged.singular.v[l] += std::max(0.0, problem_->bounds.dexterity_min - dexterity.v[l]);
    }
  }
  bool any_admissible = false;
  for (int branch = entry; branch < 8; branch += EntryCount(problem_->arm)) {
    const JudgedWrist& wrist = branch == entry ? judged.unflipped : judged.flipped;
    for (int l = 0; l < kLanes; ++l) {
      if (!(solved.reached.v[l] > 0.0)) continue;
      const double limit = wrist.limit.v[l];
      const double singular = judged.singular.v[l] > kSingularRounding ? judged.singular.v[l] : 0.0;
      out.shortfall[branch].v[l] = limit > 0.0 ? limit : singular;
      out.obstacle[branch][l] = limit > 0.0      ? Obstacle::kLimit
                                : singular > 0.0 ? Obstacle::kSingular
                                                 : Obstacle::kNone;
      any_admissible |= out.obstacle[branch][l] == Obstacle::kNone;
    }
    std::copy(wrist.q.begin(), wrist.q.end(), out.q[branch]);
  }
  if (!any_admissible) return;
  ComplianceBlock joints;
  LinearCompliance(problem_->arm, flange, solved, p_FO_, joints);
  problem_->objective->Evaluate(joints, context_, out.objective[entry]);
  for (int branch = entry; branch < 8; branch += EntryCount(problem_->arm)) {
    if (branch != entry && problem_->compliances.empty()) out.objective[branch] = out.objective[entry];
    if (!problem_->compliances.empty()) {
      ComplianceBlock whole = joints;
      AddSeriesCompliance(problem_->arm, problem_->compliances, p_FO_, solved.reached,
                          branch == entry ? judged.unflipped.q : judged.flipped.q, whole);
      problem_->objective->Evaluate(whole, context_, out.objective[branch]);
    }
    // A compliance without an objective's value is singular, whatever the bounds say.
    for (int l = 0; l < kLanes; ++l) {
      if (out.obstacle[branch][l] != Obstacle::kNone) continue;
      if (std::isfinite(out.objective[branch].v[l])) continue;
      out.obstacle[branch][l] = Obstacle::kSingular;
      out.shortfall[branch].v[l] = 1.0;
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
  candidate.obstacle = block.obstacle[branch][lane];
  candidate.shortfall = block.shortfall[branch].v[lane];
  if (candidate.obstacle == Obstacle::kUnreachable) return candidate;
  if (candidate.obstacle == Obstacle::kNone) {
    candidate.objective = block.objective[branch].v[lane];
  }
  for (int i = 0; i < 6; ++i) candidate.q[i] = block.q[branch][i].v[lane];
  return candidate;
}

Obstacle CheckAdmissible(const PoseProblem& problem, const Joints& q) {
  for (int i = 0; i < 6; ++i) {
    if (q[i] < problem.bounds.lower[i] || q[i] > problem.bounds.upper[i]) return Obstacle::kLimit;
  }
  double dexterity = 0;
  if (problem.bounds.dexterity_min > 0.0)
    dexterity =
        Dexterity(Jacobian(problem.arm, q, problem.X_FT.translation()), problem.characteristic_length);
  const double missing = SingularShortfall(problem.bounds, DistanceToSingularity(problem.arm, q), dexterity);
  return missing > 0.0 ? Obstacle::kSingular : Obstacle::kNone;
}

}  // namespace millpose
