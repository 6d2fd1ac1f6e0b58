// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/mesh/point_fit.hpp"
#include "job/assemble.hpp"
#include "job/raw_stock.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/make_pose.hpp"
#include "program/controller_axes.hpp"

namespace millpose {
namespace {

Shape MakeShape(const ShapeSettings& settings, const std::map<std::string, std::string>& body_bytes) {
  const double radius = settings.diameter / 2, top_radius = settings.top_diameter / 2;
  switch (settings.kind) {
    case ShapeKind::kBox:
      return Box{settings.size};
    case ShapeKind::kSphere:
      return Sphere{radius};
    case ShapeKind::kCylinder:
      return Cylinder{radius, settings.length};
    case ShapeKind::kCapsule:
      return Capsule{radius, settings.length};
    case ShapeKind::kCone:
      return Cone{radius, top_radius, settings.length};
    case ShapeKind::kConvex:
      return Convex{settings.points};
    case ShapeKind::kMesh:
      break;
  }
  ImportOptions options;
  options.unit = settings.unit;
  return ImportMesh(ReadMesh(body_bytes.at(settings.mesh_file), settings.mesh_file), options,
                    settings.mesh_file)
      .mesh.triangles();
}

// The stack of cutter, holder and spindle as bodies about T's z, from the tip upwards; X_TS: where the tool
// stands in the tool frame of the cell.
std::vector<Body> BodiesOf(const ToolSettings& tool, const Pose& X_TS) {
  std::vector<Body> bodies;
  double height = 0;
  for (const ToolPartSettings& part : tool.stack) {
    Body& body = bodies.emplace_back();
    body.name = part.name;
    body.body_class = part.body_class;
    body.mount = Mount::kTool;
    body.X_MG = X_TS * Eigen::Translation3d(0, 0, height + part.length / 2);
    if (part.top_diameter == part.diameter)
      body.shape = Cylinder{part.diameter / 2, part.length};
    else
      body.shape = Cone{part.diameter / 2, part.top_diameter / 2, part.length};
    height += part.length;
  }
  return bodies;
}

bool Holds(const ToolSettings& tool, const std::string& body) {
  return std::ranges::find(tool.stack, body, &ToolPartSettings::name) != tool.stack.end();
}

// The pairs of the cell whose bodies are there: one may name a part of a tool that is not in the spindle.
std::vector<std::pair<std::string, std::string>> PairsOf(const CellSettings& cell) {
  const auto away = [&](const std::string& body) {
    return !Holds(cell.tool, body) &&
           std::ranges::any_of(cell.tools, [&](const ToolSettings& tool) { return Holds(tool, body); });
  };
  std::vector<std::pair<std::string, std::string>> pairs = cell.excluded_pairs;
  std::erase_if(pairs, [&](const auto& pair) { return away(pair.first) || away(pair.second); });
  return pairs;
}

}  // namespace

Pose MakeToolPose(const ToolSettings& tool) {
  const Eigen::Vector3d z = tool.axis.normalized();
  const Eigen::Vector3d x = (tool.x - tool.x.dot(z) * z).normalized();
  Pose X_FT = Pose::Identity();
  X_FT.linear().col(0) = x;
  X_FT.linear().col(1) = z.cross(x);
  X_FT.linear().col(2) = z;
  X_FT.translation() = tool.tip;
  return X_FT;
}

Arm MakeArm(const ArmSettings& settings) {
  Arm arm;
  arm.name = settings.name;
  arm.d1 = settings.d1;
  arm.family = settings.family;
  arm.a1 = settings.a1;
  arm.dy = settings.dy;
  arm.a2 = settings.a2;
  arm.d4 = settings.d4;
  arm.dz = settings.dz;
  arm.d5 = settings.d5;
  arm.d6 = settings.d6;
  for (size_t i = 0; i < 6; ++i) arm.sign[i] = settings.sign[i];
  arm.offset = settings.offset;
  arm.lower = settings.lower;
  arm.upper = settings.upper;
  arm.coupled_limits = settings.coupled_limits;
  arm.speed = settings.speed;
  arm.acceleration = settings.acceleration;
  arm.acceleration_assumed = settings.acceleration_assumed;
  arm.stiffness = settings.stiffness;
  return arm;
}

ArmDeviations MakeDeviations(const DeviationSettings& settings) {
  ArmDeviations deviations;
  for (size_t i = 0; i < deviations.shift.size(); ++i) {
    deviations.shift[i] = settings.shifts[i];
    deviations.turn[i] = settings.turns[i];
  }
  deviations.law = {settings.gears, settings.couplings};
  return deviations;
}

std::vector<ArmDeviations> MakePatterns(const DeviationSettings& settings) {
  std::vector<ArmDeviations> patterns;
  for (const DeviationPattern& pattern : settings.patterns) {
    ArmDeviations& made = patterns.emplace_back();
    std::ranges::copy(pattern.shifts, made.shift.begin());
    std::ranges::copy(pattern.turns, made.turn.begin());
    for (size_t k = 0; k < pattern.factors.size(); ++k)
      made.law.couplings.push_back(
          {settings.couplings[k].joint, settings.couplings[k].follows, pattern.factors[k]});
  }
  return patterns;
}

Cell MakeCell(const CellSettings& settings, const std::map<std::string, std::string>& body_bytes) {
  Cell cell;
  cell.name = settings.name;
  cell.arm = MakeArm(settings.arm);
  cell.external_axes.assign(settings.external_axes.begin(), settings.external_axes.end());
  cell.X_WB = MakePose(settings.base_in_world);
  cell.X_FT = MakeToolPose(settings.tool);
  cell.home = settings.home;
  cell.excluded_pairs = PairsOf(settings);
  cell.clearances = {settings.clearance_free, settings.clearance_cutting};
  cell.bodies = BodiesOf(settings.tool, Pose::Identity());
  cell.cutter_length = settings.tool.cutting_length;
  for (const BodySettings& body_settings : settings.bodies) {
    Body body;
    body.name = body_settings.name;
    body.body_class = body_settings.body_class;
    body.mount = body_settings.mount.mount;
    body.link = body_settings.mount.link;
    const auto axis = std::ranges::find(cell.external_axes, body_settings.axis, &ExternalAxis::name);
    if (body.mount == Mount::kCarriage) body.axis = static_cast<int>(axis - cell.external_axes.begin());
    body.X_MG = MakePose(body_settings.pose);
    body.shape = MakeShape(body_settings.shape, body_bytes);
    cell.bodies.push_back(std::move(body));
  }
  return cell;
}

Body MakeKeepOut(const KeepOutSettings& settings, const std::map<std::string, std::string>& mesh_bytes) {
  Body body;
  body.name = settings.name;
  body.X_MG = MakePose(settings.pose);
  body.shape = MakeShape(settings.shape, mesh_bytes);
  return body;
}

Cell WithAllTools(Cell cell, const CellSettings& settings) {
  for (const ToolSettings& tool : settings.tools) {
    if (tool.name == settings.tool.name) continue;
    for (Body& body : BodiesOf(tool, cell.X_FT.inverse() * MakeToolPose(tool))) {
      const std::string name = tool.name + "'s " + body.name;
      for (const auto& [first, second] : settings.excluded_pairs) {
        if (first == body.name) cell.excluded_pairs.emplace_back(name, second);
        if (second == body.name) cell.excluded_pairs.emplace_back(first, name);
      }
      body.name = name;
      cell.bodies.push_back(std::move(body));
    }
  }
  return cell;
}

namespace {

Pose FitTargets(const WorkpieceSettings& settings) {
  std::vector<Eigen::Vector3d> nominal, measured;
  for (const TargetSettings& target : settings.targets) {
    nominal.push_back(target.nominal);
    measured.push_back(target.measured);
  }
  const std::optional<PointFit> fit = FitPoints(nominal, measured);
  if (!fit)
    throw InputError({},
                     "workpiece.targets: the points lie on a line, so the rotation about it is not known");
  if (fit->largest > settings.max_residual) {
    std::string residuals;
    for (const double residual : fit->residuals)
      residuals += fmt::format("{}{:.3f}", residuals.empty() ? "" : ", ", residual);
    throw InputError(
        {}, fmt::format("workpiece.targets: the best fit leaves residuals of {} mm (RMS {:.3f}); allowed: "
                        "at most max_residual_mm, {}",
                        residuals, fit->rms, settings.max_residual));
  }
  return fit->X;
}

}  // namespace

StepOptions MakeStepOptions(const WorkpieceSettings& workpiece) {
  return {workpiece.chord_tolerance, workpiece.step_memory, workpiece.step_seconds};
}

double AllowanceOf(const JobSettings& job) {
  // What stands of a raw part is known better than that.
  return job.workpiece.allowance.value_or(job.workpiece.HasStock() ? 0 : job.toolpath.layers.total);
}

void AddWorkpiece(const JobInputs& inputs, Triangles finished, Cell* cell) {
  cell->allowance = AllowanceOf(inputs.job);
  if (!finished.faces.empty())
    cell->bodies.push_back({.name = "workpiece",
                            .body_class = BodyClass::kWorkpiece,
                            .mount = Mount::kWorkpiece,
                            .shape = std::move(finished)});
  if (Triangles stock = RawStock(inputs); !stock.faces.empty())
    cell->bodies.push_back({.name = "stock",
                            .body_class = BodyClass::kStock,
                            .mount = Mount::kWorkpiece,
                            .shape = std::move(stock)});
  for (const FixtureSettings& fixture : inputs.job.workpiece.fixtures)
    cell->bodies.push_back({.name = fixture.name,
                            .mount = fixture.mount,
                            .X_MG = MakePose(fixture.pose),
                            .shape = MakeShape(fixture.shape, inputs.fixture_bytes)});
}

Pose MakeWorkpiecePose(const WorkpieceSettings& settings, const Pose& X_WB) {
  const Pose pose = settings.targets.empty() ? MakePose(settings.pose) : FitTargets(settings);
  return settings.frame == GivenFrame::kRobotBase ? X_WB * pose : pose;
}

Cell MakeJobCell(const JobInputs& inputs) {
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  cell.X_WP = MakeWorkpiecePose(inputs.job.workpiece, cell.X_WB);
  AddWorkpiece(inputs, ReadPart(inputs, cell).import.mesh.triangles(), &cell);
  return cell;
}

}  // namespace millpose
