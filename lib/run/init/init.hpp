// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose init`: a first cell and job for a part and an arm, which plan without an edit.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "base/progress.hpp"

namespace millpose {

struct InitArguments {
  std::filesystem::path part;
  std::string arm;                            ///< name of a sample cell, or a URDF file
  std::optional<std::filesystem::path> cell;  ///< the user's own in place of `arm`: only the job is written
  std::string tool;                           ///< of such a cell with several
  std::optional<std::filesystem::path> out;   ///< default: the part's name, in the working folder
  std::optional<double> unit;                 ///< mm per unit of the part; by default the file's, else 1
  std::string base_link, flange_link;         ///< of a URDF; empty: what suits
  std::optional<double> tolerance;            ///< mm, of a URDF's joints against the closed form
  int threads = 0;                            ///< 0: all cores
  std::function<void(const std::string&)> say = [](const std::string&) {
  };  ///< how the arm was understood, at once
};

struct InitOutcome {
  std::filesystem::path folder;
  std::string text;  ///< what was chosen, for the user
};

/// Chooses region, strategy and place, and keeps the first choice that a coarse trial plans whole (TryJob: a
/// sample of the passes, no programs); then cell.yaml and
/// job.yaml are moved to the folder, job.yaml alone where the user has a cell. Throws InputError for bad
/// input, where one of the two files stands already, for a part that no arm of this reach gets round, and
/// where nothing plans; Interrupted. Nothing is left behind then.
InitOutcome RunInit(const InitArguments& arguments, Progress& progress, std::stop_token stop);

}  // namespace millpose
