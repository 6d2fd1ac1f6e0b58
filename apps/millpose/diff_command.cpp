// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/loose_file.hpp"
#include "base/text.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/diff_page.hpp"

namespace millpose {
namespace {

struct DiffWords {
  DiffArguments arguments;
  std::vector<std::string> fail_on;
  bool json = false;
  std::filesystem::path page;
  Language language = Language::kEnglish;  // of the page
};

/// A section, any, or FIGURE:PERCENT.
struct FailRule {
  std::string text;  // as it was given
  std::string of;
  std::optional<double> percent;

  bool Holds(const Change& change) const {
    if (percent) return change.what == of && (!change.by || 100 * std::abs(*change.by) > *percent);
    return of == "any" || change.section == of;
  }
};

FailRule ParseRule(const std::string& text) {
  const size_t colon = text.rfind(':');
  if (colon == std::string::npos) {
    if (text == "any" || std::ranges::find(kDiffSections, text) != kDiffSections.end())
      return {text, text, {}};
  } else if (const std::optional<double> percent = ParseNumber(text.substr(colon + 1));
             percent && *percent >= 0) {
    return {text, text.substr(0, colon), percent};
  }
  throw InputError(
      SourceLocation{},
      fmt::format("--fail-on: given {}; allowed: any, {}, or FIGURE:PERCENT like clearance_min_mm:10", text,
                  fmt::join(kDiffSections, ", ")));
}

// A rule for a figure that neither plan has would hold for ever.
void RefuseUnknown(const std::vector<FailRule>& rules, const std::set<std::string>& figures) {
  for (const FailRule& rule : rules)
    if (rule.percent && !figures.contains(rule.of))
      throw InputError(SourceLocation{},
                       "--fail-on: " + UnknownName("figure", rule.of, {figures.begin(), figures.end()}));
}

// "fails      --fail-on cycle_times.krl.total_s:2 (23.4 %)", a line for each rule that is broken.
void TellBroken(const std::vector<FailRule>& rules, const std::vector<Change>& changes) {
  for (const FailRule& rule : rules) {
    std::optional<double> largest;
    size_t count = 0;
    for (const Change& change : changes) {
      if (!rule.Holds(change)) continue;
      ++count;
      if (change.by) largest = std::max(largest.value_or(0), 100 * std::abs(*change.by));
    }
    if (count == 0) continue;
    const std::string why = rule.percent && largest ? fmt::format("{:.3g} %", *largest)
                                                    : fmt::format("{} line{}", count, count == 1 ? "" : "s");
    fmt::print("fails      --fail-on {} ({})\n", rule.text, why);
  }
}

int Differ(const DiffWords& words) {
  std::vector<FailRule> rules;
  for (const std::string& text : words.fail_on) rules.push_back(ParseRule(text));
  const auto [changes, figures] = DiffFolders(words.arguments);
  RefuseUnknown(rules, figures);
  bool fails = false;
  std::vector<bool> each;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Change& change : changes) {
    const bool broken = std::ranges::any_of(rules, [&](const FailRule& rule) { return rule.Holds(change); });
    fails = fails || broken;
    each.push_back(broken);
    if (!words.json) fmt::print("{}\n", change.Text());
    nlohmann::ordered_json one{{"section", change.section},
                               {"what", change.what},
                               {"before", change.before},
                               {"after", change.after}};
    if (change.by) one["by_percent"] = 100 * *change.by;
    if (!change.operation.empty()) one["operation"] = change.operation;
    one["fails"] = broken;
    list.push_back(std::move(one));
  }
  if (!words.page.empty())
    WriteLooseFile(words.page, DiffPage(words.arguments, changes, each, words.page, words.language));
  if (words.json)
    fmt::print("{}\n", nlohmann::ordered_json{{"before", words.arguments.before.string()},
                                              {"after", words.arguments.after.string()},
                                              {"changes", list}}
                           .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else if (changes.empty())
    fmt::print("no difference\n");
  else
    TellBroken(rules, changes);
  return fails ? kFindings : kDone;
}

}  // namespace

void AddDiffCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("diff",
                                         "What two plans differ in: settings, points, poses, figures, "
                                         "findings, programs by motion (docs/diff.md)");
  const auto words = std::make_shared<DiffWords>();
  command->add_option("BEFORE", words->arguments.before, "Output folder of millpose plan or batch")
      ->required();
  command->add_option("AFTER", words->arguments.after, "The other")->required();
  command
      ->add_option(
          "--fail-on", words->fail_on,
          "End with status 1 where such a thing differs: any, settings, points, poses, figures, findings, "
          "programs, or FIGURE:PERCENT, like clearance_min_mm:10; may be given again")
      ->allow_extra_args(false);
  command->add_flag("--json", words->json, "As JSON");
  command->add_option("--html", words->page, "Write it to this file as a page too, both plans side by side");
  const LanguageOption language = AddLanguageOption(*command);
  const RootOption root = AddRootOption(*command);
  command->callback([&run, words, language, root] {
    run = [words, language, root](Session&) {
      words->language = ParseLanguage(*language);
      words->arguments.root = FileRoot::Of(*root);
      return Differ(*words);
    };
  });
}

}  // namespace millpose
