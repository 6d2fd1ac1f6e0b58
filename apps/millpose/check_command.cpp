// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.hpp"
#include "commands.hpp"
#include "run/pipeline/operations/check_job.hpp"

namespace millpose {
namespace {

struct CheckOptions {
  std::filesystem::path file;
  UnitOption unit;
  double weld_tolerance = 1e-4, chord_tolerance = 0.05;
  int threads = 0;
  double max_points = 2e6;
  bool json = false;
  std::string view;
  std::filesystem::path split;
  std::vector<std::string> changes;
  double advise_um = 0, spindle_kW = 0;  ///< 0: not asked for
  RootOption root;
  LanguageOption language;
};

template <class Check>
int Tell(const Check& check, bool json) {
  fmt::print("{}", json ? ToJson(check) : ToText(check));
  return HasFindings(check) ? kFindings : kDone;
}

int TellJob(const std::vector<JobCheck>& checks, const CheckOptions& options) {
  if (checks.size() == 1 && checks.front().operation.empty()) return Tell(checks.front(), options.json);
  if (options.json) {
    fmt::print("{}", ToJson(checks));
  } else {
    for (size_t i = 0; i < checks.size(); ++i) {
      fmt::print("{}{}", i > 0 ? "\n" : "", ToText(checks[i]));
      if (!options.view.empty())
        fmt::print("page                {}\n", ViewOf(options.view, i, checks[i].operation).string());
    }
  }
  return std::ranges::any_of(checks, [](const JobCheck& check) { return HasFindings(check); }) ? kFindings
                                                                                               : kDone;
}

void RefuseChanges(const CheckOptions& options) {
  for (const auto& [given, flag] :
       {std::pair(!options.changes.empty(), "--set"), std::pair(options.advise_um > 0, "--advise-um")})
    if (given)
      throw InputError(SourceLocation{},
                       fmt::format("{}: has no effect here; allowed: with a job (.yaml)", flag));
}

/// What of a job's cuts may be larger, beside what else is told of it.
void AddAdvice(const std::filesystem::path& job, const CheckOptions& options,
               const std::vector<Override>& overrides, const FileRoot& root, Session& session,
               std::vector<JobCheck>& checks) {
  constexpr double kMillimetres = 1e-3, kWatts = 1e3;
  if (options.advise_um <= 0) return;
  AdviseLimits limits{kMillimetres * options.advise_um, {}};
  if (options.spindle_kW > 0) limits.power = kWatts * options.spindle_kW;
  const std::vector<OperationAdvice> advices =
      Advise(job, overrides, limits, options.threads, root, session.progress, session.stop);
  for (size_t i = 0; i < checks.size(); ++i) checks[i].advice = advices[i];
}

int Check(const CheckOptions& options, Session& session) {
  const std::string extension = options.file.extension().string();
  const FileRoot root = FileRoot::Of(*options.root);
  const Language language = ParseLanguage(*options.language);
  const ViewFile view = options.view.empty() ? ViewFile() : ViewFile({options.view, language});
  if (extension == ".yaml" || extension == ".yml") {
    if (IsCellFile(options.file, root)) {
      RefuseChanges(options);
      return Tell(CheckCell({options.file, root, view}), options.json);
    }
    std::filesystem::path job = options.file;
    if (!options.split.empty()) {
      const std::vector<std::string> names = WriteSplitJob(job, options.split, root);
      job = options.split;
      if (!options.json) fmt::print("wrote               {}: {}\n", job.string(), fmt::join(names, ", "));
    }
    CheckJobArguments arguments{options.threads, options.max_points, view, {}};
    for (const std::string& change : options.changes) arguments.overrides.push_back(ParseOverride(change));
    std::vector<JobCheck> checks = CheckOperations(job, arguments, root, session.progress, session.stop);
    AddAdvice(job, options, arguments.overrides, root, session, checks);
    return TellJob(checks, options);
  }
  RefuseChanges(options);
  if (!options.split.empty())
    throw InputError(SourceLocation{}, "--split: needs a job (.yaml) that names a CAM file");
  return Tell(CheckMesh({options.file, MillimetresOf(options.unit), options.weld_tolerance,
                         options.chord_tolerance, root, view},
                        session.progress, session.stop),
              options.json);
}

}  // namespace

void AddCheckCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "check", "Describe a mesh, a cell, or a job's part, tool path and reach; plans nothing but for advice");
  const auto options = std::make_shared<CheckOptions>();
  command
      ->add_option("FILE", options->file, "Job or cell (.yaml) or part (STL, OBJ, PLY, OFF, STEP, IGES, 3MF)")
      ->required();
  options->unit = AddUnitOption(*command);
  command
      ->add_option("--chord-tolerance-mm", options->chord_tolerance,
                   "Of a STEP or IGES part: distance between its faces and their triangles")
      ->check(CLI::Range(1e-4, 100.0))
      ->capture_default_str();
  command
      ->add_option("--weld-tolerance-mm", options->weld_tolerance,
                   "Vertices of a mesh nearer than this become one")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--view", options->view,
                      "Write what was checked as a page (HTML) to this file: cell, part, faces and edges to "
                      "click, tool path, reach; of several operations one each, FILE_01_NAME.html and so on");
  command->add_option(
      "--split", options->split,
      "Of a job that names a CAM file for several tools or speeds: write it with an operation "
      "for each, in the file's order, to this file beside it, and check that");
  command->add_option("--set", options->changes,
                      "KEY=VALUE: a setting in place of the job's, like toolpath.stepover_mm=4");
  CLI::Option* advise =
      command
          ->add_option(
              "--advise-um", options->advise_um,
              "Largest depth and step-over for which the mean cutting force moves the tip by no more "
              "than this; plans the job several times (docs/advise.md)")
          ->check(CLI::Range(0.001, 1e5));
  command
      ->add_option("--spindle-kW", options->spindle_kW,
                   "With --advise-um: power that the spindle may give to the cut")
      ->check(CLI::Range(0.001, 1e4))
      ->needs(advise);
  command->add_flag("--json", options->json, "Results as JSON on stdout");
  command->add_option("--max-points", options->max_points, "Points that the tool path of a job may have")
      ->check(CLI::Range(1.0, 1e9))
      ->capture_default_str();
  options->language = AddLanguageOption(*command);
  options->root = AddRootOption(*command);
  command->callback(
      [&run, options] { run = [options](Session& session) { return Check(*options, session); }; });
}

}  // namespace millpose
