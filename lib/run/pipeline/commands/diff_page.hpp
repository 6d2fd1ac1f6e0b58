// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "report/words/words.hpp"
#include "run/pipeline/commands/diff_folders.hpp"

namespace millpose {

/// What two plans differ in, side by side, as a page (HTML) that loads nothing. `fails`: of each change,
/// whether it broke a rule. `page`: where it will stand; the reports of both plans are linked from there,
/// where they are. Keys and values stay as they are in every language.
std::string DiffPage(const DiffArguments& arguments, const std::vector<Change>& changes,
                     const std::vector<bool>& fails, const std::filesystem::path& page,
                     Language language = Language::kEnglish);

}  // namespace millpose
