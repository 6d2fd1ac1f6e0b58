// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/loose_file.hpp"
#include "base/process.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/setup_of_folder.hpp"
#include "run/pipeline/commands/summary_of_folder.hpp"

namespace millpose {
namespace {

struct ReportWords {
  SetupArguments arguments;
  std::filesystem::path job, html, pdf;
  bool summary = false;
};

/// The page on paper, by weasyprint.
std::string Printed(const std::string& html, std::stop_token stop) {
  const auto printed = [&] {
    try {
      return RunProcess({"weasyprint", "-", "-"}, stop, html);
    } catch (const InputError&) {
      throw InputError(
          SourceLocation{},
          "--pdf: weasyprint is not installed; allowed: `apt-get install weasyprint` once, or --html and a "
          "browser's print");
    }
  }();
  if (printed.status != 0 || !printed.output.starts_with("%PDF"))
    throw InputError(SourceLocation{},
                     fmt::format("--pdf: weasyprint ended with {}: {}", printed.status, printed.errors));
  return printed.output;
}

int Report(const ReportWords& words, Session& session) {
  if (words.html.empty() && words.pdf.empty())
    throw InputError(SourceLocation{}, "--html FILE or --pdf FILE: missing; needed: at least one of them");
  SetupArguments arguments = words.arguments;
  if (!words.job.empty()) arguments.job = words.job;
  const std::string html =
      words.summary ? SummaryOfFolder(arguments) : SetupOfFolder(arguments, session.stop);
  const std::string pdf = words.pdf.empty() ? std::string() : Printed(html, session.stop);
  if (!words.html.empty()) WriteLooseFile(words.html, html);
  if (!words.pdf.empty()) WriteLooseFile(words.pdf, pdf);
  return kDone;
}

}  // namespace

void AddReportCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "report",
      "A plan on paper: its setup sheet for the workshop (picture, datum, tools, fixtures, "
      "programs in their order, what to do before a first run: docs/setup-sheet.md), or two "
      "pages to be signed (docs/summary-sheet.md)");
  const auto words = std::make_shared<ReportWords>();
  command->add_option("DIR", words->arguments.plan, "Output folder of millpose plan")->required();
  command->add_flag("--summary", words->summary,
                    "Two pages to be signed in place of the setup sheet: done or not and why, cycle time, "
                    "clearance, the face's error, stiffness along the path, findings, programs with hashes");
  command->add_option("--html", words->html, "Write it to this file, a page without scripts");
  command->add_option("--pdf", words->pdf, "Write it to this file, A4; needs weasyprint");
  command->add_option("--job", words->job, "Its job file, if that is not next to the folder");
  const LanguageOption language = AddLanguageOption(*command);
  const RootOption root = AddRootOption(*command);
  command->callback([&run, words, language, root] {
    run = [words, language, root](Session& session) {
      words->arguments.language = ParseLanguage(*language);
      words->arguments.root = FileRoot::Of(*root);
      return Report(*words, session);
    };
  });
}

}  // namespace millpose
