// SPDX-License-Identifier: GPL-3.0-or-later
// What a probe touched on a part, and how far from it each point lies (docs/registration.md).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// What a probed point lies on.
enum class ProbedOn : uint8_t {
  kFace,    ///< any face of the part, its sides included
  kEdge,    ///< a sharp edge, or the rim of an open sheet
  kHole,    ///< the axis of a round hole
  kTarget,  ///< a point of its own
};

/// A probed point. The frame F is the one in which the part's pose is wanted.
struct ProbedPoint {
  ProbedOn on = ProbedOn::kFace;
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();  ///< in F, mm; of a face the ball's centre
  double radius = 0;                                   ///< of the ball, mm; faces alone
  double sd = 0;                                       ///< standard deviation of one coordinate, mm; above 0
  std::optional<Eigen::Vector3d> normal;   ///< in F, out of the material: which way the touched face looks
  std::optional<Eigen::Vector3d> nominal;  ///< in P, mm; of a target
};

/// One to three equations d·(p − place) = 0 that a point p should fulfil; none where the part has no such
/// feature.
struct ProbeEquations {
  int count = 0;
  std::array<Eigen::Vector3d, 3> direction;  ///< unit vectors d, in P
  std::array<double, 3> distance{};          ///< d·(p − place), mm, less the ball's radius

  /// Root of the sum of squares, mm.
  double Length() const;
  void Add(const Eigen::Vector3d& d, double mm);
};

/// A part's faces, sharp edges and holes, ready to be asked. Safe to ask from many threads.
class ProbedPart {
 public:
  /// Edges are sharp that bend by more than `crease` (rad).
  ProbedPart(const Mesh& mesh, double crease);

  /// What `point` says when it lies at p (mm, in P) and its normal, where it has one, is `normal` there: of
  /// the nearest face (of those that look its way within 60°), edge (across it), hole (across its axis) or
  /// its own target.
  ProbeEquations Equations(const ProbedPoint& point, const Eigen::Vector3d& p,
                           const std::optional<Eigen::Vector3d>& normal) const;

  const Mesh& mesh() const { return mesh_; }
  bool HasHoles() const { return !holes_.empty(); }
  /// Half of the diagonal of the box around it, mm.
  double size() const { return size_; }

 private:
  struct Line {
    Eigen::Vector3d from, to;  ///< of a hole's axis a point and another in its direction
  };
  ProbeEquations OfFace(const ProbedPoint& point, const Eigen::Vector3d& p,
                        const std::optional<Eigen::Vector3d>& normal) const;
  ProbeEquations OfEdge(const Eigen::Vector3d& p) const;
  ProbeEquations OfHole(const Eigen::Vector3d& p) const;

  Mesh mesh_;
  Bvh faces_;
  std::vector<Line> edges_, holes_;
  Bvh edge_tree_;
  double size_ = 0;
};

}  // namespace millpose
