// SPDX-License-Identifier: GPL-3.0-or-later
// Where the tool really is when the arm has the poses of a plan (docs/face.md).
#pragma once

#include <functional>
#include <vector>

#include "geometry/registration/bending.hpp"
#include "machine/motion/lost_motion.hpp"
#include "machine/stiffness/series.hpp"
#include "planning/face/arm_geometry.hpp"
#include "planning/result/plan_result.hpp"
#include "toolpath/stock/swept_cutter.hpp"

namespace millpose {

/// What keeps the tool from where the plan has it; as constructed: nothing.
struct ToolErrors {
  double force = 0;  ///< times the plan's mean forces: 0 a rigid arm, 1 as stated
  /// Turns these forces, in the frame of feed, normal × feed and normal.
  Eigen::Matrix3d force_turn = Eigen::Matrix3d::Identity();
  LostMotion lost;                                 ///< of the gears; without width none
  GearError gears;                                 ///< their periodic error; without amplitude none
  bool geometry = false;                           ///< what the arm's deviations do
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();   ///< of the tip in the flange, in T, mm
  Eigen::Vector3d lean = Eigen::Vector3d::Zero();  ///< of the tool's direction, as a rotation in T, rad
  /// The part's shift (mm) and turn (rad) about `part_centre` from where the job has it, all in P.
  Eigen::Vector3d part_shift = Eigen::Vector3d::Zero(), part_turn = Eigen::Vector3d::Zero();
  Eigen::Vector3d part_centre = Eigen::Vector3d::Zero();
  PartBending part_bending;  ///< how it is bent besides; without modes: no more than the plan has it
};

/// The cuts that leave a plan's finished face, with what moves the tool at their points.
class ErringPath {
 public:
  /// Of the passes from `finished_from` on, leads included. `compliances`: beside the joints' own.
  /// `weight_in` gives the torques about the arm's axes (N·mm) that its weight makes in a pose; empty: none.
  /// `deviations`: of the arm's geometry; where the part stands was measured with this arm.
  ErringPath(const PlanResult& plan, const std::vector<SeriesCompliance>& compliances, int finished_from,
             const std::function<Joints(const Joints& q)>& weight_in = {},
             const ArmDeviations* deviations = nullptr);

  /// In P. The tip goes by c·F + J·(y − q) and the gears' periodic error, against the part's own, and what
  /// the tool itself errs by, and what compensation has commanded against the force is added; the axis turns
  /// with it. Every segment is entered settled (OffsetsAlong). Between two points the error changes evenly.
  std::vector<CutterMotion> Motions(const ToolErrors& errors) const;

 private:
  struct Point {
    CutterPlace nominal;
    Eigen::Vector3d shift;                             ///< commanded by compensation, mm
    Eigen::Matrix3d R_PT;                              ///< of the tool
    Eigen::Matrix3d frame;                             ///< columns: feed, normal × feed, normal
    Eigen::Vector3d force;                             ///< in that frame, N
    Eigen::Matrix<double, 6, 3> by_force;              ///< tip (mm) and turn (rad) per N along x, y, z
    Eigen::Matrix<double, 6, Eigen::Dynamic> by_axis;  ///< the same per rad (mm) of the arm's and other axes
    Joints q;
    ExternalPosition external;
    Joints weight;                           ///< torques about the arm's axes, N·mm
    FrameTwist by_arm = FrameTwist::Zero();  ///< by its geometry, less the measured frame
  };
  struct Cut {
    int pass = 0;
    bool closed = false;
    std::vector<Point> points;
  };

  static CutterPlace PlaceOf(const Point& point, const ToolErrors& errors, const GearValues& offset);
  static std::vector<GearPlace> WayOf(const Cut& cut, const ToolErrors& errors);
  friend class ErringPoints;

  std::vector<Cut> cuts_;
};

}  // namespace millpose
