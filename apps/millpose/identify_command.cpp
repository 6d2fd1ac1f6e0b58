// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/loose_file.hpp"
#include "base/rounded.hpp"
#include "base/units.hpp"
#include "commands.hpp"
#include "identify_compliances.hpp"
#include "identify_geometry.hpp"
#include "identify_lost_motion.hpp"
#include "job/assemble.hpp"
#include "job/config/measurements.hpp"
#include "job/inputs.hpp"
#include "machine/identification/identify.hpp"
#include "machine/identification/plausibility.hpp"
#include "machine/robot/make_pose.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kNmPerNmm = 1e-3;

struct IdentifyWords {
  std::string file, cell, write_cell;
  std::vector<double> load_point, measured_point;
  int propose = -1;
  bool robust = false, springs = false, json = false;
};

struct Task {
  MeasurementsSettings settings;
  std::filesystem::path cell_file;
  ArmSettings arm_settings;
  Arm arm;
  Joints uncertainty;  ///< of its stiffness, as the cell says it
  IdentifyOptions options;
};

Task Load(const IdentifyWords& options) {
  Task task;
  const std::string bytes = ReadFile(options.file);
  const std::filesystem::path path(options.file);
  const bool csv = path.extension() == ".csv" || path.extension() == ".CSV";
  task.settings = csv ? ParseMeasurementsCsv(bytes, options.file) : ParseMeasurements(bytes, options.file);
  const auto point = [](const char* option, const std::vector<double>& given, Eigen::Vector3d& to) {
    if (given.empty()) return;
    to = {given[0], given[1], given[2]};
    if (!to.allFinite() || to.norm() > 1e6)
      throw InputError({}, fmt::format("{}: given {} {} {}; allowed: three numbers, -1000000 to 1000000 mm",
                                       option, to.x(), to.y(), to.z()));
  };
  point("--load-point-mm", options.load_point, task.settings.load_point);
  point("--measured-point-mm", options.measured_point, task.settings.measured_point);
  if (options.cell.empty() && task.settings.cell_file.empty())
    throw InputError({options.file}, "no arm; allowed: the key `cell` in the file, or --cell CELL.yaml");
  task.cell_file = options.cell.empty() ? path.parent_path() / task.settings.cell_file
                                        : std::filesystem::path(options.cell);
  std::map<std::string, std::string> meshes;
  const CellSettings cell = LoadCell(task.cell_file, &meshes);
  task.arm_settings = cell.arm;
  const ArmSettings& settings = task.arm_settings;
  task.arm = MakeArm(settings);
  task.uncertainty = settings.stiffness_uncertainty.isZero(0.0)
                         ? Joints(Joints::Constant(kStiffnessUncertainty))
                         : Joints(settings.stiffness_uncertainty);
  task.options = {task.settings.displacement_deviation, task.settings.rotation_deviation, options.robust};
  task.options.down = -MakePose(cell.base_in_world).linear().row(2).transpose();
  return task;
}

std::vector<LoadCase> MakeCases(const MeasurementsSettings& settings,
                                const std::vector<MeasurementSettings>& from) {
  std::vector<LoadCase> cases;
  for (const MeasurementSettings& one : from)
    cases.push_back({.q = one.joints,
                     .force = one.force,
                     .moment = one.moment,
                     .load_point = one.load_point.value_or(settings.load_point),
                     .measured_point = one.measured_point.value_or(settings.measured_point),
                     .displacement = one.displacement,
                     .rotation = one.rotation});
  return cases;
}

Json ToJson(const Identification& found, const ComplianceModels& models, const Plausibility& judged,
            const Task& task) {
  Json joints = Json::array();
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
  for (int j = 0; j < 6; ++j) {
    const JointEstimate& joint = found.joints[j];
    const bool d = joint.determined;
    joints.push_back({{"joint", j + 1},
                      {"determined", d},
                      {"reason", d ? Json() : Json(joint.reason)},
                      {"stiffness_Nm_per_rad", d ? number(joint.stiffness * kNmPerNmm) : Json()},
                      {"deviation_Nm_per_rad", d ? number(joint.deviation * kNmPerNmm) : Json()},
                      {"lower_95_Nm_per_rad", joint.lower > 0 ? number(joint.lower * kNmPerNmm) : Json()},
                      {"upper_95_Nm_per_rad", d ? number(joint.upper * kNmPerNmm) : Json()},
                      {"largest_change", d ? number(joint.largest_change) : Json()},
                      {"most_influential_pose", d ? Json(joint.most_influential + 1) : Json()}});
  }
  Json residuals = Json::array();
  for (size_t i = 0; i < found.residuals.size(); ++i)
    residuals.push_back({{"line", task.settings.measurements[i].line},
                         {"pose", found.pose_of_case[i] + 1},
                         {"residual_mm", found.residuals[i]}});
  const bool solved = !found.residuals.empty();
  return {{"schema_version", 1},
          {"joints", joints},
          {"compliances", BesideJson(found)},
          {"payload", PayloadJson(found)},
          {"models", ModelsJson(models)},
          {"condition", found.condition},
          {"residual_level", solved ? Json(found.level) : Json()},
          {"residual_rms_mm", solved ? Json(found.rms) : Json()},
          {"residual_verdict", solved ? Json(judged.residual) : Json()},
          {"poses", found.poses},
          {"measurements", found.pose_of_case.size()},
          {"residuals", residuals},
          {"findings", judged.findings},
          {"warnings", judged.warnings}};
}

void PrintResiduals(const Identification& found, const Plausibility& judged, const Task& task) {
  fmt::print("residual {:.4g} mm RMS per measurement, {}\n\n", found.rms, judged.residual);
  fmt::print("pose   measurements   residual, mm RMS   largest, mm\n");
  for (size_t pose = 0; pose < found.poses; ++pose) {
    size_t count = 0, worst = 0;
    double square = 0, largest = -1;
    for (size_t i = 0; i < found.residuals.size(); ++i) {
      if (found.pose_of_case[i] != pose) continue;
      ++count;
      square += found.residuals[i] * found.residuals[i];
      if (found.residuals[i] <= largest) continue;
      largest = found.residuals[i];
      worst = i;
    }
    fmt::print("{:<6} {:>12} {:>18.4g} {:>13.4g}  in line {}\n", pose + 1, count,
               std::sqrt(square / static_cast<double>(count)), largest,
               task.settings.measurements[worst].line);
  }
}

void Print(const Identification& found, const ComplianceModels& models, const Plausibility& judged,
           const Task& task) {
  fmt::print("joint   stiffness  std. deviation        95 % interval           left out: largest change\n");
  for (int j = 0; j < 6; ++j) {
    const JointEstimate& joint = found.joints[j];
    if (!joint.determined) {
      const std::string bound =
          joint.lower > 0 ? fmt::format("; above {:.4g} N·m/rad", joint.lower * kNmPerNmm) : "";
      fmt::print("A{}      no number: {}{}\n", j + 1, joint.reason, bound);
      continue;
    }
    fmt::print("A{}     {:>10.4g} {:>15.3g} {:>12.4g} .. {:<10.4g} N·m/rad   {:.1f} % by pose {}\n", j + 1,
               joint.stiffness * kNmPerNmm, joint.deviation * kNmPerNmm, joint.lower * kNmPerNmm,
               joint.upper * kNmPerNmm, 100 * joint.largest_change, joint.most_influential + 1);
  }
  PrintModels(models, found);
  fmt::print("\n{} measurements in {} poses; condition number {:.3g} (columns scaled to 1)\n",
             found.pose_of_case.size(), found.poses, found.condition);
  if (!found.residuals.empty()) PrintResiduals(found, judged, task);
  for (const std::string& warning : judged.warnings) fmt::print("warning    {}\n", warning);
  for (const std::string& finding : judged.findings) fmt::print("finding    {}\n", finding);
}

/// Half the width of a joint's 95 % interval as a share of its stiffness, in half percents; at most what a
/// cell may say.
double UncertaintyOf(const JointEstimate& joint) {
  constexpr double kMost = 0.9;
  const double half = std::max(joint.stiffness - joint.lower, joint.upper - joint.stiffness);
  return std::min(kMost, std::ceil(200 * half / joint.stiffness) / 200);
}

void CheckCellFile(const IdentifyWords& options, const Task& task) {
  std::error_code missing;  // is no other cell's name
  if (!std::filesystem::equivalent(task.cell_file, options.write_cell, missing))
    throw InputError({options.write_cell}, fmt::format("--write-cell: another cell than the one read, {}",
                                                       task.cell_file.string()));
}

void WriteCellFile(const IdentifyWords& options, const Task& task, const Identification& found) {
  IdentifiedStiffness written;
  written.stiffness = task.arm.stiffness;
  written.uncertainty = task.uncertainty;
  std::string kept;
  for (int j = 0; j < 6; ++j) {
    if (found.joints[j].determined) {
      written.stiffness[j] = found.joints[j].stiffness;
      written.uncertainty[j] = UncertaintyOf(found.joints[j]);
    } else
      kept += fmt::format(" A{}", j + 1);
  }
  // Four digits: no identification carries more.
  for (double& stiffness : written.stiffness) stiffness = WithDigits(stiffness, 4);
  written.source = "millpose identify " + std::filesystem::path(options.file).filename().string();
  if (!kept.empty()) written.source += ", but as before:" + kept;
  EditLooseFile(options.write_cell, [&](const std::string& text) {
    return ReplaceCompliances(ReplaceJointStiffness(text, options.write_cell, written), options.write_cell,
                              CompliancesOf(found));
  });
  const std::string note = kept.empty() ? "" : "; not determined and kept:" + kept;
  std::fputs(fmt::format("millpose: {} updated{}\n", options.write_cell, note).c_str(), stderr);
  if (const std::string beyond = NotWritten(found); !beyond.empty())
    std::fputs(fmt::format("millpose: {}\n", beyond).c_str(), stderr);
}

int Propose(const IdentifyWords& options, const Task& task) {
  const std::vector<LoadCase> candidates = MakeCases(task.settings, task.settings.candidates);
  if (candidates.empty()) throw InputError({options.file}, "--propose: the file has no `candidates`");
  const std::vector<size_t> chosen =
      ProposeLoadCases(task.arm, candidates, static_cast<size_t>(options.propose), task.options);
  std::vector<LoadCase> cases;
  for (const size_t i : chosen) cases.push_back(candidates[i]);
  const Identification quality = IdentifyJointStiffness(task.arm, cases, task.options);
  std::vector<int> blind;
  for (int j = 0; j < 6; ++j)
    if (quality.joints[j].reason.starts_with("not observable")) blind.push_back(j + 1);
  if (options.json) {
    Json list = Json::array();
    for (const size_t i : chosen)
      list.push_back({{"candidate", i + 1}, {"line", task.settings.candidates[i].line}});
    fmt::print("{}\n", Json{{"schema_version", 1},
                            {"chosen", list},
                            {"condition", quality.condition},
                            {"not_observable", blind}}
                           .dump(2));
  } else {
    fmt::print("{} of {} candidates, condition number {:.3g}\n", chosen.size(), candidates.size(),
               quality.condition);
    for (const size_t i : chosen)
      fmt::print("  candidate {:<4} line {}\n", i + 1, task.settings.candidates[i].line);
    for (const int joint : blind) fmt::print("A{} is not observable with any of them\n", joint);
  }
  return blind.empty() ? kDone : kFindings;
}

/// Of a file with readings taken both ways alone.
int IdentifyLostMotion(const IdentifyWords& options, const Task& task, const LostMotionEstimates& found) {
  if (!options.write_cell.empty())
    WriteLostMotion(options.write_cell, options.file, task.arm_settings, found);
  if (options.json)
    fmt::print("{}\n", Json{{"schema_version", 1}, {"lost_motion", LostMotionJson(found)}}.dump(2));
  else
    PrintLostMotion(found);
  return AllDetermined(task.settings, found) ? kDone : kFindings;
}

int Identify(const IdentifyWords& options) {
  const Task task = Load(options);
  if (options.propose >= 0) return Propose(options, task);
  if (!options.write_cell.empty()) CheckCellFile(options, task);
  if (!task.settings.two_way.empty()) {
    if (!task.settings.measurements.empty())
      throw InputError({options.file}, "given measurements and two_way; allowed: one of the two in a file");
    return IdentifyLostMotion(options, task, EstimateLostMotion(task.settings, task.arm_settings, task.arm));
  }
  if (task.settings.measurements.empty())
    throw InputError({options.file}, "no measurements; allowed: at least one, or two_way");
  const std::vector<LoadCase> cases = MakeCases(task.settings, task.settings.measurements);
  ComplianceModels models;
  if (options.springs)
    models.tried.emplace_back();
  else
    models = TryModels(task.arm, cases, task.options);
  IdentifyOptions with = task.options;
  with.beside = models.tried[models.chosen].gives;
  with.payload = models.tried[models.chosen].payload();
  const Identification found = IdentifyJointStiffness(task.arm, cases, with);
  const Plausibility judged = JudgeIdentification(task.arm, cases, with, found);
  if (options.json)
    fmt::print("{}\n", ToJson(found, models, judged, task).dump(2));
  else
    Print(found, models, judged, task);
  if (!options.write_cell.empty() && !judged.usable)
    fmt::print(stderr, "millpose: {} is unchanged: the measurements are not plausible\n", options.write_cell);
  if (!options.write_cell.empty() && judged.usable) WriteCellFile(options, task, found);
  const auto determined = [](const JointEstimate& joint) { return joint.determined; };
  return std::ranges::all_of(found.joints, determined) && judged.findings.empty() ? kDone : kFindings;
}

}  // namespace

void AddIdentifyCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "identify",
      "Joint stiffness, N·m/rad, from measured deflections under load (docs/identification.md), lost "
      "motion,\n"
      "arcmin, from readings taken both ways (docs/lost-motion.md), or with --geometry the arm's deviations "
      "from its\n"
      "sheet, mm and mrad, from a tracker's readings (docs/geometry-identification.md).\n"
      "Exit status 1: some joint could not be determined, or a finding on readings, stiffness, geometry or "
      "residual.");
  static IdentifyWords options;
  command->add_option("measurements", options.file, "Measurements, YAML or CSV")->required();
  command->add_option("--cell", options.cell,
                      "Cell YAML with the arm's geometry; default: the one the file names");
  command->add_option("--load-point-mm", options.load_point, "Where loads act, flange frame, mm")
      ->expected(3);
  command->add_option("--measured-point-mm", options.measured_point, "Measured point, flange frame, mm")
      ->expected(3);
  command->add_flag("--robust", options.robust, "Huber's weights against blunders");
  command->add_flag("--springs", options.springs,
                    "Springs in the joints alone; else links that tilt, a base that moves, lost motion and a "
                    "payload, where they foretell poses left out better");
  command
      ->add_option(
          "--propose", options.propose,
          "Choose this many of the file's candidates (D-optimal; 0: the fewest that show all joints); with "
          "--geometry further poses of the arm (1 or more)")
      ->check(CLI::Range(0, 1000));
  command->add_option("--write-cell", options.write_cell,
                      "Put the result into this cell file, keeping its comments");
  command->add_flag("--json", options.json, "Results as JSON on stdout");
  static GeometryWords geometry;
  static bool is_geometry = false;
  CLI::Option* const whether =
      command->add_flag("--geometry", is_geometry,
                        "The measurements are a tracker's: angles and reflectors (CSV); needs --cell");
  const auto with = [&](CLI::Option* option) { option->needs(whether); };
  static std::vector<std::string> more;
  with(command->add_option("--more", more, "Further readings, each file with the tracker somewhere else"));
  with(command->add_option("--foretell", geometry.foretell,
                           "Readings that are not fitted: how well the fit foretells them"));
  with(command
           ->add_option("--shift-prior-mm", geometry.shift_prior,
                        "How far an arm's frames are from its sheet, standard deviation")
           ->check(CLI::Range(1e-3, 10.0))
           ->capture_default_str());
  with(command->add_option("--turn-prior-mrad", geometry.turn_prior, "Likewise how much they are turned")
           ->check(CLI::Range(1e-3, 20.0))
           ->capture_default_str());
  with(command->add_flag("--weight", geometry.weight,
                         "The arm sags by its weight, as stiffness.gravity of the cell says"));
  with(command->add_option("--serial", geometry.serial, "Serial number of the arm, for --write-cell"));
  with(command->add_option("--date", geometry.date, "Day of the readings, year-month-day, for --write-cell"));
  command->callback([&run, whether] {
    if (whether->count() == 0) {
      run = [](Session&) { return Identify(options); };
      return;
    }
    run = [](Session&) {
      geometry.files = {options.file};
      geometry.files.insert(geometry.files.end(), more.begin(), more.end());
      geometry.cell = options.cell;
      geometry.write_cell = options.write_cell;
      geometry.propose = options.propose;
      geometry.json = options.json;
      if (options.robust || options.springs || !options.load_point.empty() || !options.measured_point.empty())
        throw InputError(
            SourceLocation{},
            "--geometry: --robust, --springs, --load-point-mm and --measured-point-mm have no effect "
            "with it");
      return IdentifyGeometry(geometry);
    };
  });
}

}  // namespace millpose
