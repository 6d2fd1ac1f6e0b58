// SPDX-License-Identifier: GPL-3.0-or-later
// The joints of a URDF, picked out of its text.
#include <regex>
#include <sstream>

#include "tests/audit/folder.hpp"

namespace millpose::audit {
namespace {

std::string AttributeOf(const std::string& text, const std::string& element, const std::string& name) {
  std::smatch match;
  const std::regex pattern("<" + element + "\\b[^>]*\\b" + name + "\\s*=\\s*[\"']([^\"']*)[\"']");
  return std::regex_search(text, match, pattern) ? match[1].str() : std::string();
}

Vector3 TripleOf(const std::string& text, const Vector3& otherwise) {
  if (text.empty()) return otherwise;
  std::istringstream words(text);
  Vector3 v;
  words >> v[0] >> v[1] >> v[2];
  return v;
}

}  // namespace

UrdfArm ReadUrdf(const std::string& xml, const std::string& base, const std::string& flange) {
  static const std::regex comment("<!--[\\s\\S]*?-->"), block("<joint\\b[^>]*\\btype[\\s\\S]*?</joint>");
  const std::string text = std::regex_replace(xml, comment, "");
  std::map<std::string, std::string> above;  // child link → its joint
  for (std::sregex_iterator it(text.begin(), text.end(), block), end; it != end; ++it)
    above[AttributeOf(it->str(), "child", "link")] = it->str();
  UrdfArm arm;
  for (std::string link = flange; link != base;) {
    const auto found = above.find(link);
    if (found == above.end()) throw std::runtime_error("URDF: nothing leads to link " + link);
    const std::string& joint = found->second;
    const Vector3 xyz = 1000 * TripleOf(AttributeOf(joint, "origin", "xyz"), Vector3::Zero());
    const Vector3 rpy = TripleOf(AttributeOf(joint, "origin", "rpy"), Vector3::Zero());
    const Vector3 axis = TripleOf(AttributeOf(joint, "axis", "xyz"), Vector3::UnitX());
    const bool fixed = AttributeOf(joint, "joint", "type") == "fixed";
    arm.joints.insert(arm.joints.begin(),
                      {Shift(xyz[0], xyz[1], xyz[2]) * Turn(2, rpy[2]) * Turn(1, rpy[1]) * Turn(0, rpy[0]),
                       fixed ? Vector3(Vector3::Zero()) : Vector3(axis.normalized())});
    link = AttributeOf(joint, "parent", "link");
  }
  return arm;
}

}  // namespace millpose::audit
