// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "job/config/cell_settings.hpp"
#include "job/config/job_settings.hpp"

namespace millpose {

/// A setting given in place of the file's: key path with dots, value as YAML ("toolpath.stepover_mm", "4").
struct Override {
  std::string path, value;
  SourceLocation place = {};  ///< of a manifest's
};
/// Splits "toolpath.stepover_mm=4"; throws InputError without an equals sign or a key.
Override ParseOverride(const std::string& text);

/// Reads a job or cell from YAML text. Throws InputError with every problem found (file:line:column, key
/// path, given, allowed, nearest key). `name` is used in messages; nothing is opened. `overrides` replace or
/// add keys, in their order.
/// Of a job with several `operations` the one that `operation` says (from 0); all are read, so that what is
/// wrong with any is reported.
JobSettings ParseJob(std::string_view yaml, const std::string& name,
                     const std::vector<Override>& overrides = {}, std::optional<size_t> operation = {});
/// What a job file says of itself before its sections are read.
struct JobOutline {
  std::string name;                     ///< of the job, as given
  std::vector<std::string> operations;  ///< their names in their order; none where the job is one itself
};
/// Throws InputError for what is no job, and for operations without names or with keys of no operation.
JobOutline OutlineOf(std::string_view yaml, const std::string& name,
                     const std::vector<Override>& overrides = {});
/// The job's file as YAML with the overrides in it.
std::string WithOverrides(std::string_view yaml, const std::string& name,
                          const std::vector<Override>& overrides);
CellSettings ParseCell(std::string_view yaml, const std::string& name);
/// Reads a tools file; throws InputError as ParseJob does.
ToolsFile ParseTools(std::string_view yaml, const std::string& name);

/// Makes `name` the tool of the cell. InputError where it has none of that name, or several and none is
/// named.
void SelectTool(const std::string& name, CellSettings* cell);

/// The settings as YAML that reads back to the same, every key written, defaults included.
std::string WriteJob(const JobSettings& job);
std::string WriteCell(const CellSettings& cell);

/// JSON Schema (draft 2020-12) of the job, cell and tools files, from the same field tables.
std::string JobSchema();
std::string CellSchema();
std::string ToolsSchema();

/// The reference page of all keys (docs/yaml-reference.md), from the same field tables.
std::string YamlReference();

}  // namespace millpose
