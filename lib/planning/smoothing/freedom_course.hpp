// SPDX-License-Identifier: GPL-3.0-or-later
// The path along a piece as a function of one number per point, one of its freedoms: what smoothing
// minimises.
#pragma once

#include "planning/ladder/refine.hpp"
#include "planning/smoothing/box_step.hpp"

namespace millpose {

/// Values that the freedom of a point may take.
struct FreedomRange {
  double lower, upper;
};

/// A point where it stands, and what is known around it.
struct CoursePlace {
  double x = 0;  ///< the freedom
  Joints q = Joints::Zero();
  double objective = 0;
  Joints turn = Joints::Zero();     ///< dq/dx
  double slope = 0, curvature = 0;  ///< of the objective; never curved downwards
  double lower = 0, upper = 0;      ///< how far x may move: admissible as far as it was looked at
  /// mm: tip half-way of the joint motion from here less that of its line, as it was judged.
  Eigen::Vector3d off = Eigen::Vector3d::Zero();
  bool judged = false;  ///< since it moved
};

/// What a course is judged by.
struct Merit {
  double square = 0;     ///< mean square of the joint accelerations, rad²/s⁴
  double objective = 0;  ///< summed
  double violation = 0;  ///< of the bounds between points, with a reserve; relative squares
  bool within = true;    ///< the bounds of the deviations themselves are kept
  bool steps = true;     ///< the bounds of the joint steps and of the lean's change are kept
};

/// Which freedom moves, and how far from one point to the next.
struct CourseBounds {
  std::span<const Joints> max_step;       ///< rad
  std::span<const double> max_lean = {};  ///< rad, of a freedom that leans; empty: nothing does
  size_t freedom = 0;
  /// In B, half-way of each straight motion, mm; empty: of the points, where B stands.
  std::span<const Eigen::Vector3d> middles = {};
};

/// One piece: its points, and the bounds between them. Branches and full revolutions are those of `path`,
/// whose joint angles are continuous. All spans have one entry per point (bounds: of the step from there on)
/// and outlive the course.
class FreedomCourse {
 public:
  FreedomCourse(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                std::span<const PathNode> path, bool closed, const CourseBounds& bounds);

  /// Bounds of the deviations half-way (HalfwayDeviation), mm, one per motion; the last closes a ring.
  void set_limits(std::vector<double> limits) { limits_ = std::move(limits); }
  size_t motions() const { return motions_; }

  /// The path as it is, with what is known around its points. Those of an empty range stay.
  std::vector<CoursePlace> Start(std::span<const FreedomRange> ranges) const;
  /// The points of `from`, which these ranges gave, at the values `x`. One that is not admissible there stays
  /// as it is.
  std::vector<CoursePlace> Moved(const std::vector<double>& x, std::span<const FreedomRange> ranges,
                                 std::vector<CoursePlace> from) const;
  /// Notes how far the motions leave their lines: looked at where a place has moved since it was judged.
  Merit Judge(std::vector<CoursePlace>& places) const;

  /// Adds what changes with the places, which were judged: `square_weight` · mean square, `objective_weight`
  /// · objective and `violation_weight` · violation, linear in dq.
  void AddTo(BoxLeastSquares& squares, const std::vector<CoursePlace>& places, double square_weight,
             double objective_weight, double violation_weight) const;

 private:
  /// The joint accelerations at one point: left·(q_m − q_{m−1}) + right·(q_{m+1} − q_m), and its share of
  /// time.
  struct AccelerationRow {
    size_t before, middle, after;
    double left, right, share;
  };

  void MakeRows();
  size_t Next(size_t t) const { return t + 1 == path_.size() ? 0 : t + 1; }
  size_t Before(size_t t) const { return t == 0 ? path_.size() - 1 : t - 1; }
  double Way(size_t t) const;
  /// Puts a place at `x` and looks around; leaves it as it is where `x` is not admissible and not its own.
  void Probe(size_t t, double x, const FreedomRange& range, CoursePlace& place) const;
  Joints Acceleration(const std::vector<CoursePlace>& places, const AccelerationRow& row) const;
  double LeanShare(const std::vector<CoursePlace>& places, size_t t) const;
  Eigen::Vector3d Off(size_t t, const Joints& from, const Joints& step) const;
  void AddViolations(BoxLeastSquares& squares, const std::vector<CoursePlace>& places, size_t t,
                     double weight) const;

  std::span<const PointScorer> scorers_;
  std::span<const MillingPoint> points_;
  std::span<const PathNode> path_;
  const PoseProblem& problem_;
  CourseBounds bounds_;
  bool closed_;
  size_t motions_;
  std::vector<AccelerationRow> rows_;
  std::vector<double> limits_;
};

}  // namespace millpose
