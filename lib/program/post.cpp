// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/post.hpp"

namespace millpose {
/// Defined in the controllers' own files.
PostEntry KrlEntry(), SinumerikEntry(), LinuxCncEntry();

Registry<PostEntry>& Posts() {
  static Registry<PostEntry> posts{"controller", {KrlEntry(), SinumerikEntry(), LinuxCncEntry()}};
  return posts;
}

std::unique_ptr<Post> MakePost(const std::string& name) { return Posts().At(name).make(); }

double Post::Blend(const PathTolerance&, double chord) const {
  constexpr double kLargestRounding = 0.01;  // mm, of a control's tolerance
  return std::min(chord, kLargestRounding);
}

Eigen::Matrix3d ToolAxis(const std::string& name) {
  const bool reversed = name.starts_with('-');
  const std::string axis = reversed ? name.substr(1) : name;
  if (axis != "x" && axis != "y" && axis != "z") {
    throw InputError(Place{}, fmt::format("tool_axis '{}' is none of x, y, z, -x, -y, -z", name));
  }
  // Columns: the axes of C in T. With C's axis number k along T's z, the next axes follow T's x and y.
  const int k = axis[0] - 'x';
  Eigen::Matrix3d R_TC = Eigen::Matrix3d::Zero();
  R_TC.col(k) = Eigen::Vector3d::UnitZ();
  R_TC.col((k + 1) % 3) = Eigen::Vector3d::UnitX();
  R_TC.col((k + 2) % 3) = Eigen::Vector3d::UnitY();
  if (!reversed) return R_TC;
  // Half a turn about the axis that follows.
  R_TC.col(k) *= -1;
  R_TC.col((k + 2) % 3) *= -1;
  return R_TC;
}

}  // namespace millpose
