// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/post.hpp"

#include "base/error.hpp"
#include "program/krl.hpp"
#include "program/linuxcnc.hpp"
#include "program/sinumerik.hpp"

namespace millpose {
namespace {

/// One line per controller.
const std::map<std::string, std::unique_ptr<Post> (*)()>& Registry() {
  static const std::map<std::string, std::unique_ptr<Post> (*)()> posts = {
      {"krl", [] { return std::unique_ptr<Post>(new KrlPost); }},
      {"linuxcnc", [] { return std::unique_ptr<Post>(new LinuxCncPost); }},
      {"sinumerik", [] { return std::unique_ptr<Post>(new SinumerikPost); }},
  };
  return posts;
}

}  // namespace

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

std::unique_ptr<Post> MakePost(const std::string& name) {
  const auto found = Registry().find(name);
  if (found != Registry().end()) return found->second();
  const std::string nearest = NearestName(name, PostNames());
  throw InputError(
      Place{}, fmt::format("there is no post named '{}'; allowed: {}{}", name, fmt::join(PostNames(), ", "),
                           nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
}

std::vector<std::string> PostNames() {
  std::vector<std::string> names;
  for (const auto& [name, make] : Registry()) names.push_back(name);
  return names;
}

}  // namespace millpose
