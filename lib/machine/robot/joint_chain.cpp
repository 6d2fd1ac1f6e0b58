// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/joint_chain.hpp"

#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

/// Rotation by `angle` about the unit vector `axis`.
Eigen::Matrix3d About(const Eigen::Vector3d& axis, double angle) {
  const SineCosine t = SinCos(angle);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Eigen::Matrix3d::Identity() + t.sin * cross + (1 - t.cos) * cross * cross;
}

double NearestRightAngle(const std::string& text) {
  return std::round(ParseNumber(text).value_or(0) / (kPi / 2)) * (kPi / 2);
}
std::string RightAngleDigits(const std::string& text) { return ShortestNumber(NearestRightAngle(text)); }
/// "π", "−π/2", "3π/2".
std::string RightAngleName(const std::string& text) {
  const int quarters = static_cast<int>(std::round(NearestRightAngle(text) / (kPi / 2)));
  const int most = std::abs(quarters);
  const std::string sign = quarters < 0 ? "−" : "";
  if (most % 2 == 0) return fmt::format("{}{}π", sign, most == 2 ? "" : fmt::format("{}", most / 2));
  return fmt::format("{}{}π/2", sign, most == 1 ? "" : fmt::format("{}", most));
}

class Finder {
 public:
  explicit Finder(const UrdfModel& model) : model_(model) {
    for (const UrdfJoint& joint : model.joints) above_[joint.child] = &joint;
  }

  ChainOfLinks Find(const std::string& base, const std::string& flange) {
    CheckLink(base, "base_link");
    CheckLink(flange, "flange_link");
    ThrowProblems();
    const std::vector<const UrdfJoint*> path = PathTo(base, flange);
    ThrowProblems();
    ChainOfLinks found;
    FillChain(path, found.chain);
    for (const UrdfLink& link : model_.links) Attach(link, base, path, found);
    return found;
  }

 private:
  void Add(int line, std::string message) { problems_.push_back({{model_.file, line}, std::move(message)}); }
  void ThrowProblems() {
    if (!problems_.empty()) throw InputError(std::move(problems_));
  }

  void CheckLink(const std::string& name, const char* role) {
    std::vector<std::string> names;
    for (const UrdfLink& link : model_.links) names.push_back(link.name);
    if (std::ranges::find(names, name) != names.end()) return;
    const std::string near = NearestName(name, names);
    Add(0, fmt::format("{}: given '{}'; allowed: {}{}", role, name, fmt::join(names, ", "),
                       near.empty() ? "" : "; nearest: " + near));
  }

  /// The joint above a link; null at the root.
  const UrdfJoint* Above(const std::string& link) const {
    const auto found = above_.find(link);
    return found == above_.end() ? nullptr : found->second;
  }

  /// Joints from `base` down to `link`.
  std::vector<const UrdfJoint*> PathTo(const std::string& base, const std::string& link) {
    std::vector<const UrdfJoint*> path;
    std::string at = link;
    while (at != base) {
      const UrdfJoint* joint = Above(at);
      if (!joint || path.size() > model_.joints.size()) {
        Add(0, fmt::format("no joints lead from link '{}' to link '{}'", base, link));
        return {};
      }
      path.push_back(joint);
      at = joint->parent;
    }
    std::ranges::reverse(path);
    std::vector<std::string> moving;
    for (const UrdfJoint* joint : path)
      if (joint->type != UrdfJoint::Type::kFixed)
        moving.push_back(joint->name + (joint->mimic ? ", a mimic" : ""));
    if (moving.size() != 6)
      Add(0, fmt::format("{} joints move between '{}' and '{}' ({}); allowed: arms with six", moving.size(),
                         base, link, fmt::join(moving, ", ")));
    for (const UrdfJoint* joint : path) {
      if (joint->type == UrdfJoint::Type::kOther) {
        Add(joint->line,
            fmt::format("joint '{}': allowed between base and flange: revolute, continuous, fixed",
                        joint->name));
      }
      if (!joint->rounded_angle.empty())
        Add(joint->line,
            fmt::format(
                "joint '{}': its origin's rpy {} is a rounded {}, off by more than {} rad; write {} with all "
                "its digits",
                joint->name, joint->rounded_angle, RightAngleName(joint->rounded_angle), kRightAngleWithin,
                RightAngleDigits(joint->rounded_angle)));
      if (joint->mimic)
        Add(joint->line,
            fmt::format("joint '{}' mimics another; between base and flange each of the six must "
                        "move by itself",
                        joint->name));
    }
    return path;
  }

  static void FillChain(const std::vector<const UrdfJoint*>& path, JointChain& chain) {
    size_t count = 0;
    Pose merged = Pose::Identity();
    for (const UrdfJoint* joint : path) {
      merged = merged * joint->X_PC;
      if (joint->type == UrdfJoint::Type::kFixed) continue;
      chain.joints[count++] = {joint->name,
                               merged,
                               joint->axis,
                               joint->lower,
                               joint->upper,
                               joint->speed,
                               joint->type == UrdfJoint::Type::kRevolute};
      merged = Pose::Identity();
    }
    chain.X_LE = merged;
  }

  /// Where the child of a joint beside the chain is taken to stand.
  static Pose AtRest(const UrdfJoint& joint) {
    Pose X = joint.X_PC;
    if (joint.type != UrdfJoint::Type::kRevolute) return X;
    const Eigen::Matrix3d turned = X.linear() * About(joint.axis, std::clamp(0.0, joint.lower, joint.upper));
    X.linear() = turned;
    return X;
  }

  void WarnOfJointBeside(const UrdfJoint& joint, std::vector<std::string>& warnings) {
    if (!beside_.insert(joint.name).second) return;
    warnings.push_back(
        fmt::format("{}: joint '{}'{} moves link '{}' off the chain from base to flange: the link is "
                    "taken as fixed to '{}', and where it moves to is not checked",
                    ToString({model_.file, joint.line}), joint.name, joint.mimic ? " (mimic)" : "",
                    joint.child, joint.parent));
  }

  /// Follows joints from a link up to the chain (or to the base's root); those beside the chain stand still.
  void Attach(const UrdfLink& link, const std::string& base, const std::vector<const UrdfJoint*>& path,
              ChainOfLinks& found) {
    AttachedLink attached{link, 0, Pose::Identity()};
    std::string at = link.name;
    for (size_t steps = 0; at != base && steps <= model_.joints.size(); ++steps) {
      const UrdfJoint* joint = Above(at);
      if (!joint) {  // what carries the base stands still with it
        attached.X_ML = RootOf(base).inverse(Eigen::Isometry) * attached.X_ML;
        break;
      }
      if (joint->type != UrdfJoint::Type::kFixed) {
        attached.moves_with = Number(joint, path);
        if (attached.moves_with > 0) break;
        WarnOfJointBeside(*joint, found.warnings);
      }
      attached.X_ML = AtRest(*joint) * attached.X_ML;
      at = joint->parent;
    }
    found.links.push_back(attached);
  }

  /// Which of the chain's moving joints it is, from 1; 0: none.
  static int Number(const UrdfJoint* joint, const std::vector<const UrdfJoint*>& path) {
    int number = 0;
    for (const UrdfJoint* other : path) {
      if (other->type != UrdfJoint::Type::kFixed) ++number;
      if (other == joint) return number;
    }
    return 0;
  }

  /// The base in the frame of the root that carries it.
  Pose RootOf(const std::string& base) {
    Pose X = Pose::Identity();
    std::string at = base;
    for (size_t steps = 0; steps <= model_.joints.size(); ++steps) {
      const UrdfJoint* joint = Above(at);
      if (!joint) break;
      X = AtRest(*joint) * X;
      at = joint->parent;
    }
    return X;
  }

  const UrdfModel& model_;
  std::map<std::string, const UrdfJoint*> above_;  // by child
  std::set<std::string> beside_;                   // joints that were told
  std::vector<Problem> problems_;
};

}  // namespace

ChainOfLinks FindChain(const UrdfModel& model, const std::string& base, const std::string& flange) {
  return Finder(model).Find(base, flange);
}

std::array<Pose, 8> ChainFrames(const JointChain& chain, const Joints& angles) {
  std::array<Pose, 8> frames;
  frames[0] = Pose::Identity();
  for (size_t i = 0; i < 6; ++i) {
    const JointChain::Joint& joint = chain.joints[i];
    frames[i + 1] = frames[i] * joint.X_PJ;
    const Eigen::Matrix3d turned =
        frames[i + 1].linear() * About(joint.axis, angles[static_cast<Eigen::Index>(i)]);
    frames[i + 1].linear() = turned;
  }
  frames[7] = frames[6] * chain.X_LE;
  return frames;
}

}  // namespace millpose
