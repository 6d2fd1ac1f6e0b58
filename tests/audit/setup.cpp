// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "audit/tessellate.hpp"
#include "base/file.hpp"
#include "tests/audit/folder.hpp"
#include "tests/audit/yaml_values.hpp"

namespace millpose::audit {
namespace fs = std::filesystem;
namespace {

void ReadArm(const YAML::Node& arm, Setup* setup) {
  const YAML::Node lengths = arm["lengths_mm"];
  setup->d1 = lengths["d1"].as<double>();
  setup->a1 = lengths["a1"].as<double>();
  setup->a2 = lengths["a2"].as<double>();
  setup->d4 = lengths["d4"].as<double>();
  setup->dz = lengths["dz"].as<double>();
  setup->d6 = lengths["d6"].as<double>();
  if (lengths["dy"]) setup->dy = lengths["dy"].as<double>();
  if (lengths["d5"]) setup->d5 = lengths["d5"].as<double>();
  setup->parallel = arm["family"] && arm["family"].as<std::string>() == "parallel_axes";
  setup->sign = Six(arm["axis_signs"], 1);
  setup->offset = arm["zero_offsets_deg"] ? Six(arm["zero_offsets_deg"], kDegree) : Angles{};
  setup->max_step_speed = Six(arm["speeds_deg_s"], kDegree);
  setup->stiffness = Six(arm["joint_stiffness_Nm_per_rad"], 1000);
  for (size_t i = 0; i < 6; ++i) {
    setup->hard_lower[i] = arm["limits_deg"][i][0].as<double>() * kDegree;
    setup->hard_upper[i] = arm["limits_deg"][i][1].as<double>() * kDegree;
  }
  for (const YAML::Node& limit : arm["coupled_limits_deg"])
    setup->coupled.push_back({Six(limit["a"], 1), limit["at_most"].as<double>() * kDegree});
}

Mesh ShapeOf(const YAML::Node& shape, const fs::path& folder) {
  const std::string kind = shape.begin()->first.as<std::string>();
  const YAML::Node s = shape.begin()->second;
  if (kind == "mesh") {
    const std::string file = s["file"].as<std::string>();
    return ReadStl(ReadFile(folder / file), UnitOf(s["unit"].as<std::string>()));
  }
  if (kind == "box") return BoxMesh(Triple(s["size_mm"]));
  if (kind == "convex") {
    std::vector<Vector3> points;
    for (const auto& p : s["points_mm"]) points.push_back(Triple(p));
    return HullMesh(points);
  }
  const Real radius = s["diameter_mm"].as<double>() / 2;
  if (kind == "sphere") return CapsuleMesh(radius, 0);
  const Real length = s["length_mm"].as<double>();
  if (kind == "capsule") return CapsuleMesh(radius, length);
  if (kind == "cylinder") return Frustum(radius, radius, length);
  if (kind == "cone") return Frustum(radius, s["top_diameter_mm"].as<double>() / 2, length);
  throw std::runtime_error("unknown shape " + kind);
}

int AxisNamed(const YAML::Node& axes, const std::string& name) {
  for (size_t i = 0; i < axes.size(); ++i)
    if (axes[i]["name"].as<std::string>() == name) return static_cast<int>(i);
  throw std::runtime_error("no external axis " + name);
}

void ReadAxes(const YAML::Node& axes, Setup* setup) {
  for (const auto& node : axes) {
    ExternalAxis axis;
    axis.rotary = node["kind"].as<std::string>() == "rotary";
    axis.carries_robot = node["carries"].as<std::string>() == "robot";
    axis.direction = Triple(node["axis"]).normalized();
    axis.origin = node["origin_mm"] ? Triple(node["origin_mm"]) : Vector3(Vector3::Zero());
    const char* unit = axis.rotary ? "deg" : "mm";
    const Real scale = axis.rotary ? kDegree : 1;
    const auto key = [&](const std::string& name) { return name + unit; };
    axis.name = node["name"].as<std::string>();
    axis.lower = node[key("limits_")][0].as<double>() * scale;
    axis.upper = node[key("limits_")][1].as<double>() * scale;
    axis.home = node[key("home_")].as<double>(0) * scale;
    axis.speed = node[key("speed_") + "_s"].as<double>() * scale;
    if (node["stiffness_N_mm"]) axis.compliance = 1 / Real{node["stiffness_N_mm"].as<double>()};
    if (node["stiffness_Nm_per_rad"])
      axis.compliance = 1 / (1000 * Real{node["stiffness_Nm_per_rad"].as<double>()});
    setup->axes.push_back(axis);
  }
}

void ReadBodies(const YAML::Node& bodies, const YAML::Node& axes, const fs::path& folder, Setup* setup) {
  for (const auto& node : bodies) {
    Body body;
    body.name = node["name"].as<std::string>();
    body.kind = node["class"].as<std::string>("fixture");
    body.mesh = ShapeOf(node["shape"], folder);
    body.X_LG = PoseOf(node["pose"]);
    const std::string mount = node["mount"].as<std::string>("workpiece");
    if (mount == "carriage") {
      body.carrier = AxisNamed(axes, node["axis"].as<std::string>());
      body.guided = true;
    } else if (mount == "base") {
      body.link = 0;
    } else if (mount == "tool") {
      body.link = 6;
      body.X_LG = setup->X_FT * body.X_LG;
    } else if (mount == "workpiece") {
      body.X_LG = setup->X_WP * body.X_LG;
      body.carrier = LastCarrier(*setup, false);
    } else if (mount != "world") {
      body.link = mount.back() - '0';
    }
    setup->bodies.push_back(std::move(body));
  }
}

void ReadJob(const YAML::Node& job, Setup* setup) {
  Angles margin;
  margin.fill(0);
  if (job["limits"]["margin_deg"]) margin.fill(job["limits"]["margin_deg"].as<double>() * kDegree);
  setup->coupled_margin = margin[0];
  const YAML::Node task = job["limits"]["joints_deg"];
  for (size_t i = 0; i < 6; ++i) {
    setup->lower[i] = setup->hard_lower[i];
    setup->upper[i] = setup->hard_upper[i];
    if (task && task.IsSequence()) {
      setup->lower[i] = std::max(setup->lower[i], task[i][0].as<double>() * kDegree);
      setup->upper[i] = std::min(setup->upper[i], task[i][1].as<double>() * kDegree);
    }
    setup->lower[i] += margin[i];
    setup->upper[i] -= margin[i];
  }
  const YAML::Node path = job["path"];
  setup->max_step.fill(std::numeric_limits<Real>::infinity());
  if (path["max_joint_step_deg"]) setup->max_step = Six(path["max_joint_step_deg"], kDegree);
  setup->max_step_per_mm = path["max_joint_deg_per_mm"].as<double>(2) * kDegree;
  for (Real& speed : setup->max_step_speed) speed *= path["joint_speed_share"].as<double>(0.25);
  setup->spacing = job["toolpath"]["spacing_mm"].as<double>();
  const std::string strategy = job["toolpath"]["strategy"].as<std::string>();
  setup->rings = strategy == "rings";
  setup->laid = strategy != "drill" && strategy != "trim";
  const YAML::Node objective = job["pose"]["objective"];
  if (objective["name"].as<std::string>("") == "chen2021") {
    setup->w1 = objective["w1"].as<double>(0.5);
    setup->w2 = objective["w2"].as<double>(0.5);
  }
}

/// The axes of the cell as a controller has them; others stand still.
void ReadControllerAxes(const YAML::detail::iterator_value& controller, Setup* setup) {
  for (const auto& node : controller.second["external_axes"]) {
    if (!node["axis"]) continue;
    const std::string name = node["axis"].as<std::string>();
    for (size_t i = 0; i < setup->axes.size(); ++i)
      if (setup->axes[i].name == name)
        setup->controller_axes[controller.first.as<std::string>()].push_back(
            {node["name"].as<std::string>(), i, node["coupled"].as<bool>()});
  }
}

void ReadKrlFrames(const YAML::Node& krl, Setup* setup) {
  if (krl["robroot"]) setup->krl_robot = PoseOf(krl["robroot"]);
  if (const YAML::Node rail = krl["ersysroot"]) {
    const std::string direction = rail["direction"].as<std::string>("x");
    const Vector3 along = Vector3::Unit(direction.back() - 'x');
    setup->krl_rail = {PoseOf(rail["pose"]), direction.front() == '-' ? Vector3(-along) : along};
  }
  if (const YAML::Node table = krl["external_base"])
    setup->krl_table =
        PoseOf(table["root"]) * (table["flange"] ? PoseOf(table["flange"]) : Matrix4(Matrix4::Identity()));
}

void ReadControllers(const YAML::Node& controllers, Setup* setup) {
  if (!controllers) return;
  const auto text = [&](const char* controller, const char* key, const char* otherwise) {
    const YAML::Node node = controllers[controller];
    return node && node[key] ? node[key].as<std::string>() : std::string(otherwise);
  };
  setup->krl_tool_axis = text("krl", "tool_axis", "z");
  setup->krl_tool_direction = text("krl", "tool_direction", "x");
  setup->sinumerik_tool_axis = text("sinumerik", "tool_axis", "z");
  if (controllers["sinumerik"]) {
    const YAML::Node words = controllers["sinumerik"]["orientation_words"];
    if (words) setup->sinumerik_rotation = words["group"].as<std::string>();
    if (words) setup->sinumerik_words = words["names"].as<std::vector<std::string>>();
  }
  setup->sinumerik_turn_known = !text("sinumerik", "ori_ipo_with_g_code", "").empty();
  setup->linuxcnc_tool_axis = text("linuxcnc", "tool_axis", "z");
  setup->urscript_tool_axis = text("urscript", "tool_axis", "z");
  setup->linuxcnc_rotation = text("linuxcnc", "rotation", "rpy");
  setup->fanuc_tool_axis = text("fanuc", "tool_axis", "z");
  if (controllers["fanuc"]) setup->fanuc_height = controllers["fanuc"]["world_height_mm"].as<double>();
  for (const auto& controller : controllers) ReadControllerAxes(controller, setup);
  for (const auto& controller : controllers) {
    Setup::Count count;
    count.sign.fill(1);
    count.offset.fill(0);
    if (controller.second["axis_signs"]) count.sign = Six(controller.second["axis_signs"], 1);
    if (controller.second["axis_offsets_deg"])
      count.offset = Six(controller.second["axis_offsets_deg"], kDegree);
    for (const YAML::Node& row : controller.second["axis_couplings"])
      count.coupling.at(row["axis"].as<size_t>() - 1) = Six(row["factors"], 1);
    setup->counts[controller.first.as<std::string>()] = count;
  }
  if (controllers["krl"]) ReadKrlFrames(controllers["krl"], setup);
}

void ReadSprings(const YAML::Node& compliances, Setup* setup) {
  for (const auto& node : compliances) {
    Spring spring;
    const std::string mount = node["mount"].as<std::string>();
    spring.link = mount == "base" ? 0 : mount.back() - '0';
    spring.X_LK = PoseOf(node["pose"]);
    spring.C.setZero();
    for (size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (node["translational_mm_N"]) spring.C(k, k) = node["translational_mm_N"][i].as<double>();
      if (node["rotational_rad_Nm"])
        spring.C(k + 3, k + 3) = node["rotational_rad_Nm"][i].as<double>() / 1000;
    }
    if (node["matrix"] && node["matrix"].size() == 6)
      for (size_t i = 0; i < 6; ++i)
        for (size_t j = 0; j < 6; ++j)
          spring.C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
              node["matrix"][i][j].as<double>();
    setup->springs.push_back(spring);
  }
}

void ReadCell(const YAML::Node& cell, const fs::path& folder, const YAML::Node& job, Setup* setup) {
  const YAML::Node workpiece = job["workpiece"], tool = ToolOf(cell, job);
  ReadArm(cell["arm"], setup);
  setup->X_WB = PoseOf(cell["base_in_world"]);
  setup->X_WP = PoseOf(workpiece["pose"]);
  if (workpiece["frame"] && workpiece["frame"].as<std::string>() == "robot_base")
    setup->X_WP = setup->X_WB * setup->X_WP;
  setup->home = Six(cell["home_deg"], kDegree);
  ReadTool(tool, setup);
  ReadAxes(cell["external_axes"], setup);
  ReadBodies(cell["bodies"], cell["external_axes"], folder, setup);
  for (const auto& pair : cell["excluded_pairs"])
    setup->excluded_pairs.emplace_back(pair[0].as<std::string>(), pair[1].as<std::string>());
  const YAML::Node stiffness = cell["stiffness"];
  if (stiffness && stiffness["characteristic_length_mm"])
    setup->characteristic_length = stiffness["characteristic_length_mm"].as<double>();
  if (const YAML::Node clearance = cell["clearance_mm"]) {
    if (clearance["free"]) setup->clearance_free = clearance["free"].as<double>();
    if (clearance["cutting"]) setup->clearance_cutting = clearance["cutting"].as<double>();
  }
  setup->stiffness_at_flange = stiffness && stiffness["at"] && stiffness["at"].as<std::string>() == "flange";
  if (stiffness && stiffness["compliances"]) ReadSprings(stiffness["compliances"], setup);
  if (tool["compliances"]) ReadSprings(tool["compliances"], setup);
  ReadControllers(cell["controllers"], setup);
}

fs::path Resolve(const std::vector<fs::path>& starts, const std::string& name) {
  for (const fs::path& start : starts)
    if (fs::exists(start / name)) return start / name;
  throw std::runtime_error("cannot find '" + name + "'; say with --inputs where the job was");
}

}  // namespace

Mesh ReadPart(const YAML::Node& workpiece, const std::vector<fs::path>& starts) {
  return ReadStl(ReadFile(Resolve(starts, workpiece["mesh"].as<std::string>())),
                 UnitOf(workpiece["unit"].as<std::string>()));
}

Setup ReadSetup(const std::string& job_text, const std::vector<fs::path>& starts,
                const std::string& resolved) {
  Setup setup{};
  const YAML::Node job = YAML::Load(job_text);
  const fs::path cell_path = Resolve(starts, job["cell"].as<std::string>());
  const YAML::Node stated = YAML::Load(ReadFile(cell_path));
  const YAML::Node urdf = stated["arm"]["urdf"];
  if (urdf && resolved.empty())
    throw std::runtime_error("a cell with a URDF is judged from its cell.yaml only");
  ReadCell(urdf ? YAML::Load(resolved) : stated, cell_path.parent_path(), job, &setup);
  if (urdf) {
    setup.urdf = ReadUrdf(ReadFile(cell_path.parent_path() / urdf["file"].as<std::string>()),
                          urdf["base_link"].as<std::string>(), urdf["flange_link"].as<std::string>());
    setup.urdf->X_WS = PoseOf(stated["base_in_world"]);
    setup.urdf->X_ET = ToolInFlange(ToolOf(stated, job));
  }
  ReadJob(job, &setup);
  Body workpiece;
  workpiece.name = workpiece.kind = "workpiece";
  workpiece.X_LG = setup.X_WP;
  workpiece.carrier = LastCarrier(setup, false);
  workpiece.mesh = ReadPart(job["workpiece"], starts);
  if (const auto plate = ReadPlate(job["workpiece"])) workpiece.mesh = plate->Bent(workpiece.mesh);
  setup.bodies.push_back(std::move(workpiece));
  // Their meshes lie beside the job, as the part does.
  const fs::path part = job["workpiece"]["mesh"].as<std::string>();
  const auto beside =
      std::ranges::find_if(starts, [&](const fs::path& start) { return fs::exists(start / part); });
  ReadBodies(job["workpiece"]["fixtures"], {}, *beside, &setup);
  return setup;
}

}  // namespace millpose::audit
