// SPDX-License-Identifier: GPL-3.0-or-later
// The table of subcommands. Each stands in a file of its own, adds its options and sets `run`.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "base/progress.hpp"

namespace millpose {

/// Exit statuses of every subcommand.
enum Status : int { kDone = 0, kFindings = 1, kBadInput = 2, kInternalError = 3, kInterrupted = 130 };

/// What a subcommand gets from main.
struct Session {
  Progress& progress;
  std::stop_token stop;
  std::function<void(const std::string& what)> doing;  ///< shows what the running stage is at
  /// Who knows how long it will still take, s; empty: nobody.
  std::function<void(std::function<std::optional<double>()>)> left_by;
};

/// What a subcommand leaves to be run after parsing; set by the callback of the chosen one.
using Run = std::function<int(Session&)>;

/// The option --root of the commands that run other people's jobs; empty when it is not given.
using RootOption = std::shared_ptr<std::optional<std::filesystem::path>>;
RootOption AddRootOption(CLI::App& command);

/// The option --unit of the commands that read a part; its value in mm, none when it is not given.
using UnitOption = std::shared_ptr<std::string>;
UnitOption AddUnitOption(CLI::App& command);
std::optional<double> MillimetresOf(const UnitOption& unit);

/// The option --lang of the commands that write pages; read by ParseLanguage when the command runs.
using LanguageOption = std::shared_ptr<std::string>;
LanguageOption AddLanguageOption(CLI::App& command);

void AddBatchCommand(CLI::App& app, Run& run);
void AddCalibrateCommand(CLI::App& app, Run& run);
void AddCellsCommand(CLI::App& app, Run& run);
void AddCheckCommand(CLI::App& app, Run& run);
void AddCleanCommand(CLI::App& app, Run& run);
void AddCompletionCommand(CLI::App& app, Run& run);
void AddDiffCommand(CLI::App& app, Run& run);
void AddExportCommand(CLI::App& app, Run& run);
void AddFaceCommand(CLI::App& app, Run& run);
void AddFlatnessCommand(CLI::App& app, Run& run);
void AddIdentifyCommand(CLI::App& app, Run& run);
void AddInitCommand(CLI::App& app, Run& run);
void AddInspectCommand(CLI::App& app, Run& run);
void AddManCommand(CLI::App& app, Run& run);
void AddPlaceCommand(CLI::App& app, Run& run);
void AddPlanCommand(CLI::App& app, Run& run);
void AddRegisterCommand(CLI::App& app, Run& run);
void AddReportCommand(CLI::App& app, Run& run);
void AddSchemaCommand(CLI::App& app, Run& run);
void AddStiffnessCommand(CLI::App& app, Run& run);
void AddVerifyCommand(CLI::App& app, Run& run);

inline constexpr void (*kCommands[])(CLI::App&, Run&) = {
    AddInitCommand,       AddCellsCommand,    AddPlaceCommand,     AddPlanCommand,     AddVerifyCommand,
    AddBatchCommand,      AddCheckCommand,    AddInspectCommand,   AddDiffCommand,     AddFaceCommand,
    AddReportCommand,     AddExportCommand,   AddStiffnessCommand, AddIdentifyCommand, AddCalibrateCommand,
    AddFlatnessCommand,   AddRegisterCommand, AddCleanCommand,     AddSchemaCommand,   AddManCommand,
    AddCompletionCommand,
};

}  // namespace millpose
