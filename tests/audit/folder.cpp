// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/folder.hpp"

#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/file.hpp"
#include "judge/tessellate.hpp"

namespace millpose::audit {
namespace fs = std::filesystem;
namespace {

std::vector<Real> List(const YAML::Node& node) {
  std::vector<Real> numbers;
  for (const auto& entry : node) numbers.push_back(entry.as<double>());
  return numbers;
}

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
}

// Columns of T in F: z along the tool, x the part of the given direction across it.
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

// The stack as frusta; a cutter is cut in two where its cutting length ends.
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
    body.kind = node["class"].as<std::string>();
    body.mesh = ShapeOf(node["shape"], folder);
    body.X_LG = PoseOf(node["pose"]);
    const std::string mount = node["mount"].as<std::string>();
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
  if (objective["name"].as<std::string>() == "chen2021") {
    setup->w1 = objective["w1"].as<double>(0.5);
    setup->w2 = objective["w2"].as<double>(0.5);
  }
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
  setup->sinumerik_rotation = text("sinumerik", "rotation", "rpy");
  setup->sinumerik_turn_known = !text("sinumerik", "ori_ipo_with_g_code", "").empty();
  setup->linuxcnc_tool_axis = text("linuxcnc", "tool_axis", "z");
  setup->linuxcnc_rotation = text("linuxcnc", "rotation", "rpy");
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

/// The cell's only tool, or the one of several that the job takes.
YAML::Node ToolOf(const YAML::Node& cell, const YAML::Node& job) {
  if (cell["tool"]) return cell["tool"];
  for (const YAML::Node& tool : cell["tools"])
    if (tool["name"].as<std::string>() == job["tool"].as<std::string>()) return tool;
  throw std::runtime_error("the cell does not have the job's tool");
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
  workpiece.mesh = ReadStl(ReadFile(Resolve(starts, job["workpiece"]["mesh"].as<std::string>())),
                           UnitOf(job["workpiece"]["unit"].as<std::string>()));
  setup.bodies.push_back(std::move(workpiece));
  return setup;
}

namespace {

/// The cell wherever rows have the external axes; what the tables of the part's frame say is turned with it.
void MakeStations(Folder& folder) {
  for (const Row& row : folder.rows) {
    if (row.external.empty()) continue;
    if (!folder.stations.contains(row.external)) {
      Setup& at = folder.stations.emplace(row.external, At(folder.setup, row.external)).first->second;
      if (at.urdf)
        at.urdf->X_WS = Carried(folder.setup, LastCarrier(folder.setup, true), row.external) * at.urdf->X_WS;
    }
    const Matrix3 turned =
        Carried(folder.setup, LastCarrier(folder.setup, false), row.external).block<3, 3>(0, 0);
    if (const auto found = folder.deflected.find(row.point); found != folder.deflected.end())
      for (Vector3* v : {&found->second.force, &found->second.moved}) *v = turned * *v;
    if (const auto found = folder.compensated.find(row.point); found != folder.compensated.end())
      for (Vector3* v : {&found->second.force, &found->second.shift}) *v = turned * *v;
  }
}

void ReadCutter(const fs::path& path, Folder* folder) {
  const YAML::Node tool =
      ToolOf(YAML::Load(ReadFile(path / "cell.yaml")), YAML::Load(ReadFile(path / "job.yaml")));
  const YAML::Node cutter = tool["cutter"];
  const std::string shape = cutter["shape"].as<std::string>("flat");
  folder->cutter_radius = cutter["diameter_mm"].as<double>() / 2;
  folder->corner_radius = shape == "ball"   ? folder->cutter_radius
                          : shape == "bull" ? Real{cutter["corner_radius_mm"].as<double>()}
                                            : 0;
}

}  // namespace

Folder ReadFolder(const fs::path& path, const fs::path& inputs) {
  Folder folder;
  const std::vector<fs::path> starts =
      inputs.empty() ? std::vector<fs::path>{path, path / ".."} : std::vector<fs::path>{inputs};
  const auto optional = [&](const char* name) {
    return fs::exists(path / name) ? ReadFile(path / name) : std::string();
  };
  folder.setup = ReadSetup(ReadFile(path / "job.yaml"), starts, optional("cell.yaml"));
  folder.rows = ReadPoints(ReadFile(path / "points.csv"));
  folder.whole = std::ranges::all_of(folder.rows, &Row::planned);
  folder.goal = ReadGoal(ReadFile(path / "job.yaml"));
  if (fs::exists(path / "cell.yaml")) ReadCutter(path, &folder);
  if (const std::string csv = optional("compensation.csv"); !csv.empty())
    folder.compensated = ReadCompensated(csv, folder.setup.X_WP.block<3, 3>(0, 0));
  if (const std::string csv = optional("deflection.csv"); !csv.empty())
    folder.deflected = ReadDeflected(csv, folder.setup.X_WP.block<3, 3>(0, 0));
  MakeStations(folder);
  if (const std::string json = optional("summary.json"); !json.empty()) folder.summary = ReadSummary(json);
  if (const std::string cbor = optional("plan.cbor"); !cbor.empty()) folder.gaps = ReadGaps(cbor);
  // Programs of cells with external axes have frames of their own at every station: verify replays them.
  if (fs::exists(path / "programs") && folder.setup.axes.empty())
    for (const auto& controller : fs::directory_iterator(path / "programs"))
      for (const auto& file : fs::directory_iterator(controller.path()))
        if (file.is_regular_file())  // starts/ holds programs of single pieces: the whole one is judged
          folder.programs[controller.path().filename()][file.path().filename()] = ReadFile(file.path());
  return folder;
}

std::vector<PlannedGap> ReadGaps(const std::string& cbor) {
  std::vector<PlannedGap> gaps;
  const nlohmann::json plan = nlohmann::json::from_cbor(cbor);
  for (const auto& entry : plan.at("gaps")) {
    PlannedGap gap{
        entry.at("from_pass"), entry.at("from_piece"), entry.at("to_pass"), entry.at("to_piece"), {}};
    if (entry.at("planned").get<bool>())
      for (const auto& joints : entry.at("joints")) {
        Angles angles;
        for (size_t i = 0; i < 6; ++i) angles[i] = joints.at(i).get<double>();
        gap.joints.push_back(angles);
      }
    if (gap.joints.size() > 0 && entry.contains("external")) {
      const auto& move = entry.at("external");
      const auto position = [&](const char* key) {
        std::vector<Real> values;
        for (const auto& value : move.at(key)) values.push_back(value.get<double>());
        return values;
      };
      gap.move = {position("from"), position("to"), move.at("at").get<size_t>()};
    }
    gaps.push_back(std::move(gap));
  }
  return gaps;
}

std::vector<Real> LayersOf(Real total, Real per_layer, Real allowance, Real finishing) {
  if (total <= 0) return {allowance};
  std::vector<Real> layers;
  const Real last = std::min(finishing, total), rough = total - last;
  int steps = 0;
  while (rough - steps * per_layer > 1e-9L * per_layer) ++steps;
  if (steps == 0 && last <= 0) steps = 1;
  for (int left = steps - 1; left >= 0; --left) layers.push_back(allowance + last + left * rough / steps);
  if (last > 0) layers.push_back(allowance);
  return layers;
}

Goal ReadGoal(const std::string& job_text) {
  const YAML::Node job = YAML::Load(job_text), objective = job["pose"]["objective"];
  const YAML::Node process = job["process"];
  Goal goal;
  goal.objective = objective["name"].as<std::string>();
  goal.max_halfway = job["path"]["max_halfway_deviation_mm"].as<double>(5);
  const auto range = [&](const char* key) -> std::array<Real, 2> {
    const YAML::Node given = job["toolpath"][key];
    if (given && given.IsMap())
      return {given["from"].as<double>() * kDegree, given["to"].as<double>() * kDegree};
    const Real fixed = given ? given.as<double>() * kDegree : 0;
    return {fixed, fixed};
  };
  goal.lead = range("lead_deg");
  goal.tilt = range("tilt_deg");
  goal.max_lean_change = job["path"]["max_lean_change_deg_per_mm"].as<double>(0.5) * kDegree;
  if (const YAML::Node depth = job["toolpath"]["depth"]) {
    const auto mm = [&](const char* key, double otherwise) { return Real{depth[key].as<double>(otherwise)}; };
    goal.layers =
        LayersOf(mm("total_mm", 0), mm("per_layer_mm", 1), mm("allowance_mm", 0), mm("finishing_mm", 0));
  }
  if (process && process["force_uncertainty_percent"])
    goal.uncertainty = process["force_uncertainty_percent"].as<double>() / 100;
  if (process && process["force_direction_deg"])
    goal.direction = process["force_direction_deg"].as<double>() * kDegree;
  if (const YAML::Node compensation = job["compensation"])
    goal.largest_shift = compensation["max_mm"].as<double>(0.1);
  goal.given_force << objective["feed_N"].as<double>(0), objective["across_N"].as<double>(0),
      objective["axial_N"].as<double>(0);
  return goal;
}

std::optional<Summary> ReadSummary(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text);
  const auto& objective = json.at("stiffness").at("objective");
  if (!objective.at("worst").is_number()) return std::nullopt;
  return Summary{objective.at("best").get<double>(), objective.at("worst").get<double>(),
                 json.at("continuity").at("halfway_deviation_max_mm").get<double>()};
}

namespace {

/// Comma-separated values by the name of their column.
class Table {
 public:
  Table(std::string name, const std::string& csv) : name_(std::move(name)), lines_(csv) {
    Next();
    for (size_t i = 0; i < cells_.size(); ++i) columns_.emplace(cells_[i], i);
  }

  bool Next() {
    std::string line;
    if (!std::getline(lines_, line)) return false;
    ++number_;
    cells_.assign(1, "");
    for (const char c : line) {
      if (c == ',')
        cells_.emplace_back();
      else
        cells_.back() += c;
    }
    return true;
  }

  bool Has(const char* name) const { return columns_.contains(name); }
  const std::string& At(const char* name) const { return cells_.at(columns_.at(name)); }
  Real Number(const char* name) const {
    size_t used = 0;
    const Real value = std::stold(At(name), &used);
    if (used != At(name).size() || !std::isfinite(value))
      throw std::runtime_error(name_ + ":" + std::to_string(number_) + ": " + name + " is '" + At(name) +
                               "'");
    return value;
  }
  Vector3 Three(const char* x, const char* y, const char* z) const {
    return {Number(x), Number(y), Number(z)};
  }

 private:
  std::string name_;
  std::istringstream lines_;
  std::map<std::string, size_t> columns_;
  std::vector<std::string> cells_;
  int number_ = 0;
};

}  // namespace

std::map<int, Deflected> ReadDeflected(const std::string& csv, const Matrix3& R_WP) {
  constexpr Real kMicrometre = 1e-3L;
  Table table("deflection.csv", csv);
  std::map<int, Deflected> rows;
  while (table.Next())
    rows[std::stoi(table.At("point"))] = {R_WP * table.Three("force_x_N", "force_y_N", "force_z_N"),
                                          kMicrometre * R_WP * table.Three("x_um", "y_um", "z_um"),
                                          kMicrometre * table.Number("normal_um"),
                                          kMicrometre * table.Number("feed_um"),
                                          kMicrometre * table.Number("across_um"),
                                          kMicrometre * table.Number("length_um")};
  return rows;
}

std::map<int, Compensated> ReadCompensated(const std::string& csv, const Matrix3& R_WP) {
  constexpr Real kMicrometre = 1e-3L;
  Table table("compensation.csv", csv);
  std::map<int, Compensated> rows;
  while (table.Next())
    rows[std::stoi(table.At("point"))] = {
        R_WP * table.Three("force_x_N", "force_y_N", "force_z_N"),
        kMicrometre * table.Number("normal_low_um"),
        kMicrometre * table.Number("normal_expected_um"),
        kMicrometre * table.Number("normal_high_um"),
        kMicrometre * table.Number("normal_taken_um"),
        kMicrometre * table.Number("normal_worst_after_um"),
        kMicrometre * R_WP * table.Three("shift_x_um", "shift_y_um", "shift_z_um")};
  return rows;
}

std::vector<Row> ReadPoints(const std::string& csv) {
  Table table("points.csv", csv);
  std::vector<Row> rows;
  while (table.Next()) {
    Row row{};
    row.point = std::stoi(table.At("point"));
    row.pass = std::stoi(table.At("pass"));
    row.cut = table.At("kind") == "cut";
    row.position = table.Three("x_mm", "y_mm", "z_mm");
    row.normal = table.Three("nx", "ny", "nz");
    row.axis = table.Three("tx", "ty", "tz");
    row.feed_direction = table.Three("fx", "fy", "fz");
    row.planned = !table.At("a1_deg").empty();
    if (row.planned) {
      row.piece = std::stoi(table.At("piece"));
      const char* names[] = {"a1_deg", "a2_deg", "a3_deg", "a4_deg", "a5_deg", "a6_deg"};
      for (size_t i = 0; i < 6; ++i) row.angles[i] = table.Number(names[i]) * kDegree;
      row.rotation = table.Number("rotation_deg") * kDegree;
      row.lambda_t1 = table.Number("lambda_t1_mm_N");
      row.lambda_t2 = table.Number("lambda_t2_mm_N");
      row.lambda_n = table.Number("lambda_n_mm_N");
      row.mu = table.Number("mu");
      row.dexterity = table.Number("dexterity");
      row.objective = table.Number("objective");
      row.feed = table.Number("feed_mm_min") / 60;
      if (table.Has("lead_deg"))
        row.lean = {table.Number("lead_deg") * kDegree, table.Number("tilt_deg") * kDegree};
    }
    if (row.planned && table.Has("commanded_x_mm")) {
      Row::Commanded& commanded = row.commanded.emplace();
      commanded.position = table.Three("commanded_x_mm", "commanded_y_mm", "commanded_z_mm");
      commanded.axis = table.Three("commanded_tx", "commanded_ty", "commanded_tz");
      for (size_t i = 0; i < 6; ++i)
        commanded.angles[i] =
            table.Number(("commanded_a" + std::to_string(i + 1) + "_deg").c_str()) * kDegree;
    }
    for (int i = 1; i <= 3; ++i) {
      const std::string name = "e" + std::to_string(i);
      if (table.Has((name + "_mm").c_str())) row.external.push_back(table.Number((name + "_mm").c_str()));
      if (table.Has((name + "_deg").c_str()))
        row.external.push_back(table.Number((name + "_deg").c_str()) * kDegree);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace millpose::audit
