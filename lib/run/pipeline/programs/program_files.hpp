// SPDX-License-Identifier: GPL-3.0-or-later
// The files of a program as they stand in a folder.
#pragma once

#include <filesystem>
#include <set>

#include "base/file_root.hpp"
#include "job/config/cell_settings.hpp"
#include "program/post.hpp"
#include "program/verify/verify.hpp"

namespace millpose {

/// What main programs end in, each once, in the order of the controllers: {".src", ".mpf", …}.
std::vector<std::string> MainEndings();

/// The names of the files in a folder, in their order.
std::vector<std::string> SortedFiles(const std::filesystem::path& folder);

/// The controller whose main programs end like this file; of several the first that the cell has. InputError
/// where it is nobody's.
std::string ControllerOf(const std::filesystem::path& program, const CellSettings& cell);

/// The main file and what it calls, directly or not, in the same folder, each with what stands beside it
/// under its name (KRL's data lists).
ProgramFiles FilesOf(const std::filesystem::path& program, const Post& post, const FileRoot& root);

/// Files beside those that a controller's reader reads (`read`), such as KRL's data lists: each as it was
/// `written`, apart from comments and blanks, and no other; `complete`: none is missing.
void CompareBeside(const ProgramFiles& files, const ProgramFiles& written, const std::set<std::string>& read,
                   bool complete, std::vector<Finding>& findings);

}  // namespace millpose
