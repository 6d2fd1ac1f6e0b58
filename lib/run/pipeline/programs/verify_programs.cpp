// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/verify_programs.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/units.hpp"
#include "program/verify/causes.hpp"
#include "run/pipeline/programs/planned_folder.hpp"
#include "run/pipeline/programs/verify_alone.hpp"
#include "store/manifest.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

std::vector<VerifiedProgram> VerifyFolder(const VerifyArguments& arguments, const Execution& execution) {
  std::vector<std::string> changed;
  const Manifest manifest = CheckManifest(arguments.target, &changed);
  std::vector<VerifiedProgram> programs =
      PlannedFolder(arguments.target, manifest, arguments, execution).HoldAll();
  if (programs.empty())
    throw InputError(SourceLocation{arguments.target.string(), 0, 0, -1}, "the folder holds no programs");
  return programs;
}

/// A program, wherever it is, against the plan of a folder.
std::vector<VerifiedProgram> VerifyAgainst(const VerifyArguments& arguments, const Execution& execution) {
  const fs::path& folder = *arguments.plan;
  std::vector<std::string> changed;
  const Manifest manifest = CheckManifest(folder, &changed);
  return {PlannedFolder(folder, manifest, arguments, execution).Hold(arguments.target)};
}

}  // namespace

std::vector<VerifiedProgram> VerifyPrograms(const VerifyArguments& arguments, Progress& progress,
                                            std::stop_token stop) {
  const Execution execution{arguments.threads, progress, std::move(stop)};
  if (arguments.plan) return VerifyAgainst(arguments, execution);
  return fs::is_directory(arguments.target) ? VerifyFolder(arguments, execution)
                                            : VerifyAlone(arguments, execution);
}

namespace {

const char* WordsOfVerdict(const VerifiedProgram& program) {
  if (!program.findings.empty()) return "NOT confirmed";
  if (program.but_for)
    return program.changed.empty() ? "confirmed but for a stated gap"
                                   : "changed since, still as planned but for a stated gap";
  return program.changed.empty() ? "confirmed" : "changed since, still as planned";
}

nlohmann::ordered_json ButForJson(const std::optional<CornerBound>& bound) {
  if (!bound) return nullptr;
  return {{"what", "corner"},
          {"bound_mm", bound->position},
          {"bound_deg", bound->angle * kDegPerRad},
          {"assumption", bound->assumption}};
}

bool Assumes(const VerifiedProgram& program, const std::string& assumption) {
  return std::ranges::find(program.assumptions, assumption) != program.assumptions.end();
}

/// Of which programs an assumption is, where it is not of all: a controller's name stands for all of its own.
std::string AssumedOf(const std::vector<VerifiedProgram>& programs, const std::string& assumption) {
  std::vector<std::string> names;
  for (const VerifiedProgram& program : programs) {
    if (!Assumes(program, assumption)) continue;
    const bool of_all = std::ranges::all_of(programs, [&](const VerifiedProgram& other) {
      return other.controller != program.controller || Assumes(other, assumption);
    });
    const std::string name = of_all ? program.controller : program.file;
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What was assumed of the programs, each said once: programs to start again with assume the same.
std::string AssumedText(const std::vector<VerifiedProgram>& programs) {
  std::string text;
  std::vector<std::string> told;
  for (const VerifiedProgram& program : programs)
    for (const std::string& assumption : program.assumptions) {
      if (std::ranges::find(told, assumption) != told.end()) continue;
      told.push_back(assumption);
      const bool of_all = std::ranges::all_of(
          programs, [&](const VerifiedProgram& other) { return Assumes(other, assumption); });
      text += fmt::format("  assumed{}: {}\n", of_all ? "" : " of " + AssumedOf(programs, assumption),
                          assumption);
    }
  return text;
}

}  // namespace

std::string VerifyText(const std::vector<VerifiedProgram>& programs) {
  std::string text;
  for (const VerifiedProgram& program : programs) {
    text += fmt::format("{:<10} {:>7} motions  {}  {}\n", program.controller, program.motions,
                        WordsOfVerdict(program), program.file);
    if (!program.changed.empty())
      text += fmt::format("  changed since they were written: {}\n", fmt::join(program.changed, ", "));
    if (program.but_for) text += "  not known: " + Describe(*program.but_for) + "\n";
    if (!program.scope.empty()) text += "  compared: " + program.scope + "\n";
    for (const CauseGroup& group : GroupByCause(program.findings)) {
      text += fmt::format("  {}; what helps: {}\n", Describe(group), Cure(group.cause, program.controller));
      for (const Finding& finding : program.findings) {
        if (finding.cause != group.cause) continue;
        text += fmt::format("  {}:{}: {}\n", finding.file, finding.line, finding.message);
      }
    }
  }
  return text + AssumedText(programs);
}

std::string VerifyJson(const std::vector<VerifiedProgram>& programs) {
  nlohmann::ordered_json json = {{"schema_version", 1}, {"programs", nlohmann::ordered_json::array()}};
  for (const VerifiedProgram& program : programs) {
    nlohmann::ordered_json findings = nlohmann::ordered_json::array();
    for (const Finding& finding : program.findings) {
      findings.push_back({{"file", finding.file}, {"line", finding.line}, {"message", finding.message}});
    }
    json["programs"].push_back({{"controller", program.controller},
                                {"file", program.file},
                                {"motions", program.motions},
                                {"confirmed", program.findings.empty()},
                                {"changed", program.changed},
                                {"scope", program.scope.empty() ? "the plan" : program.scope},
                                {"but_for", ButForJson(program.but_for)},
                                {"findings", findings},
                                {"assumptions", program.assumptions}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
