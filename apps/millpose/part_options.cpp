// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <string>

#include "commands.hpp"

namespace millpose {

RootOption AddRootOption(CLI::App& command) {
  auto folder = std::make_shared<std::optional<std::filesystem::path>>();
  command.add_option(
      "--root", *folder,
      "For jobs of others: no file outside of this folder is read, none that a job names is written "
      "outside of it; symbolic links are followed first");
  return folder;
}

LanguageOption AddLanguageOption(CLI::App& command) {
  auto language = std::make_shared<std::string>("en");
  command.add_option("--lang", *language, "Language of pages and of the summary: en, de, zh")
      ->type_name("LANGUAGE");
  return language;
}

UnitOption AddUnitOption(CLI::App& command) {
  auto unit = std::make_shared<std::string>();
  command.add_option("--unit", *unit, "Unit of a part: mm, cm, in, m; by default the file's, else mm")
      ->check(CLI::IsMember({"mm", "cm", "in", "m"}));
  return unit;
}

std::optional<double> MillimetresOf(const UnitOption& unit) {
  static const std::map<std::string, double> kUnits{{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"m", 1000}};
  return unit->empty() ? std::nullopt : std::optional(kUnits.at(*unit));
}

}  // namespace millpose
