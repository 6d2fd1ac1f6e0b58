// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "toolpath/region.hpp"

namespace millpose {

/// mm: a place that names a STEP face ("near X Y Z") lies on it to this, as those that `check` prints do.
inline constexpr double kNearFace = 1;

/// The place of such a name, in the workpiece frame, mm; empty for any other text.
std::optional<Eigen::Vector3d> NearPlace(const std::string& name);

/// One level of RegionOptions made ready for a mesh. Margins are ways on the face (or its plane), so that
/// they do not end at a limit that a face runs along. They combine as min (all), max (any) and sign (none),
/// which keeps them 1-Lipschitz; conditions on whole faces count as plus or minus infinity.
class RegionTerm {
 public:
  /// `outermost`: its rim distance is left to Region.
  RegionTerm(const Mesh& mesh, const RegionOptions& options, bool outermost = false);

  /// As Region::Margin, without the outermost rims.
  double Margin(int face, const Eigen::Vector3d& p) const;
  /// The largest (`upper`) or smallest margin that any point of the face could have.
  double Bound(int face, bool upper) const;

 private:
  double FaceMargin(int face) const;
  double PointMargin(int face, const Eigen::Vector3d& p) const;
  bool HasPointConditions() const {
    return options_.box || options_.half_space || options_.polygon || !borders_.empty();
  }
  double PolygonMargin(const Eigen::Vector3d& p, const Eigen::Vector3d& face_normal) const;

  Mesh mesh_;
  RegionOptions options_;
  std::vector<char> facing_, connected_, source_;  // by face; empty when not asked for
  Eigen::Vector3d u_ = Eigen::Vector3d::Zero(),
                  v_ = Eigen::Vector3d::Zero();  // across the polygon's direction
  std::vector<RegionTerm> all_, any_, none_;
  RegionBorders borders_;  // empty without rim distance
};

}  // namespace millpose
