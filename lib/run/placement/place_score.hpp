// SPDX-License-Identifier: GPL-3.0-or-later
// What a place is worth, by a sample of the job's points.
#pragma once

#include <array>

#include "planning/ladder/scored_point.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "run/placement/place_space.hpp"

namespace millpose {

/// What a place is worth to one operation.
struct OperationScore {
  /// Sampled points by what keeps them (Obstacle): free, unreachable, outside the limits, near a
  /// singularity, in interference, off the branch that serves most of their pass (kStep).
  std::array<size_t, 6> points{};
  double worst = 0, mean = 0;  ///< of the free ones' least objective
};

struct PlaceScore {
  PoseSettings place;
  std::vector<OperationScore> operations;
  std::string touches;  ///< a body that what moves would stand in, or "home": the arm at home would touch

  size_t total() const;
  size_t free() const;
  /// Why points are not free: how many by obstacle, of all operations.
  size_t Count(Infeasibility obstacle) const;
};

/// Points of a job that are looked at, in P: of every operation.
using Samples = std::vector<Toolpath>;

/// Scores places: for every sampled point the least objective of all rotations 5° apart that is admissible
/// and free of interference, all points of a pass on the branch that is best for them. Nothing else joins
/// points: a plan may do worse, and where it splits passes better.
class PlaceScorer {
 public:
  /// `inputs`: the job, or all its operations. Throws InputError; Interrupted.
  PlaceScorer(const std::vector<JobInputs>& inputs, const Execution& execution);

  /// The same for any number of threads. Throws Interrupted.
  PlaceScore Score(const PoseSettings& place, const Execution& execution) const {
    return Score(place, samples_, execution);
  }
  PlaceScore Score(const PoseSettings& place, const Samples& samples, const Execution& execution) const;
  /// Of the first operation every point of its sample, in interference where the part or the robot touches.
  std::vector<ScoredPoint> Points(const PoseSettings& place, const Execution& execution) const;

  /// Bodies that what moves touches where the job has it, and may touch elsewhere: it stands on them.
  const std::vector<std::string>& stands_on() const { return stands_on_; }
  const std::vector<PreparedJob>& operations() const { return prepared_; }
  const Samples& All() const { return samples_; }
  /// Of an operation, in P.
  const Toolpath& Sample(size_t operation) const { return samples_[operation]; }
  /// As many points of a share of the path as of the whole.
  Samples SampleOf(const PathSection& share) const;

 private:
  bool robot() const;
  Mount Mover() const;
  /// X_WB, X_WP; where the robot moves the part stands as in the operation's own setup.
  std::pair<Pose, Pose> PosesAt(const PoseSettings& place, size_t operation) const;
  std::string Touches(const Pose& X_WB, const Pose& X_WP) const;
  std::vector<ScoredPoint> ScorePoints(size_t operation, const Toolpath& sample, const World& world,
                                       const Execution& execution) const;

  const std::vector<JobInputs>& inputs_;
  std::vector<PreparedJob> prepared_;
  size_t count_ = 0;  ///< of sampled points
  Samples samples_;
  std::optional<World> standing_;  ///< what stands still, with the bodies to keep out of
  std::vector<std::string> stands_on_;
};

}  // namespace millpose
