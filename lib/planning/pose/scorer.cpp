// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/scorer.hpp"

#include <limits>

#include "machine/robot/inverse_entries.hpp"
#include "planning/pose/judge_block.hpp"
#include "planning/pose/lean_problem.hpp"

namespace millpose {
namespace {

/// Whether all lanes have the same values of all freedoms but the first.
bool AllAlike(std::span<const double> values, size_t dimensions) {
  for (size_t l = 1; l < kLanes; ++l)
    if (!std::equal(values.begin() + 1, values.begin() + static_cast<std::ptrdiff_t>(dimensions),
                    values.begin() + static_cast<std::ptrdiff_t>(l * dimensions + 1)))
      return false;
  return true;
}

}  // namespace

PointScorer::PointScorer(const PoseProblem& problem, const MillingPoint& point,
                         const Eigen::Vector3d& rotation_reference)
    : problem_(&problem),
      X_WT_nominal_(NominalToolPose(point, rotation_reference)),
      X_BW_(problem.X_WB.inverse()),
      X_TF_(problem.X_FT.inverse()),
      p_FO_(problem.origin == StiffnessOrigin::kToolTip ? Eigen::Vector3d(problem.X_FT.translation())
                                                        : Eigen::Vector3d::Zero()),
      series_(problem.arm, problem.compliances, p_FO_) {
  context_.normal = X_BW_.linear() * point.normal;
  context_.feed = X_BW_.linear() * point.feed;
  context_.tool_axis = X_BW_.linear() * point.tool_axis;
  context_.force = X_BW_.linear() * point.engagement.force;
  rotation_only_ = problem.freedoms.size() == 1 && problem.freedoms[0]->IsToolRotation();
  rotated_ = RotatedFlange(X_BW_ * X_WT_nominal_, X_TF_);
  leans_ = HasLean(problem);
  rotates_and_leans_ = leans_ && problem.freedoms[0]->IsToolRotation() &&
                       std::all_of(problem.freedoms.begin() + 1, problem.freedoms.end(),
                                   [](const auto& freedom) { return freedom->IsLean(); });
  if (!leans_) return;
  contact_ = ContactOf(problem, point);
  rotation_reference_ = rotation_reference;
  bound_.emplace(*problem.lean, contact_.place, contact_.normal, contact_.feed);
}

Pose PointScorer::ToolPose(const double* freedoms) const {
  Pose X_WT = leans_ ? NominalToolPose(StanceAt(*problem_, contact_, {freedoms, problem_->freedoms.size()}),
                                       rotation_reference_)
                     : X_WT_nominal_;
  for (const auto& freedom : problem_->freedoms) X_WT = freedom->Apply(X_WT, *freedoms++);
  return X_WT;
}

/// Lanes of the same lean, which mostly come together, share what turns with the rotation alone.
void PointScorer::LeaningFlangePoses(std::span<const double> values, FlangeBlock& out,
                                     BlockAxes& axes) const {
  const size_t dimensions = problem_->freedoms.size();
  Lanes angles;
  for (size_t l = 0; l < kLanes; ++l) angles.v[l] = values[l * dimensions];
  const SineCosineLanes turns = SinCosOf(angles);
  axes.alike = AllAlike(values, dimensions);
  RotatedFlange rotated;
  for (size_t l = 0; l < kLanes; ++l) {
    const double* own = values.data() + l * dimensions;
    if (l > 0 && (axes.alike || std::equal(own + 1, own + dimensions, own + 1 - dimensions))) {
      axes.axis[l] = axes.axis[l - 1];
      axes.barred |= (axes.barred >> (l - 1) & 1u) << l;
    } else {
      const ToolStance stance = StanceAt(*problem_, contact_, {own, dimensions});
      axes.axis[l] = stance.axis;
      if (!bound_->Admits(stance.axis)) axes.barred |= 1u << l;
      rotated = RotatedFlange(X_BW_ * NominalToolPose(stance, rotation_reference_), X_TF_);
    }
    if (!axes.alike) rotated.SetLane(l, turns, out);
  }
  if (axes.alike) rotated.Set(turns, out);
}

void PointScorer::FlangePoses(std::span<const double> values, FlangeBlock& out, BlockAxes& axes) const {
  if (rotation_only_) {
    Lanes angles;
    std::copy_n(values.begin(), kLanes, angles.v);
    rotated_.Set(SinCosOf(angles), out);
    return;
  }
  if (rotates_and_leans_) return LeaningFlangePoses(values, out, axes);
  const size_t dimensions = problem_->freedoms.size();
  for (size_t l = 0; l < kLanes; ++l) {
    const Pose X_WT = ToolPose(values.data() + l * dimensions);
    out.Set(static_cast<int>(l), X_BW_ * X_WT * X_TF_);
    if (!leans_) continue;
    axes.axis[l] = X_WT.linear().col(2);
    axes.alike = false;
    if (!bound_->Admits(axes.axis[l])) axes.barred |= 1u << l;
  }
}

void PointScorer::ScoreBlock(std::span<const double> values, unsigned arm_branches, ScoredBlock& out) const {
  for (auto& branch : out.obstacle) branch.fill(Infeasibility::kUnreachable);
  for (Lanes& branch : out.shortfall) std::fill_n(branch.v, kLanes, std::numeric_limits<double>::infinity());
  FlangeBlock flange;
  BlockAxes axes;
  FlangePoses(values, flange, axes);
  if (axes.barred == (1u << kLanes) - 1) return;
  ArmBranches solved;
  InverseEntries(problem_->arm, flange, arm_branches | arm_branches << 4, solved);
  for (int entry = 0; entry < EntryCount(problem_->arm); ++entry) {
    if (arm_branches >> (entry & 3) & 1u) ScoreEntry(entry, flange, solved[entry], axes, out);
  }
  for (size_t l = 0; l < kLanes; ++l) {
    if ((axes.barred >> l & 1u) == 0) continue;
    for (int branch = 0; branch < 8; ++branch) {
      out.obstacle[branch][l] = Infeasibility::kUnreachable;
      out.shortfall[branch].v[l] = std::numeric_limits<double>::infinity();
    }
  }
}

/// The objective, each lane's with the axis that it has.
void PointScorer::Evaluate(const ComplianceBlock& c, const BlockAxes& axes, Lanes& out) const {
  if (!leans_ || !problem_->objective->ReadsToolAxis())
    return problem_->objective->Evaluate(c, context_, out);
  ObjectiveContext context = context_;
  Lanes lanes;
  for (size_t l = 0; l < kLanes; ++l) {
    if (l == 0 || axes.axis[l] != axes.axis[l - 1]) {
      context.tool_axis = X_BW_.linear() * axes.axis[l];
      problem_->objective->Evaluate(c, context, lanes);
    }
    out.v[l] = lanes.v[l];
  }
}

/// In the order reach, limits, singularities, stiffness: what is cheap first, and no more than is asked for.
void PointScorer::ScoreEntry(int entry, const FlangeBlock& flange, const ArmBranchBlock& solved,
                             const BlockAxes& axes, ScoredBlock& out) const {
  if (std::none_of(solved.reached.v, solved.reached.v + kLanes, [](double r) { return r > 0.0; })) return;
  CheckedBranch checked;
  CheckAdmissible(*problem_, flange, solved, checked);
  bool any_admissible = false;
  for (int branch = entry; branch < 8; branch += EntryCount(problem_->arm)) {
    const CheckedWrist& wrist = branch == entry ? checked.unflipped : checked.flipped;
    out.obstacle[branch] = wrist.obstacle;
    out.shortfall[branch] = wrist.shortfall;
    std::copy(wrist.q.begin(), wrist.q.end(), out.q[branch]);
    any_admissible |= std::ranges::find(wrist.obstacle, Infeasibility::kNone) != wrist.obstacle.end();
  }
  if (!any_admissible) return;
  ComplianceBlock joints;
  LinearCompliance(problem_->arm, flange, solved, p_FO_, joints);
  for (int branch = entry; branch < 8; branch += EntryCount(problem_->arm)) {
    if (branch == entry || series_.TurnsWithWrist()) {
      ComplianceBlock whole = joints;
      if (!series_.empty()) series_.AddTo(flange, solved, branch != entry, whole);
      Evaluate(whole, axes, out.objective[branch]);
    } else {
      out.objective[branch] = out.objective[entry];
    }
    // A compliance without an objective's value is singular, whatever the bounds say.
    for (int l = 0; l < kLanes; ++l) {
      if (out.obstacle[branch][l] != Infeasibility::kNone) continue;
      if (std::isfinite(out.objective[branch].v[l])) continue;
      out.obstacle[branch][l] = Infeasibility::kSingular;
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
  if (candidate.obstacle == Infeasibility::kUnreachable) return candidate;
  if (candidate.obstacle == Infeasibility::kNone) {
    candidate.objective = block.objective[branch].v[lane];
  }
  for (int i = 0; i < 6; ++i) candidate.q[i] = block.q[branch][i].v[lane];
  return candidate;
}

}  // namespace millpose
