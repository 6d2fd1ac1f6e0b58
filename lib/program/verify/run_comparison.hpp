// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/overlap.hpp"
#include "program/verify/arm_bodies.hpp"
#include "program/verify/compare.hpp"
#include "program/verify/corner.hpp"
#include "program/verify/follow.hpp"

namespace millpose {

/// One feed run of the program against its counterpart of the plan.
class RunComparison {
 public:
  /// The arguments outlive it. `proofs`: one entry per motion of the program; those of the run are set.
  RunComparison(const Replayed& replayed, const FeedRun& run, const Replayed& plan, const FeedRun& plan_run,
                const ArmBodies& bodies, const VerifyOptions& options, std::vector<Proof>& proofs);

  std::vector<Finding> Compare();
  /// What Compare() has sampled, motion by motion.
  void HandOn(const MotionQuery& look, std::vector<Finding>& findings) const;

 private:
  const Motion& PlanMotion(size_t segment) const { return plan_.program.motions[plan_run_.first + segment]; }
  /// The real tool in the real workpiece's frame, where motion `i` ends: what the plan states is compared
  /// there.
  Pose Tool(size_t i) const { return ToolAt(i, 1, replayed_.replay.targets[i]); }
  Pose ToolAt(size_t i, double share, const Joints& q) const;
  Pose BaseAt(size_t i, double share) const;
  bool ReachedAll() const;
  bool EntersByRoundedAngles() const;
  bool LengthsFit();
  void Sample();
  void CompareForward();
  bool CompareOtherWays(const Instant& instant, const PathFollower& follower);
  void CompareFeed(size_t instant, size_t segment);
  bool CompareExternal(const Instant& instant, const PathFollower& follower, const PathDeviation& off);
  double PassesBy(size_t axis, size_t segment, const PathDeviation& off) const;
  bool LeavesProven(const Instant& instant, const PathFollower& follower) const;
  void CompareBackward();
  void CompareStops();
  void ComparePlannedStops();
  void CompareCorner(size_t i);
  CornerRounding OverlapAt(size_t i) const;
  /// The tool where joints and external axes are by so much beside the end of motion `i`.
  Pose Passed(size_t i, const AllAxes& off) const;
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
  const bool plan_rides_, rides_;  // external axes move along: in the plan; in it or the program
  Pose X_PB_;                      // where the run begins
  std::vector<Pose> path_;         // the plan's, segment k ends at path_[k + 1]
  std::vector<Instant> instants_;
  std::vector<Pose> driven_;          // the instants' tools in P
  std::vector<ProgrammedLine> ways_;  // other than replayed, of motion ways_of_
  size_t ways_of_ = 0;
  std::vector<Finding> findings_;
};

}  // namespace millpose
