// SPDX-License-Identifier: GPL-3.0-or-later
// An independent count of what a roughing path does: heights on a lattice of its own, blocks as the part. It
// shares nothing with lib/ but the points of the path.
#pragma once

#include <Eigen/Dense>
#include <deque>
#include <functional>
#include <vector>

#include "toolpath/milling_point.hpp"

namespace millpose {

/// A part of blocks that stand side by side on a common floor, their walls along x and y; mm.
struct CountedBlock {
  Eigen::Vector2d lower, upper;
  double top;
};

struct CountedCut {
  double radius = 0, corner = 0, allowance = 0;
  double feed = 0;  ///< of points that cut; others are entries or move in the air
};

/// Stock as heights above the part's floor, and the path milled into it.
class RoughCounter {
 public:
  RoughCounter(const Eigen::Vector2d& lower, const Eigen::Vector2d& upper, double top, double cell,
               std::vector<CountedBlock> part, const CountedCut& cut);

  /// Mills a path whose tool axis is z.
  void Mill(const Toolpath& toolpath);

  double Removed() const;  ///< mm³
  /// mm³ that a cutter takes off which stands wherever it keeps the allowance, at the path's own heights.
  double Reachable() const;
  /// How much nearer to the part than the allowance it came, mm; below 0: nowhere.
  double DeepestGouge() const;
  /// The largest engagement on cuts, rad; chips thinner than 0.25 mm are not counted.
  double Engagement() const { return engagement_; }
  /// Likewise on motions that are to cut nothing, rad.
  double EngagementInTheAir() const { return in_air_; }
  /// The largest drop at the first point of a pass into material under the cutter, mm.
  double DeepestPlunge() const { return plunge_; }
  double SteepestEntry() const { return slope_; }  ///< of all motions: drop ÷ way across
  double cell() const { return cell_; }
  /// Calls `visit` with the middle of each cell of the stock and its height now.
  void ForEachCell(const std::function<void(const Eigen::Vector2d&, double)>& visit) const;
  /// Another cutter goes on; its figures count from here.
  void Change(const CountedCut& cut);

 private:
  Eigen::Vector2d Centre(int i, int j) const;
  double DistanceFromPart(const Eigen::Vector3d& p) const;
  /// How far the axis is from where it would come nearer than the allowance, mm.
  double Room(const Eigen::Vector2d& p, double height) const;
  void Come(const Eigen::Vector3d& from, const MillingPoint& to);
  double Meets(const Eigen::Vector3d& tip, const Eigen::Vector2d& along) const;
  /// `wider`: by which the cutter is, mm.
  void Take(const Eigen::Vector3d& tip, double wider);
  void TakeFirst();

  Eigen::Vector2d origin_;
  double cell_;
  int columns_, rows_;
  std::vector<CountedBlock> part_;
  CountedCut cut_;
  std::vector<double> heights_, begun_;
  std::vector<double> levels_;
  std::deque<Eigen::Vector3d> pending_;  ///< where a cut was last
  double in_air_ = 0, engagement_ = 0, plunge_ = 0, slope_ = 0;
};

}  // namespace millpose
