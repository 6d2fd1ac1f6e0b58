// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose report`: the setup sheet of a plan, or of all operations of a job, from its output folder.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "base/file_root.hpp"
#include "report/words/words.hpp"

namespace millpose {

struct SetupArguments {
  std::filesystem::path plan;                ///< output folder of `millpose plan`
  std::optional<std::filesystem::path> job;  ///< of it, where it does not stand beside the folder
  FileRoot root{};
  Language language = Language::kEnglish;  ///< of the sheet
};

/// HTML (SetupSheetHtml). Throws InputError for what cannot be read; Interrupted.
std::string SetupOfFolder(const SetupArguments& arguments, std::stop_token stop);

}  // namespace millpose
