// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/loose_file.hpp"
#include "base/student.hpp"
#include "base/units.hpp"
#include "base/yaml/edit.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/register_part.hpp"

namespace millpose {
namespace {

struct RegisterWords {
  std::string job, faces, edges, holes, targets, write_job;
  double sd = 0, radius = -1;
  int propose = 3, threads = 0;
  bool json = false;
};

nlohmann::ordered_json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// 95 % interval of a mode to either side, mm.
double ModeInterval(const Registration& bent, size_t mode) {
  const auto at = static_cast<Eigen::Index>(6 + mode);
  return kNormal95 * std::sqrt(bent.covariance(at, at));
}

nlohmann::ordered_json BendingJson(const RegisteredPart& part) {
  if (!part.bent) return nullptr;
  const BentRegistration& bent = *part.bent;
  nlohmann::ordered_json modes, intervals;
  for (size_t i = 0; i < bent.found.bending->modes.size(); ++i) {
    modes[kModeNames[i]] = bent.found.bending->modes[i];
    intervals[kModeNames[i]] = ModeInterval(bent.found, i);
  }
  return {{"applied", part.found.bending.has_value()},
          {"largest_mm", bent.largest},
          {"largest_mm_95", bent.largest_95},
          {"slope", bent.slope},
          {"p", bent.p},
          {"modes_mm", modes},
          {"modes_mm_95", intervals}};
}

nlohmann::ordered_json ToJson(const RegisteredPart& part) {
  using Object = nlohmann::ordered_json;
  constexpr double kMicrometre = 1000;
  const bool known = part.found.determined();
  const auto or_null = [](bool is, double value) { return is ? Object(value) : Object(nullptr); };
  Object outliers = Object::array(), next = Object::array(), covariance = Object::array();
  for (const ProbeOutlier& outlier : part.outliers)
    outliers.push_back({{"file", outlier.file},
                        {"line", outlier.line},
                        {"distance_mm", outlier.distance},
                        {"standard_deviations", outlier.standardised}});
  for (const ProposedPlace& place : part.next)
    next.push_back({{"place_mm", VectorJson(place.place.position)},
                    {"normal", VectorJson(place.place.normal)},
                    {"face_um_95", kMicrometre * place.off_95}});
  const auto unknowns = static_cast<int>(part.found.covariance.rows());
  for (int i = 0; i < unknowns; ++i) {
    Object row = Object::array();
    for (int j = 0; j < unknowns; ++j) row.push_back(part.CovarianceMrad(i, j));
    covariance.push_back(row);
  }
  return {{"schema_version", 1},
          {"points", part.points},
          {"outliers", outliers},
          {"rms_mm", part.rms},
          {"scatter", part.found.scatter},
          {"pose",
           {{"xyz_mm", VectorJson(part.pose.position)}, {"abc_deg", VectorJson(kDegPerRad * part.pose.abc)}}},
          {"centre_mm", VectorJson(part.found.centre)},
          {"covariance_mm_mrad", known ? covariance : Object(nullptr)},
          {"bending", BendingJson(part)},
          {"max_bending_mm", or_null(part.max_bending.has_value(), part.max_bending.value_or(0))},
          {"moved_mm", part.moved},
          {"milling_points", part.milled},
          {"face_um_95", or_null(known, kMicrometre * part.error.off_95)},
          {"face_um_50", or_null(known, kMicrometre * part.error.median_off)},
          {"beside_um_95", or_null(known, kMicrometre * part.error.beside_95)},
          {"worst_place_mm", VectorJson(part.worst.position)},
          {"tolerance_um", or_null(part.tolerance.has_value(), kMicrometre * part.tolerance.value_or(0))},
          {"probe_next", next},
          {"findings", part.findings}};
}

std::string PlaceText(const Eigen::Vector3d& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z());
}

void PrintBending(const RegisteredPart& part) {
  if (!part.bent) return;
  const BentRegistration& bent = *part.bent;
  fmt::print("bent           {:>8.3f} ± {:.3f} mm at the farthest (95 %; by chance: p {:.1g}), {}\n",
             bent.largest, bent.largest_95, bent.p,
             part.found.bending ? "which the figures below count with"
                                : "which the job does not allow: the figures below are of a rigid part");
  for (size_t i = 0; i < bent.found.bending->modes.size(); ++i)
    fmt::print("{}{:<4} {:>+8.3f} ± {:.3f} mm\n", i == 0 ? "  modes        " : "               ",
               kModeNames[i], bent.found.bending->modes[i], ModeInterval(bent.found, i));
}

void Print(const RegisteredPart& part) {
  constexpr size_t kTold = 20;
  constexpr double kMicrometre = 1000;
  fmt::print("points         {:>8}   {} outlier{} among them, left out\n", part.points, part.outliers.size(),
             part.outliers.size() == 1 ? "" : "s");
  fmt::print("distances      {:>8.3f} mm RMS; they scatter {:.2f} times as much as stated{}\n", part.rms,
             part.found.scatter,
             part.found.scatters_more ? ": more than chance explains; the figures below count with it" : "");
  fmt::print("pose           {}\n", part.PoseYaml());
  PrintBending(part);
  fmt::print("moved          {:>8.3f} mm, the farthest milling point from where the job had it\n",
             part.moved);
  if (part.found.determined()) {
    fmt::print(
        "face           {:>8.0f} µm that it may be off along its normal (95 %), over {} milling points\n",
        kMicrometre * part.error.off_95, part.milled);
    fmt::print("               {:>8.0f} µm in half of all cases; worst known at {}\n",
               kMicrometre * part.error.median_off, PlaceText(part.worst.position));
    fmt::print("               {:>8.0f} µm beside its normal (95 %)\n", kMicrometre * part.error.beside_95);
  }
  for (size_t i = 0; i < std::min(kTold, part.outliers.size()); ++i)
    fmt::print("outlier        {}:{}: {:+.3f} mm, {:.1f} standard deviations\n", part.outliers[i].file,
               part.outliers[i].line, part.outliers[i].distance, part.outliers[i].standardised);
  if (part.outliers.size() > kTold) fmt::print("outlier        {} more\n", part.outliers.size() - kTold);
  for (const ProposedPlace& next : part.next)
    fmt::print("probe next     {} along ({:.2f}, {:.2f}, {:.2f}): then {:.0f} µm\n",
               PlaceText(next.place.position), next.place.normal.x(), next.place.normal.y(),
               next.place.normal.z(), kMicrometre * next.off_95);
  for (const std::string& finding : part.findings) fmt::print("finding        {}\n", finding);
}

int RunRegister(const RegisterWords& words, Session& session) {
  const auto file = [](const std::string& name) -> std::optional<std::filesystem::path> {
    return name.empty() ? std::nullopt : std::optional<std::filesystem::path>(name);
  };
  RegisterArguments arguments;
  arguments.job = words.job;
  arguments.faces = file(words.faces), arguments.edges = file(words.edges);
  arguments.holes = file(words.holes), arguments.targets = file(words.targets);
  if (words.sd > 0) arguments.sd = words.sd;
  if (words.radius >= 0) arguments.radius = words.radius;
  arguments.propose = words.propose;
  const RegisteredPart part = RegisterPart(arguments, {words.threads, session.progress, session.stop});
  if (words.json)
    fmt::print("{}\n", ToJson(part).dump(2));
  else
    Print(part);
  if (!part.usable()) {
    if (!words.write_job.empty())
      fmt::print(stderr, "millpose: {} is unchanged: the part's place is not known well enough\n",
                 words.write_job);
    return kFindings;
  }
  if (words.write_job.empty()) {
    if (!words.json) fmt::print("\nfor the job: workpiece.pose: {}\n", part.PoseYaml());
    return kDone;
  }
  EditLooseFile(words.write_job, [&](const std::string& text) {
    const std::string placed = yaml::WithKey(text, words.write_job, "workpiece", "pose", part.PoseYaml());
    return yaml::WithKey(placed, words.write_job, "workpiece", "registered", part.RegisteredYaml());
  });
  fmt::print(stderr, "millpose: {} updated: workpiece.pose, workpiece.registered\n", words.write_job);
  return kDone;
}

}  // namespace

void AddRegisterCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "register",
      "Where the part stands, from probed points: its pose with covariance, by how much the milled face may "
      "be "
      "off, outliers, bending where the points ask for it, where to probe next (docs/registration.md).\n"
      "Exit status 1: not known well enough, or not to workpiece.registration.tolerance_mm; bent by more "
      "than "
      "max_bending_mm there allows.");
  const auto words = std::make_shared<RegisterWords>();
  command->add_option("JOB", words->job, "Job file (YAML) whose workpiece.pose is roughly right")->required();
  command->add_option("--probe", words->faces,
                      "CSV of points on faces: x_mm,y_mm,z_mm in workpiece.frame, the centre of the probe's "
                      "ball; at will sd_mm, radius_mm and the face's normal nx,ny,nz");
  command->add_option("--edges", words->edges, "CSV of points on sharp edges or rims: x_mm,y_mm,z_mm; sd_mm");
  command->add_option("--holes", words->holes, "CSV of centres of round holes: x_mm,y_mm,z_mm; sd_mm");
  command->add_option("--targets", words->targets,
                      "CSV of targets: nominal_x_mm,nominal_y_mm,nominal_z_mm in the workpiece's frame, "
                      "x_mm,y_mm,z_mm; sd_mm");
  command
      ->add_option("--sd-mm", words->sd,
                   "Standard deviation of a coordinate, mm, of points whose file gives none")
      ->check(CLI::Range(1e-4, 100.0))
      ->default_str("");
  command
      ->add_option("--tool-radius-mm", words->radius,
                   "Radius of the probe's ball, mm, likewise; 0: the points lie on the face itself")
      ->check(CLI::Range(0.0, 100.0))
      ->default_str("");
  command->add_option("--propose", words->propose, "How many places to probe next")
      ->check(CLI::Range(0, 100));
  command->add_option("--threads", words->threads, "Threads; 0: all cores")->check(CLI::Range(0, 1024));
  command->add_option("--write-job", words->write_job,
                      "Put pose and covariance into this job file, keeping its comments");
  command->add_flag("--json", words->json, "Results as JSON on stdout");
  command->callback(
      [&run, words] { run = [words](Session& session) { return RunRegister(*words, session); }; });
}

}  // namespace millpose
