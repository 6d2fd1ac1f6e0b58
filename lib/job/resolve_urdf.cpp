// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/resolve_urdf.hpp"

#include <utility>

#include "base/error.hpp"
#include "base/shown.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "machine/robot/denavit_hartenberg.hpp"
#include "machine/robot/joint_chain.hpp"
#include "machine/robot/kinematics.hpp"
#include "machine/robot/make_pose.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

/// The inverse of MakePose.
PoseSettings ToSettings(const Pose& X) {
  const Eigen::Matrix3d& R = X.linear();
  const double across = std::sqrt(R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0));
  PoseSettings pose;
  pose.position = X.translation();
  if (across < 1e-12) {  // B = ±90°: A and C turn about one axis
    pose.abc = {Atan2(-R(0, 1), R(1, 1)), Atan2(-R(2, 0), across), 0};
  } else {
    pose.abc = {Atan2(R(1, 0), R(0, 0)), Atan2(-R(2, 0), across), Atan2(R(2, 1), R(2, 2))};
  }
  return pose;
}

/// The cell counts from the base and flange of what its arm is derived from; from here on, from the closed
/// form's.
void MoveToArm(const DerivedArm& derived, CellSettings& cell) {
  const Pose X_FE = derived.X_FE, X_BS = derived.X_SB.inverse(Eigen::Isometry);
  const Pose identity = Pose::Identity();
  const auto from_flange = [&](const Pose& X) { return X_FE * X; };
  if (!derived.X_SB.isApprox(identity, 0)) {
    cell.base_in_world = ToSettings(MakePose(cell.base_in_world) * derived.X_SB);
    for (BodySettings& body : cell.bodies) {
      if (body.mount == MountSettings{Mount::kLink, 0}) body.pose = ToSettings(X_BS * MakePose(body.pose));
    }
    for (ComplianceSettings& c : cell.compliances) {
      if (c.link == 0) c.pose = ToSettings(X_BS * MakePose(c.pose));
    }
  }
  if (X_FE.isApprox(identity, 0)) return;
  const auto move = [&](ToolSettings& tool) {
    tool.tip = X_FE * tool.tip;
    tool.axis = (X_FE.linear() * tool.axis).normalized();
    tool.x = (X_FE.linear() * tool.x).normalized();
    for (ComplianceSettings& c : tool.compliances) {
      if (c.link == 6) c.pose = ToSettings(from_flange(MakePose(c.pose)));
    }
  };
  move(cell.tool);
  std::ranges::for_each(cell.tools, move);
  for (BodySettings& body : cell.bodies) {
    if (body.mount == MountSettings{Mount::kLink, 6})
      body.pose = ToSettings(from_flange(MakePose(body.pose)));
  }
  for (ComplianceSettings& c : cell.compliances) {
    if (c.link == 6) c.pose = ToSettings(from_flange(MakePose(c.pose)));
  }
  if (!cell.gravity) return;
  for (MassSettings& mass : cell.gravity->masses) {
    if (mass.link == 6) mass.centre = X_FE * mass.centre;
  }
}

/// Takes lengths, signs and offsets.
void TakeLengths(const Arm& from, ArmSettings& arm) {
  arm.family = from.family;
  arm.d1 = from.d1, arm.a1 = from.a1, arm.dy = from.dy, arm.a2 = from.a2;
  arm.d4 = from.d4, arm.dz = from.dz, arm.d5 = from.d5, arm.d6 = from.d6;
  for (size_t i = 0; i < 6; ++i) arm.sign[i] = from.sign[i] < 0 ? -1 : 1;
  arm.offset = from.offset;
}

class Resolver {
 public:
  Resolver(const fs::path& folder, const FileRoot& root, CellSettings& cell)
      : cell_(cell),
        root_(root),
        urdf_(cell.arm.urdf),
        file_((folder / urdf_.file).lexically_normal().string()) {}

  void Resolve() {
    const UrdfModel model = ReadUrdf(root_.Read(file_, kMaxBytes), file_,
                                     [&](const std::string& name) { return root_.Read(name, kMaxBytes); });
    const ChainOfLinks found = FindChain(model, urdf_.base_link, urdf_.flange_link);
    derived_ = DeriveArm(found.chain, urdf_.tolerance, file_);
    FillArm(model, found.chain);
    MoveToArm(derived_, cell_);
    for (const AttachedLink& link : found.links) AddBodies(found.chain, link);
    cell_.warnings = found.warnings;
    cell_.notes = model.notes;
    const auto& joints = found.chain.joints;
    cell_.arm.joints = fmt::format("{} … {}, from {} to {} of {} (metres, radians)", joints.front().name,
                                   joints.back().name, urdf_.base_link, urdf_.flange_link, urdf_.file);
    if (!problems_.empty()) throw InputError(std::move(problems_));
    cell_.arm.urdf = {};
  }

 private:
  static constexpr size_t kMaxBytes = size_t{16} << 20;

  void AddToCell(std::string message) {
    problems_.push_back({{cell_.file, urdf_.line}, "arm.urdf: " + std::move(message)});
  }

  // A joint that turns more often than cables bear is one whose limits were given in degrees.
  void CheckLimits(const UrdfModel& model, const JointChain::Joint& joint) {
    constexpr double kMost = 4 * kPi;
    if (!joint.limited || (joint.lower >= -kMost && joint.upper <= kMost)) return;
    const auto of_name = std::ranges::find(model.joints, joint.name, &UrdfJoint::name);
    problems_.push_back(
        {{file_, of_name->line},
         fmt::format("joint '{}': limits {} to {} rad are {:.3g} revolutions; allowed: within ±{:.4g} rad "
                     "(±720°); are they given in degrees? URDF has radians",
                     Shown(joint.name), joint.lower, joint.upper, (joint.upper - joint.lower) / (2 * kPi),
                     kMost)});
  }

  void FillArm(const UrdfModel& model, const JointChain& chain) {
    ArmSettings& arm = cell_.arm;
    const Arm& from = derived_.arm;
    TakeLengths(from, arm);
    arm.deviation = derived_.deviation;
    const bool own_limits = arm.lower != arm.upper, own_speeds = !arm.speed.isZero(0.0);
    for (const JointChain::Joint& joint : chain.joints) {
      if (!own_limits) CheckLimits(model, joint);
      if (!own_limits && !joint.limited) {
        AddToCell(fmt::format("joint '{}' is continuous, without limits; give arm.limits_deg", joint.name));
      }
      if (!own_speeds && joint.speed <= 0) {
        AddToCell(fmt::format("joint '{}' has no velocity; give arm.speeds_deg_s", joint.name));
      }
    }
    if (!own_limits) {
      arm.lower = from.lower;
      arm.upper = from.upper;
    }
    if (!own_speeds) arm.speed = from.speed;
    if (arm.limits_source.empty()) arm.limits_source = urdf_.file;
  }

  void AddBodies(const JointChain& chain, const AttachedLink& attached) {
    // The link's frame in the closed form's, both at joint angles 0.
    const size_t k = static_cast<size_t>(attached.moves_with);
    const Pose X_BL = LinkFrames(derived_.arm, Joints::Zero())[k];
    const Pose X_ModelLink = (derived_.X_SB * X_BL).inverse(Eigen::Isometry) *
                             ChainFrames(chain, Joints::Zero())[k] * attached.X_ML;
    const std::vector<UrdfShape>& shapes = attached.link.collisions;
    for (size_t i = 0; i < shapes.size(); ++i) {
      BodySettings body;
      body.name = attached.link.name + (i == 0 ? "" : fmt::format("_{}", i + 1));
      body.body_class = BodyClass::kLink;
      body.from_urdf = true;
      body.mount = {Mount::kLink, static_cast<int>(k)};
      body.pose = ToSettings(X_ModelLink * shapes[i].X_LG);
      if (FillShape(shapes[i], body.shape)) cell_.bodies.push_back(std::move(body));
    }
  }

  bool FillShape(const UrdfShape& shape, ShapeSettings& settings) {
    settings.size = shape.size;
    settings.diameter = 2 * shape.radius;
    settings.length = shape.length;
    switch (shape.kind) {
      case UrdfShape::Kind::kBox:
        settings.kind = ShapeKind::kBox;
        return true;
      case UrdfShape::Kind::kCylinder:
        settings.kind = ShapeKind::kCylinder;
        return true;
      case UrdfShape::Kind::kSphere:
        settings.kind = ShapeKind::kSphere;
        return true;
      case UrdfShape::Kind::kMesh:
        break;
    }
    settings.kind = ShapeKind::kMesh;
    return FindUnit(shape, settings) && FindMesh(shape, settings);
  }

  bool FindUnit(const UrdfShape& shape, ShapeSettings& settings) {
    for (const double unit : {1.0, 10.0, 25.4, 1000.0}) {
      if ((shape.scale * 1000 - Eigen::Vector3d::Constant(unit)).cwiseAbs().maxCoeff() > 1e-9) continue;
      settings.unit = unit;
      return true;
    }
    problems_.push_back(
        {{file_, shape.line},
         fmt::format("mesh scale {} {} {}; allowed: 1 (metres), 0.001 (mm), 0.01 (cm), 0.0254 "
                     "(inches), alike on all axes",
                     shape.scale.x(), shape.scale.y(), shape.scale.z())});
    return false;
  }

  bool FindMesh(const UrdfShape& shape, ShapeSettings& settings) {
    std::string name = shape.mesh_file;
    fs::path start = fs::path(urdf_.file).parent_path();
    if (name.starts_with("file://")) name = name.substr(7);
    if (constexpr std::string_view kPackage = "package://"; name.starts_with(kPackage)) {
      const size_t slash = std::min(name.find('/', kPackage.size()), name.size());
      const std::string package = name.substr(kPackage.size(), slash - kPackage.size());
      const auto found = urdf_.packages.find(package);
      if (found == urdf_.packages.end()) {
        problems_.push_back(
            {{file_, shape.line},
             fmt::format(
                 "mesh {}: no folder is known for the package; give arm.urdf.packages: {{{}: FOLDER}}", name,
                 package)});
        return false;
      }
      start = found->second;
      name = slash < name.size() ? name.substr(slash + 1) : "";
    }
    settings.mesh_file = (start / name).lexically_normal().string();
    return true;
  }

  CellSettings& cell_;
  const FileRoot& root_;
  const UrdfSettings urdf_;
  std::string file_;
  DerivedArm derived_;
  std::vector<Problem> problems_;
};

/// Replaces a table after Denavit and Hartenberg by the arm that it gives.
void ResolveTable(CellSettings& cell) {
  const DhSettings table = std::exchange(cell.arm.dh, {});
  std::array<DhRow, 6> rows;
  std::ranges::copy(table.rows, rows.begin());
  try {
    const DerivedArm derived =
        DeriveArm(ChainOf(rows, table.convention), table.tolerance, cell.file, "arm.dh.tolerance_mm");
    TakeLengths(derived.arm, cell.arm);
    cell.arm.deviation = derived.deviation;
    MoveToArm(derived, cell);
  } catch (const InputError& error) {
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      problem.place.line = table.line;
      problem.message = "arm.dh: " + problem.message;
    }
    throw InputError(std::move(problems));
  }
}

}  // namespace

void ResolveUrdf(const std::filesystem::path& folder, const FileRoot& root, CellSettings* cell) {
  if (!cell->arm.urdf.file.empty()) Resolver(folder, root, *cell).Resolve();
  if (!cell->arm.dh.rows.empty()) ResolveTable(*cell);
}

}  // namespace millpose
