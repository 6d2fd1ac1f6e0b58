// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "verify/arm_bodies.hpp"
#include "verify/compare.hpp"
#include "verify/corner.hpp"
#include "verify/follow.hpp"

namespace millpose {

/// One feed run of the program against its counterpart of the plan.
class RunComparison {
 public:
  /// The arguments outlive it. `proofs`: one entry per motion of the program; those of the run are set.
  RunComparison(const Replayed& replayed, const FeedRun& run, const Replayed& plan, const FeedRun& plan_run,
                const ArmBodies& bodies, const VerifyOptions& options, std::vector<Proof>& proofs);

  std::vector<Finding> Compare();

 private:
  const Motion& PlanMotion(size_t segment) const { return plan_.program.motions[plan_run_.first + segment]; }
  /// The real tool in the real workpiece's frame: what the plan states is compared there.
  Pose Tool(const Joints& q) const;
  bool ReachedAll() const;
  bool LengthsFit();
  void Sample();
  void CompareForward();
  bool CompareOtherWays(const Instant& instant, const PathFollower& follower);
  void CompareFeed(const Instant& before, const Instant& instant, size_t segment);
  bool LeavesProven(const Joints& q, size_t segment) const;
  void CompareBackward();
  void CompareStops();
  void ComparePlannedStops();
  void CompareCorner(size_t i);
  CornerRounding OverlapAt(size_t i) const;
  bool PlannedStop(size_t i) const;
  std::string Name(size_t segment) const;

  const Replayed& replayed_;
  const FeedRun run_;
  const Replayed& plan_;
  const FeedRun plan_run_;
  const Cell& cell_;
  const ArmBodies& bodies_;
  const VerifyOptions& options_;
  std::vector<Proof>& proofs_;
  Pose X_PB_;
  std::vector<Pose> path_;  // the plan's, segment k ends at path_[k + 1]
  std::vector<Instant> instants_;
  std::vector<Pose> driven_;          // the instants' tools in P
  std::vector<ProgrammedLine> ways_;  // other than replayed, of motion ways_of_
  size_t ways_of_ = 0;
  std::vector<Finding> findings_;
};

}  // namespace millpose
