// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>

#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/loose_file.hpp"
#include "base/units.hpp"
#include "commands.hpp"
#include "job/assemble.hpp"
#include "job/inputs.hpp"
#include "planning/pose/map.hpp"
#include "stiffness_output.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

struct StiffnessOptions {
  std::string cell, at, poses, axis, map_index, output;
  std::vector<double> joints, normal, plane, tool_axis;
  std::vector<int> steps;
  double rotation_step_deg = 5;
  bool json = false;
};

Vector3d Unit(const std::vector<double>& numbers, const char* option, const SourceLocation& place = {}) {
  const Vector3d v(numbers[0], numbers[1], numbers[2]);
  if (!v.allFinite() || v.norm() < 1e-9)
    throw InputError(place, fmt::format("{}: given {} {} {}; allowed: three finite numbers, not all 0",
                                        option, v.x(), v.y(), v.z()));
  return v.normalized();
}

/// The cell as the command needs it.
struct Subject {
  CellSettings cell;
  Arm arm;
  Pose X_FT;
  bool at_flange;
  std::vector<SeriesCompliance> elements;
  std::optional<GravityModel> gravity;
  Vector3d Point() const { return at_flange ? Vector3d::Zero() : Vector3d(X_FT.translation()); }
};

Subject Load(const StiffnessOptions& options) {
  std::map<std::string, std::string> bytes;
  Subject subject{.cell = LoadCell(options.cell, &bytes),
                  .arm = {},
                  .X_FT = {},
                  .at_flange = false,
                  .elements = {},
                  .gravity = {}};
  subject.arm = MakeArm(subject.cell.arm);
  subject.X_FT = MakeToolPose(subject.cell.tool);
  subject.at_flange = options.at.empty()
                          ? subject.cell.stiffness_at == StiffnessOrigin::kFlange
                          : options.at == WordOf(kStiffnessOriginWords, StiffnessOrigin::kFlange);
  subject.elements = MakeCompliancesAtHome(subject.cell);
  subject.gravity = MakeGravity(subject.cell);
  return subject;
}

PoseReport Evaluate(const StiffnessOptions& options, const Subject& subject, const Joints& q,
                    const std::optional<Vector3d>& given) {
  if (!given && options.axis.empty() && options.normal.empty())
    throw InputError({}, "no milling plane; allowed: --normal X Y Z, --axis tool, or nx,ny,nz in --poses");
  const Vector3d normal = given ? *given
                          : options.normal.empty()
                              ? Vector3d((ForwardFlange(subject.arm, q) * subject.X_FT).linear().col(2))
                              : Unit(options.normal, "--normal");
  PoseReport report{q,
                    normal,
                    subject.at_flange ? "flange" : "tool_tip",
                    EvaluatePose(subject.arm, q, subject.Point(), normal, subject.cell.characteristic_length,
                                 subject.elements),
                    std::nullopt,
                    false};
  if (const auto& model = subject.gravity) {
    report.weight = GravityDeflection(subject.arm, q, model->reference, subject.Point(), model->masses,
                                      model->counterbalance, model->gravity);
    report.counterbalance_ignored = !model->counterbalance_given;
  }
  return report;
}

Joints FromDegrees(const std::vector<double>& degrees, const char* source, const SourceLocation& place = {}) {
  Joints q;
  for (int i = 0; i < 6; ++i) {
    if (!std::isfinite(degrees[i]) || std::abs(degrees[i]) > 3600)
      throw InputError(place,
                       fmt::format("{}: A{} is {}; allowed: -3600 to 3600 deg", source, i + 1, degrees[i]));
    q[i] = DegToRad(degrees[i]);
  }
  return q;
}

int OnePose(const StiffnessOptions& options, const Subject& subject) {
  const PoseReport report =
      Evaluate(options, subject, FromDegrees(options.joints, "--joints-deg"), std::nullopt);
  fmt::print("{}", options.json ? ReportAsJson(report) : ReportAsText(report));
  return report.stiffness.indices && report.stiffness.K ? kDone : kFindings;
}

int ManyPoses(const StiffnessOptions& options, const Subject& subject) {
  const CsvTable table =
      ReadCsv(ReadFile(options.poses), options.poses,
              {{"a1_deg", "a2_deg", "a3_deg", "a4_deg", "a5_deg", "a6_deg"}, {"nx", "ny", "nz"}});
  const int given = table.Has("nx") + table.Has("ny") + table.Has("nz");
  if (given != 0 && given != 3)
    throw InputError({options.poses, 1}, "only part of nx,ny,nz; allowed: all three, or none");
  if (table.size() == 0) throw InputError({options.poses}, "no poses; allowed: at least one row");
  std::vector<PoseReport> reports;
  for (size_t row = 0; row < table.size(); ++row) {
    const SourceLocation place{options.poses, table.line(row)};
    std::vector<double> degrees;
    for (int i = 0; i < 6; ++i) degrees.push_back(table.At(row, fmt::format("a{}_deg", i + 1)));
    std::optional<Vector3d> normal;
    if (given == 3)
      normal = Unit({table.At(row, "nx"), table.At(row, "ny"), table.At(row, "nz")}, "nx,ny,nz", place);
    reports.push_back(Evaluate(options, subject, FromDegrees(degrees, "a1_deg..a6_deg", place), normal));
  }
  fmt::print("{}", options.json ? ReportsAsJson(reports) : ReportsAsCsv(reports));
  const auto regular = [](const PoseReport& report) { return report.stiffness.indices.has_value(); };
  return std::all_of(reports.begin(), reports.end(), regular) ? kDone : kFindings;
}

MapRequest MakeRequest(const StiffnessOptions& options, const Subject& subject) {
  if (options.plane.empty() || options.steps.empty())
    throw InputError(
        {}, "--map needs --plane (9 numbers: corner, end of the first edge, end of the second) and --steps");
  for (const double number : options.plane)
    if (!std::isfinite(number) || std::abs(number) > 1e6)
      throw InputError({}, fmt::format("--plane: given {}; allowed: -1000000 to 1000000 mm", number));
  const auto point = [&](int i) {
    return Vector3d(options.plane[i], options.plane[i + 1], options.plane[i + 2]);
  };
  MapRequest request;
  request.arm = subject.arm;
  request.lower = subject.arm.lower;
  request.upper = subject.arm.upper;
  request.X_FT = subject.X_FT;
  request.at_flange = subject.at_flange;
  request.characteristic_length = subject.cell.characteristic_length;
  if (options.steps[0] < 1 || options.steps[1] < 1 ||
      (double(options.steps[0]) + 1) * (double(options.steps[1]) + 1) > 1e6)
    throw InputError({},
                     fmt::format("--steps: given {} {}; allowed: at least 1 each, at most a million points",
                                 options.steps[0], options.steps[1]));
  request.u_count = options.steps[0] + 1;
  request.v_count = options.steps[1] + 1;
  request.elements = subject.elements;
  request.origin = point(0);
  request.u = (point(3) - point(0)) / (request.u_count - 1);
  request.v = (point(6) - point(0)) / (request.v_count - 1);
  if (!(request.u.cross(request.v).norm() > 0))
    throw InputError({}, "--plane: the three points are on a line");
  request.tool_axis =
      options.tool_axis.empty()
          ? Vector3d((ForwardFlange(subject.arm, subject.cell.home) * subject.X_FT).linear().col(2))
          : Unit(options.tool_axis, "--tool-axis");
  request.normal = options.normal.empty() ? request.tool_axis : Unit(options.normal, "--normal");
  request.index = options.map_index;
  if (!std::isfinite(options.rotation_step_deg))
    throw InputError({}, "--rotation-step-deg: given nan; allowed: 0.1 to 90");
  request.rotation_step = DegToRad(options.rotation_step_deg);
  return request;
}

int Map(const StiffnessOptions& options, const Subject& subject) {
  const MapRequest request = MakeRequest(options, subject);
  const std::vector<MapPoint> points = DrawMap(request);
  if (!options.output.empty()) {
    WriteLooseFile(options.output + ".csv", MapToCsv(request, points));
    WriteLooseFile(options.output + ".vtk", MapToVtk(request, points));
  }
  fmt::print("{}", options.json             ? MapAsJson(request, points)
                   : options.output.empty() ? MapToCsv(request, points)
                                            : MapSummary(request, points));
  const auto reached = [](const MapPoint& at) { return at.reached; };
  return std::any_of(points.begin(), points.end(), reached) ? kDone : kFindings;
}

int Stiffness(const StiffnessOptions& options) {
  const int asked = !options.joints.empty() + !options.poses.empty() + !options.map_index.empty();
  if (asked != 1) throw InputError({}, "give one of --joints-deg, --poses and --map");
  const Subject subject = Load(options);
  if (!options.map_index.empty()) return Map(options, subject);
  return options.poses.empty() ? OnePose(options, subject) : ManyPoses(options, subject);
}

}  // namespace

void AddStiffnessCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "stiffness",
      "Compliance and its indices in one pose, in many, or over a plane of the cell (docs/stiffness.md).\n"
      "Directions and positions are in the robot base frame; compliance mm/N, angles deg.\n"
      "Exit status 1: a singular pose, or a map without a reached point.");
  static StiffnessOptions options;
  std::vector<std::string> names;
  for (const MapIndex& index : MapIndices()) names.push_back(index.name);
  command->add_option("cell", options.cell, "Cell YAML")->required();
  command->add_option("--joints-deg", options.joints, "A1 … A6 in the arm's convention, deg")->expected(6);
  command->add_option("--poses", options.poses,
                      "CSV of poses: a1_deg … a6_deg, optionally nx,ny,nz; results as CSV or JSON");
  command->add_option("--normal", options.normal, "Normal of the milling plane, robot base frame")
      ->expected(3);
  command->add_option("--axis", options.axis, "tool: the milling plane is normal to the tool axis")
      ->check(CLI::IsMember({"tool"}));
  command->add_option("--at", options.at, "Where stiffness holds; default: as the cell says")
      ->check(CLI::IsMember({"tool_tip", "flange"}));
  command->add_flag("--json", options.json, "Results as JSON on stdout");
  command
      ->add_option("--map", options.map_index,
                   "Draw this index over a plane of tool tips, each point in its best pose")
      ->check(CLI::IsMember(names));
  command
      ->add_option("--plane", options.plane,
                   "Map: corner, end of first edge, end of second edge: 9 numbers, robot base frame, mm")
      ->expected(9);
  command->add_option("--steps", options.steps, "Map: steps along the two edges")->expected(2);
  command
      ->add_option("--tool-axis", options.tool_axis,
                   "Map: tool axis, from tip to holder, robot base frame; default: as at home")
      ->expected(3);
  command
      ->add_option("--rotation-step-deg", options.rotation_step_deg,
                   "Map: grid of rotations about the tool axis, deg")
      ->check(CLI::Range(0.1, 90.0));
  command->add_option("-o,--output", options.output, "Map: write OUTPUT.csv and OUTPUT.vtk, print a summary");
  command->callback([&run] { run = [](Session&) { return Stiffness(options); }; });
}

}  // namespace millpose
