// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/reported_folder.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "run/pipeline/commands/plan_folder.hpp"
#include "run/pipeline/operations/done_operation.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace {

FolderOperation ReadFolderOperation(const SetupArguments& arguments, const std::string& below) {
  PlanFolder read =
      ReadPlanFolder(below.empty() ? arguments.plan : arguments.plan / below, arguments.job, arguments.root);
  const std::string name = below.empty() ? read.plan.job : read.inputs.job.operation;
  return {name, below, std::move(read.plan), std::move(read.inputs), std::move(read.summary)};
}

}  // namespace

ReportedFolder ReadReportedFolder(const SetupArguments& arguments) {
  if (!IsOutputFolder(arguments.plan))
    throw InputError({arguments.plan.string()}, "is no output folder of millpose (it has no .millpose)");
  ReportedFolder folder;
  for (const std::string& below : OperationFolders(arguments.plan))
    folder.operations.push_back(ReadFolderOperation(arguments, below));
  folder.several = !folder.operations.empty();
  if (folder.several)
    folder.main = Folder(arguments.plan).Read("summary.json");
  else
    folder.operations.push_back(ReadFolderOperation(arguments, ""));
  const FolderOperation& first = folder.operations.front();
  folder.job = folder.several ? first.inputs.job.operation_of : first.plan.job;
  return folder;
}

std::vector<FolderProgram> ProgramsIn(const ReportedFolder& folder) {
  std::vector<FolderProgram> programs;
  const auto add = [&](const std::string& operation, const std::filesystem::path& below,
                       const std::string& text) {
    const nlohmann::json summary = nlohmann::json::parse(text, nullptr, false);
    for (const nlohmann::json& program : summary.at("programs")) {
      const bool written = program.at("verified").get<bool>();
      programs.push_back({operation, program.at("controller").get<std::string>(),
                          (below / program.at("path").get<std::string>()).generic_string(),
                          !written                          ? "withheld: not written"
                          : program.at("but_for").is_null() ? "confirmed"
                                                            : "but for a stated gap",
                          written});
    }
  };
  if (folder.several) add("all", {}, folder.main);
  for (const FolderOperation& one : folder.operations) add(one.name, one.folder, one.summary);
  return programs;
}

std::string SubtitleOf(const ReportedFolder& folder) {
  const FolderOperation& first = folder.operations.front();
  const std::string& serial = first.inputs.cell.arm.serial;
  return fmt::format("Cell {}, arm {}{}. Inputs {}.", first.plan.cell, first.inputs.cell.arm.name,
                     serial.empty() ? "" : ", number " + serial, first.plan.input_hash.substr(0, 16));
}

}  // namespace millpose
