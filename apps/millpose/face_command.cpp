// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/loose_file.hpp"
#include "base/units.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/face_of_folder.hpp"

namespace millpose {
namespace {

struct FaceWords {
  FaceArguments arguments;
  std::filesystem::path job, csv;
  std::optional<double> rotation_deg, lost_motion_arcmin;
  int threads = 0;
  bool json = false;
  Language language = Language::kEnglish;  // of the text
};

int Face(const FaceWords& words, Session& session) {
  FaceArguments arguments = words.arguments;
  if (!words.job.empty()) arguments.job = words.job;
  if (words.rotation_deg) arguments.options.rotation = DegToRad(*words.rotation_deg);
  if (words.lost_motion_arcmin) arguments.options.lost_motion = DegToRad(*words.lost_motion_arcmin / 60);
  session.progress.Begin("face", 0);
  const FaceReport report = FaceOfFolder(arguments, {words.threads, session.progress, session.stop});
  session.progress.End(fmt::format("{} places", report.plan.expected.figures.rays));
  if (!words.csv.empty()) WriteLooseFile(words.csv, FaceCsv(report.rays, report.plan.expected.heights));
  fmt::print("{}", words.json ? FaceJson(report) : FaceText(report, words.language));
  return kDone;
}

}  // namespace

void AddFaceCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("face",
                                         "The face that a plan will leave: material taken off by the tool as "
                                         "it is expected to err, beside the best "
                                         "fixed rotation's (docs/face.md)");
  const auto words = std::make_shared<FaceWords>();
  FaceOptions& options = words->arguments.options;
  command->add_option("DIR", words->arguments.plan, "Output folder of millpose plan")->required();
  command->add_option("--job", words->job, "Its job file, if that is not next to the folder");
  command
      ->add_option(
          "--spacing-mm", options.spacing,
          "Distance of the places at which the face is looked at; default: 0.5, or what makes 200,000 "
          "places")
      ->check(CLI::Range(1e-3, 1e3))
      ->default_str("");
  command->add_option("--draws", options.draws, "Faces drawn within what is stated; 0: none")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command
      ->add_option("--rotation-deg", words->rotation_deg,
                   "Compare with this fixed rotation about the tool axis in place of the job's best")
      ->check(CLI::Range(-360.0, 360.0));
  command
      ->add_option("--lost-motion-arcmin", words->lost_motion_arcmin,
                   "Lost motion of each of the arm's gears in place of what the cell states")
      ->check(CLI::Range(0.0, 60.0));
  command->add_option("--csv", words->csv,
                      "Write the expected face as measured points, which `flatness` and `calibrate` read");
  command->add_option("--threads", words->threads, "Threads; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--json", words->json, "JSON on standard output");
  const LanguageOption language = AddLanguageOption(*command);
  command->callback([&run, words, language] {
    run = [words, language](Session& session) {
      words->language = ParseLanguage(*language);
      return Face(*words, session);
    };
  });
}

}  // namespace millpose
