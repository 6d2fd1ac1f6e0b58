// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/folder.hpp"

#include <nlohmann/json.hpp>
#include <set>

#include "base/file.hpp"
#include "base/gzip.hpp"
#include "tests/audit/yaml_values.hpp"

namespace millpose::audit {
namespace fs = std::filesystem;
namespace {

/// The cell wherever rows have the external axes; what the tables of the part's frame say is turned with it.
void MakeStations(Folder& folder) {
  Setup bare = folder.setup;  // there may be as many as points
  bare.bodies.clear();
  for (const Row& row : folder.rows) {
    if (row.external.empty()) continue;
    if (!folder.stations.contains(row.external)) {
      Setup& at = folder.stations.emplace(row.external, At(bare, row.external)).first->second;
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

/// Whether the job has the tool along the surface's normal throughout.
bool AlongNormal(const std::string& job_text) {
  const YAML::Node toolpath = YAML::Load(job_text)["toolpath"];
  for (const char* key : {"lead_deg", "tilt_deg"})
    if (toolpath[key] && (toolpath[key].IsMap() || toolpath[key].as<double>() != 0)) return false;
  return !toolpath["tool_axis"] || toolpath["tool_axis"]["rule"].as<std::string>() == "normal";
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
  const YAML::Node workpiece = YAML::Load(ReadFile(path / "job.yaml"))["workpiece"];
  folder.plate = ReadPlate(workpiece);
  if (folder.plate) folder.unbent = ReadPart(workpiece, starts);
  folder.rows = ReadPoints(ReadFile(path / "points.csv"));
  folder.whole = std::ranges::all_of(folder.rows, &Row::planned);
  folder.leans = std::ranges::any_of(folder.rows, [](const Row& row) { return row.lean.has_value(); });
  folder.goal = ReadGoal(ReadFile(path / "job.yaml"));
  folder.own_arm = ReadCommandedArm(ReadFile(path / "job.yaml"), optional("cell.yaml"));
  folder.along_normal = AlongNormal(ReadFile(path / "job.yaml"));
  if (fs::exists(path / "cell.yaml")) ReadCutter(path, &folder);
  if (const std::string csv = optional("compensation.csv"); !csv.empty())
    folder.compensated = ReadCompensated(csv, folder.setup.X_WP.block<3, 3>(0, 0));
  if (const std::string csv = optional("deflection.csv"); !csv.empty())
    folder.deflected = ReadDeflected(csv, folder.setup.X_WP.block<3, 3>(0, 0));
  MakeStations(folder);
  if (const std::string json = optional("summary.json"); !json.empty()) {
    folder.summary = ReadSummary(json);
    folder.reversals = ReadReversals(json);
  }
  if (const std::string cell = optional("cell.yaml"); !cell.empty()) folder.gears = ReadGears(cell);
  folder.all_air = std::ranges::all_of(folder.deflected, [](const auto& entry) { return entry.second.air; });
  if (const std::string file = optional("plan.cbor.gz"); !file.empty()) {
    const std::string cbor = Gunzip(file).value();
    folder.gaps = ReadLinkMoves(cbor);
    MarkClosed(cbor, folder.rows);
  }
  if (fs::exists(path / "programs"))
    for (const auto& controller : fs::directory_iterator(path / "programs"))
      for (const auto& file : fs::directory_iterator(controller.path()))
        if (file.is_regular_file())  // starts/ holds programs of single pieces: the whole one is judged
          folder.programs[controller.path().filename()][file.path().filename()] = ReadFile(file.path());
  return folder;
}

std::vector<PlannedLinkMove> ReadLinkMoves(const std::string& cbor) {
  std::vector<PlannedLinkMove> gaps;
  const nlohmann::json plan = nlohmann::json::from_cbor(cbor);
  for (const auto& entry : plan.at("gaps")) {
    PlannedLinkMove gap{
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

void MarkClosed(const std::string& cbor, std::vector<Row>& rows) {
  std::set<std::pair<int, int>> closed;
  const nlohmann::json plan = nlohmann::json::from_cbor(cbor);
  for (const auto& pass : plan.at("passes"))
    for (const auto& piece : pass.at("pieces"))
      if (piece.at("closed").get<bool>()) closed.emplace(piece.at("pass"), piece.at("piece"));
  for (Row& row : rows) row.closed = row.planned && closed.contains({row.pass, row.piece});
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
  goal.objective = objective["name"].as<std::string>("");
  goal.counted = objective["direction"].as<std::string>("normal");
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

OwnArm ReadOwnArm(const std::string& cell) {
  const YAML::Node stated = YAML::Load(cell)["arm"]["deviations"];
  OwnArm own;
  own.frames.fill(Matrix4::Identity());
  for (size_t i = 0; i < own.frames.size(); ++i) {
    if (const YAML::Node shifts = stated["shifts_mm"]) own.frames[i].block<3, 1>(0, 3) = Triple(shifts[i]);
    const YAML::Node turns = stated["turns_mrad"];
    const Vector3 turn = turns ? Vector3(Triple(turns[i]) / 1000) : Vector3(Vector3::Zero());
    if (const Real angle = turn.norm(); angle > 0)
      own.frames[i].block<3, 3>(0, 0) = Eigen::AngleAxis<Real>(angle, turn / angle).toRotationMatrix();
  }
  for (const auto& wave : stated["gears"])
    own.waves.push_back({wave["joint"].as<size_t>() - 1, wave["harmonic"].as<double>(),
                         wave["amplitude_arcsec"].as<double>() * kDegree / 3600,
                         wave["phase_deg"].as<double>() * kDegree});
  for (const auto& one : stated["couplings"])
    own.followers.push_back(
        {one["joint"].as<size_t>() - 1, one["follows"].as<size_t>() - 1, one["factor"].as<double>()});
  return own;
}

std::optional<OwnArm> ReadCommandedArm(const std::string& job, const std::string& cell) {
  const YAML::Node compensation = YAML::Load(job)["compensation"];
  if (!compensation || !compensation["deviations"].as<bool>(false)) return std::nullopt;
  return ReadOwnArm(cell);
}

std::optional<Summary> ReadSummary(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text);
  const auto& objective = json.at("stiffness").at("objective");
  if (!objective.at("worst").is_number()) return std::nullopt;
  return Summary{objective.at("best").get<double>(), objective.at("worst").get<double>(),
                 json.at("continuity").at("halfway_deviation_max_mm").get<double>()};
}

Gears ReadGears(const std::string& cell_text) {
  const YAML::Node cell = YAML::Load(cell_text), arm = cell["arm"];
  Gears gears;
  Eigen::Matrix<Real, 6, 6> matrix = Eigen::Matrix<Real, 6, 6>::Identity();
  for (const auto& coupling : arm["gear_couplings"])
    matrix(coupling["gear"].as<int>() - 1, coupling["axis"].as<int>() - 1) = coupling["factor"].as<double>();
  const Eigen::Matrix<Real, 6, 6> inverse = matrix.inverse();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      gears.couplings[static_cast<size_t>(i)][static_cast<size_t>(j)] = matrix(i, j);
      gears.axes_by_gear[static_cast<size_t>(i)][static_cast<size_t>(j)] = inverse(i, j);
    }
  gears.width.resize(6);
  if (const YAML::Node given = arm["lost_motion_arcmin"]) {
    const Angles widths = Six(given, kDegree / 60);
    for (size_t i = 0; i < 6; ++i) gears.width[i] = widths[i];
  }
  for (const auto& axis : cell["external_axes"]) {
    std::optional<Real>& width = gears.width.emplace_back();
    if (axis["lost_motion_um"]) width = axis["lost_motion_um"].as<double>() / 1000;
    if (axis["lost_motion_arcmin"]) width = axis["lost_motion_arcmin"].as<double>() * kDegree / 60;
  }
  gears.loaded = arm["gear_friction_Nm"].IsDefined();
  return gears;
}

std::optional<std::map<std::pair<int, size_t>, int>> ReadReversals(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text);
  if (!json.contains("reversals")) return std::nullopt;
  std::map<std::pair<int, size_t>, int> counts;
  for (const auto& pass : json.at("reversals").at("passes")) {
    const std::vector<int> of_pass = pass.at("counts");
    for (size_t gear = 0; gear < of_pass.size(); ++gear)
      if (of_pass[gear] > 0) counts[{pass.at("pass").get<int>(), gear}] = of_pass[gear];
  }
  return counts;
}

}  // namespace millpose::audit
