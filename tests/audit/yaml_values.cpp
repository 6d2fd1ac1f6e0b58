// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/yaml_values.hpp"

#include "audit/tessellate.hpp"

namespace millpose::audit {
namespace {

std::vector<Real> List(const YAML::Node& node) {
  std::vector<Real> numbers;
  for (const auto& entry : node) numbers.push_back(entry.as<double>());
  return numbers;
}

}  // namespace

Vector3 Triple(const YAML::Node& node) {
  const std::vector<Real> list = List(node);
  if (list.size() != 3) throw std::runtime_error("three numbers expected in YAML");
  return {list[0], list[1], list[2]};
}

Angles Six(const YAML::Node& node, Real unit) {
  const std::vector<Real> list = List(node);
  if (list.size() != 6) throw std::runtime_error("six numbers expected in YAML");
  Angles angles;
  for (size_t i = 0; i < 6; ++i) angles[i] = list[i] * unit;
  return angles;
}

Matrix4 PoseOf(const YAML::Node& node) {
  Vector3 xyz = Vector3::Zero(), abc = Vector3::Zero();
  if (node && node["xyz_mm"]) xyz = Triple(node["xyz_mm"]);
  if (node && node["abc_deg"]) abc = Triple(node["abc_deg"]);
  return FrameXyzAbc(xyz[0], xyz[1], xyz[2], abc[0], abc[1], abc[2]);
}

Real UnitOf(const std::string& name) {
  static const std::map<std::string, Real> units = {{"mm", 1}, {"cm", 10}, {"in", 25.4L}, {"m", 1000}};
  return units.at(name);
}

YAML::Node ToolOf(const YAML::Node& cell, const YAML::Node& job) {
  if (cell["tool"]) return cell["tool"];
  for (const YAML::Node& tool : cell["tools"])
    if (tool["name"].as<std::string>() == job["tool"].as<std::string>()) return tool;
  throw std::runtime_error("the cell does not have the job's tool");
}

Matrix4 ToolInFlange(const YAML::Node& tool) {
  const Vector3 tip = Triple(tool["tip_in_flange_mm"]), z = Triple(tool["axis_in_flange"]).normalized();
  const Vector3 given = Triple(tool["x_in_flange"]);
  const Vector3 x = (given - given.dot(z) * z).normalized();
  Matrix4 X = Matrix4::Identity();
  X.block<3, 1>(0, 0) = x;
  X.block<3, 1>(0, 1) = z.cross(x);
  X.block<3, 1>(0, 2) = z;
  X.block<3, 1>(0, 3) = tip;
  return X;
}

void ReadTool(const YAML::Node& tool, Setup* setup) {
  setup->X_FT = ToolInFlange(tool);
  const Real cutting_length = tool["cutter"]["cutting_length_mm"].as<double>();
  Real height = 0;
  for (const auto& part : tool["stack"]) {
    const Real length = part["length_mm"].as<double>(), bottom = part["diameter_mm"].as<double>() / 2;
    const Real top = part["top_diameter_mm"] ? part["top_diameter_mm"].as<double>() / 2 : bottom;
    const bool is_cutter = part["class"].as<std::string>() == "cutter";
    const auto add = [&](Real from, Real to, bool in_cut) {
      if (to <= from) return;
      Body body;
      body.name = part["name"].as<std::string>();
      body.kind = part["class"].as<std::string>();
      body.link = 6;
      body.in_cut = in_cut;
      const auto radius = [&](Real z) { return bottom + (top - bottom) * (z - height) / length; };
      body.X_LG = setup->X_FT * Shift(0, 0, (from + to) / 2);
      body.mesh = Frustum(radius(from), radius(to), to - from);
      setup->bodies.push_back(std::move(body));
    };
    const Real split = is_cutter ? std::clamp(cutting_length, height, height + length) : height;
    add(height, split, true);
    add(split, height + length, false);
    height += length;
  }
}

}  // namespace millpose::audit
