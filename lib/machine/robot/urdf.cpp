// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/urdf.hpp"

#include <tinyxml2.h>

#include <cstring>
#include <map>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/robot/xacro.hpp"

namespace millpose {
namespace {

using tinyxml2::XMLElement;

constexpr double kMmPerMetre = 1000;
constexpr size_t kMostLinks = 1000, kMostShapes = 1000;  // an arm has a dozen

/// Rz(yaw)·Ry(pitch)·Rx(roll).
Eigen::Matrix3d RollPitchYaw(const Eigen::Vector3d& rpy) {
  const SineCosine r = SinCos(rpy[0]), p = SinCos(rpy[1]), y = SinCos(rpy[2]);
  Eigen::Matrix3d R;
  R << y.cos * p.cos, y.cos * p.sin * r.sin - y.sin * r.cos, y.cos * p.sin * r.cos + y.sin * r.sin,  //
      y.sin * p.cos, y.sin * p.sin * r.sin + y.cos * r.cos, y.sin * p.sin * r.cos - y.cos * r.sin,   //
      -p.sin, p.cos * r.sin, p.cos * r.cos;
  return R;
}

/// Decimals of a plain number; those of one with an exponent count as many.
size_t Decimals(std::string_view text) {
  if (text.find_first_of("eE") != std::string_view::npos) return 17;
  const size_t point = text.find('.');
  if (point == std::string_view::npos) return 0;
  const size_t last = text.find_last_not_of('0');
  return last > point ? last - point : 0;
}

/// What a number of a joint's rpy is taken for.
struct SnappedAngle {
  double angle = 0;
  bool noted = false;    ///< it differs from what is written by more than its last digits
  bool rounded = false;  ///< a right angle rounded so far that nobody can tell
};

/// Quarter turns other than 0, written as rounding or cutting off leaves them. With few digits anything near
/// counts as that; with many an angle that is off was measured.
SnappedAngle Snap(double angle, std::string_view text) {
  constexpr size_t kFewDecimals = 5, kTwo = 2;
  const double right = std::round(angle / (kPi / 2)) * (kPi / 2), off = std::abs(angle - right);
  const size_t decimals = Decimals(text);
  double unit = 1;  // of the last digit
  for (size_t i = 0; i < decimals; ++i) unit /= 10;
  // Rounded or cut off.
  const bool digits_of_it =
      off <= unit * (0.5 + 1e-9) || (std::abs(angle) < std::abs(right) && off < unit * (1 + 1e-9));
  if (right == 0 || off == 0) return {angle};
  if (off <= kRightAngleWithin && (decimals <= kFewDecimals || digits_of_it)) return {right, off > 1e-6};
  return {angle, false, decimals >= kTwo && decimals <= kFewDecimals && digits_of_it};
}

class Reader {
 public:
  explicit Reader(std::string file) { model_.file = std::move(file); }

  UrdfModel Read(std::string_view bytes, const XacroInclude& include) {
    tinyxml2::XMLDocument document;
    if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
      Add(document.ErrorLineNum(), fmt::format("not XML: {}", document.ErrorName()));
    } else {
      if (IsXacro(document)) ExpandXacro(document, model_.file, include);
      ReadDocument(document);
    }
    if (!problems_.empty()) throw InputError(std::move(problems_));
    for (const auto& [text, lines] : snapped_)
      model_.notes.push_back(fmt::format("{}: {} of joints taken for a right angle ({} {})", model_.file,
                                         text, lines.size() == 1 ? "line" : "lines", fmt::join(lines, ", ")));
    return std::move(model_);
  }

 private:
  void Add(int line, std::string message) { problems_.push_back({{model_.file, line}, std::move(message)}); }

  void ReadDocument(const tinyxml2::XMLDocument& document) {
    const XMLElement* robot = document.FirstChildElement("robot");
    if (robot)
      ReadRobot(*robot);
    else
      Add(1, "there is no element <robot>");
  }

  void ReadRobot(const XMLElement& robot) {
    model_.name = Attribute(robot, "name");
    for (const XMLElement* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
      ReadLink(*e);
      if (Exceeds(model_.links.size(), kMostLinks, "links", e->GetLineNum())) return;
    }
    for (const XMLElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
      ReadJoint(*e);
      if (Exceeds(model_.joints.size(), kMostLinks, "joints", e->GetLineNum())) return;
    }
    CheckNames();
  }

  std::string Attribute(const XMLElement& element, const char* name) {
    const char* text = element.Attribute(name);
    if (!text || !*text) Add(element.GetLineNum(), fmt::format("<{}> lacks {}", element.Name(), name));
    return text ? text : "";
  }

  std::optional<double> Number(const XMLElement& element, const char* name, std::string_view text) {
    std::string_view digits = text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const std::optional<double> number = ParseNumber(digits);
    if (!number || std::abs(*number) > 1e5) {
      Add(element.GetLineNum(),
          fmt::format("<{}> {}: given '{}'; allowed: a number within ±1e5", element.Name(), name, text));
      return std::nullopt;
    }
    return number;
  }

  /// A number that must be given and positive.
  double Positive(const XMLElement& element, const char* name) {
    const double value = Number(element, name, Attribute(element, name)).value_or(1);
    if (value <= 0) {
      Add(element.GetLineNum(), fmt::format("<{}> {}: given {}; allowed: > 0", element.Name(), name, value));
    }
    return value;
  }

  static std::vector<std::string_view> Words(std::string_view all) {
    std::vector<std::string_view> words;
    for (size_t begin = 0; begin < all.size();) {
      begin = all.find_first_not_of(" \t\r\n", begin);
      if (begin == std::string_view::npos) break;
      const size_t end = std::min(all.find_first_of(" \t\r\n", begin), all.size());
      words.push_back(all.substr(begin, end - begin));
      begin = end;
    }
    return words;
  }

  Eigen::Vector3d Triple(const XMLElement& element, const char* name, const Eigen::Vector3d& otherwise) {
    const char* text = element.Attribute(name);
    if (!text) return otherwise;
    std::vector<double> numbers;
    for (const std::string_view word : Words(text)) {
      const std::optional<double> number = Number(element, name, word);
      if (!number) return otherwise;
      numbers.push_back(*number);
    }
    if (numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
    Add(element.GetLineNum(),
        fmt::format("<{}> {}: given '{}'; allowed: three numbers", element.Name(), name, text));
    return otherwise;
  }

  /// Of a collision shape, or of a `joint`, whose right angles are snapped.
  Pose Origin(const XMLElement& parent, UrdfJoint* joint = nullptr) {
    Pose X = Pose::Identity();
    if (const XMLElement* origin = parent.FirstChildElement("origin")) {
      X.translation() = kMmPerMetre * Triple(*origin, "xyz", Eigen::Vector3d::Zero());
      Eigen::Vector3d rpy = Triple(*origin, "rpy", Eigen::Vector3d::Zero());
      if (joint) SnapAngles(*origin, rpy, *joint);
      X.linear() = RollPitchYaw(rpy);
    }
    return X;
  }

  void SnapAngles(const XMLElement& origin, Eigen::Vector3d& rpy, UrdfJoint& joint) {
    const char* text = origin.Attribute("rpy");
    if (!text) return;
    const std::vector<std::string_view> words = Words(text);
    if (words.size() != 3) return;  // reported already
    for (size_t i = 0; i < 3; ++i) {
      double& angle = rpy[static_cast<Eigen::Index>(i)];
      const SnappedAngle snapped = Snap(angle, words[i]);
      angle = snapped.angle;
      const size_t sign = words[i].find_first_not_of("+-");
      if (snapped.noted) snapped_[std::string(words[i].substr(sign))].insert(origin.GetLineNum());
      if (snapped.rounded) joint.rounded_angle = words[i].substr(words[i].starts_with('+') ? 1 : 0);
    }
  }

  void ReadLink(const XMLElement& element) {
    UrdfLink link{Attribute(element, "name"), element.GetLineNum(), {}};
    for (const XMLElement* e = element.FirstChildElement("collision"); e;
         e = e->NextSiblingElement("collision")) {
      ReadCollision(*e, link);
      if (Exceeds(++shapes_, kMostShapes, "collision shapes", e->GetLineNum())) break;
    }
    model_.links.push_back(std::move(link));
  }

  void ReadCollision(const XMLElement& element, UrdfLink& link) {
    UrdfShape shape;
    shape.line = element.GetLineNum();
    if (const char* name = element.Attribute("name")) shape.name = name;
    shape.X_LG = Origin(element);
    const XMLElement* geometry = element.FirstChildElement("geometry");
    const XMLElement* kind = geometry ? geometry->FirstChildElement() : nullptr;
    if (!kind) return Add(shape.line, "<collision> lacks <geometry> with a shape");
    const std::string name = kind->Name();
    if (name == "box") {
      shape.kind = UrdfShape::Kind::kBox;
      shape.size = kMmPerMetre * Triple(*kind, "size", Eigen::Vector3d::Zero());
      if (shape.size.minCoeff() <= 0) {
        Add(kind->GetLineNum(), "<box> size: allowed: three numbers > 0");
      }
    } else if (name == "cylinder" || name == "sphere") {
      shape.kind = name == "sphere" ? UrdfShape::Kind::kSphere : UrdfShape::Kind::kCylinder;
      shape.radius = kMmPerMetre * Positive(*kind, "radius");
      if (name == "cylinder") shape.length = kMmPerMetre * Positive(*kind, "length");
    } else if (name == "mesh") {
      shape.kind = UrdfShape::Kind::kMesh;
      shape.mesh_file = Attribute(*kind, "filename");
      shape.scale = Triple(*kind, "scale", Eigen::Vector3d::Ones());
    } else {
      return Add(kind->GetLineNum(),
                 fmt::format("<geometry>: given <{}>; allowed: box, cylinder, sphere, mesh", name));
    }
    link.collisions.push_back(std::move(shape));
  }

  void ReadJoint(const XMLElement& element) {
    UrdfJoint joint;
    joint.name = Attribute(element, "name");
    joint.line = element.GetLineNum();
    joint.X_PC = Origin(element, &joint);
    const std::string type = Attribute(element, "type");
    joint.type = type == "fixed"        ? UrdfJoint::Type::kFixed
                 : type == "revolute"   ? UrdfJoint::Type::kRevolute
                 : type == "continuous" ? UrdfJoint::Type::kContinuous
                                        : UrdfJoint::Type::kOther;
    for (const auto& [tag, name] : {std::pair("parent", &joint.parent), std::pair("child", &joint.child)}) {
      const XMLElement* end = element.FirstChildElement(tag);
      if (!end) Add(joint.line, fmt::format("joint '{}' lacks <{}>", joint.name, tag));
      if (end) *name = Attribute(*end, "link");
    }
    joint.mimic = element.FirstChildElement("mimic") != nullptr;
    const XMLElement* axis = element.FirstChildElement("axis");
    if (axis && joint.type != UrdfJoint::Type::kFixed) {  // exporters write 0 0 0 for fixed joints
      joint.axis = Triple(*axis, "xyz", joint.axis);
      if (joint.axis.norm() < 1e-6) Add(axis->GetLineNum(), "<axis> xyz: allowed: not all zero");
      joint.axis.normalize();
    }
    ReadLimit(element, joint);
    model_.joints.push_back(std::move(joint));
  }

  void ReadLimit(const XMLElement& element, UrdfJoint& joint) {
    const XMLElement* limit = element.FirstChildElement("limit");
    if (!limit) {
      if (joint.type == UrdfJoint::Type::kRevolute) {
        Add(joint.line, fmt::format("joint '{}' is revolute and lacks <limit>", joint.name));
      }
      return;
    }
    const auto number = [&](const char* name) {
      const char* text = limit->Attribute(name);
      return text ? Number(*limit, name, text).value_or(0) : 0.0;
    };
    joint.lower = number("lower");
    joint.upper = number("upper");
    joint.speed = number("velocity");
    if (joint.type == UrdfJoint::Type::kRevolute && joint.lower >= joint.upper) {
      Add(limit->GetLineNum(),
          fmt::format("joint '{}': lower {} must be below upper {}", joint.name, joint.lower, joint.upper));
    }
    if (joint.speed < 0) Add(limit->GetLineNum(), fmt::format("joint '{}': velocity below 0", joint.name));
  }

  void CheckNames() {
    std::vector<std::string> links;
    std::set<std::string> seen;
    for (const UrdfLink& link : model_.links) {
      links.push_back(link.name);
      if (!seen.insert(link.name).second) Add(link.line, fmt::format("two links '{}'", link.name));
    }
    std::set<std::string> joints, children;
    for (const UrdfJoint& joint : model_.joints) {
      if (!joints.insert(joint.name).second) Add(joint.line, fmt::format("two joints '{}'", joint.name));
      for (const std::string& end : {joint.parent, joint.child}) {
        if (end.empty() || seen.contains(end)) continue;
        const std::string near = NearestName(end, links);
        Add(joint.line, fmt::format("joint '{}': there is no link '{}'{}", joint.name, end,
                                    near.empty() ? "" : fmt::format("; nearest: {}", near)));
      }
      if (!joint.child.empty() && !children.insert(joint.child).second) {
        Add(joint.line, fmt::format("link '{}' is the child of two joints", joint.child));
      }
    }
  }

  bool Exceeds(size_t count, size_t most, const char* what, int line) {
    if (count <= most) return false;
    Add(line, fmt::format("more than {} {}; allowed: at most {}", most, what, most));
    return true;
  }

  UrdfModel model_;
  std::map<std::string, std::set<int>> snapped_;  // angles as written, and their lines
  size_t shapes_ = 0;
  std::vector<Problem> problems_;
};

}  // namespace

UrdfModel ReadUrdf(std::string_view bytes, const std::string& file, const XacroInclude& include) {
  return Reader(file).Read(bytes, include);
}

}  // namespace millpose
