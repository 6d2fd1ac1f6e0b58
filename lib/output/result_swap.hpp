// SPDX-License-Identifier: GPL-3.0-or-later
// How a folder goes from one plan's results to the next one's: all of the new set stands complete and synced
// in a staging folder before any old file is touched; a journal says what is to be renamed; renames follow.
// Whatever ends the process in between, the next run finds the journal and finishes, or takes back what was
// begun.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace millpose {

/// The folder that holds the new set until it is complete.
std::filesystem::path StagingOf(const std::filesystem::path& folder);

/// Puts the staged set in the place of `old` (names that stand in `folder`; programs/ is one of them, as a
/// whole). Throws InputError with the old set standing; where not even that can be restored, the journal
/// stays for the next run.
void SwapResults(const std::filesystem::path& folder, const std::vector<std::string>& old);

/// Whether a swap was begun and not ended.
bool IsSwapOpen(const std::filesystem::path& folder);

/// Finishes an open swap, or takes it back where it cannot be finished, and removes what is left of one that
/// never began. For one who is alone in the folder.
void RecoverResults(const std::filesystem::path& folder);

/// Whether a name in an output folder belongs to the swap and not to a set.
bool IsOfSwap(const std::string& name);

}  // namespace millpose
