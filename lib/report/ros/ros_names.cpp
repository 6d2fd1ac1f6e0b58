// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/ros_names.hpp"

#include <set>

namespace millpose {
namespace {

/// What programs of ROS take for a name and file systems for a file's.
std::string Cleaned(const std::string& name) {
  constexpr size_t kLongest = 100;
  std::string clean;
  for (const char c : name.substr(0, kLongest)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-' || c == '.';
    clean += plain ? c : '_';
  }
  if (clean.empty() || clean.front() == '.' || clean.front() == '-') clean.insert(0, "_");
  return clean;
}

/// Hands out names, each once.
class Names {
 public:
  std::string Take(const std::string& wanted) {
    const std::string clean = Cleaned(wanted);
    std::string name = clean;
    for (int i = 2; !taken_.insert(name).second; ++i) name = fmt::format("{}_{}", clean, i);
    return name;
  }

 private:
  std::set<std::string> taken_;
};

}  // namespace

RosNames NamesFor(const Cell& cell) {
  RosNames names;
  names.cell = Cleaned(cell.name);
  Names links, joints;
  for (const char* frame : {kRosWorld, kRosBase, kRosFlange, kRosTip, kRosPart}) links.Take(frame);
  for (size_t i = 0; i < 6; ++i) {
    names.links[i] = links.Take(fmt::format("link_{}", i + 1));
    names.joints.push_back(joints.Take(fmt::format("joint_{}", i + 1)));
  }
  for (const ExternalAxis& axis : cell.external_axes) {
    names.joints.push_back(joints.Take(axis.name));
    names.carriages.push_back(links.Take(axis.name + "_carriage"));
  }
  for (const Body& body : cell.bodies) names.bodies.push_back(links.Take(body.name));
  return names;
}

}  // namespace millpose
