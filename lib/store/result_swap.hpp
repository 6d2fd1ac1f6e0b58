// SPDX-License-Identifier: GPL-3.0-or-later
// How a folder goes from one plan's results to the next one's: all of the new set stands complete and synced
// in a staging folder before any old file is touched; a journal says what is to be renamed; renames follow.
// The manifest is the first file that goes and the last that comes: where it stands, the set is whole.
// Whatever ends the process in between, the next run finds the journal and finishes, or takes back what was
// begun; where the journal is damaged, it is told from the manifests of both sets.
#pragma once

#include <string>
#include <vector>

#include "base/folder.hpp"

namespace millpose {

/// The folder that holds the new set until it is complete.
inline constexpr const char* kStagingFolder = ".staging";

/// The mark of an output folder.
inline constexpr const char* kMark = ".millpose";
inline constexpr const char* kCheckpointsFolder = "checkpoints";
inline constexpr const char* kStageEnding = ".stage";  ///< of a file there: a result of a stage

/// Puts the staged set in the place of `old` (names that stand in `folder`; programs/ is one of them, as a
/// whole). Throws InputError with the old set standing; where not even that can be restored, the journal
/// stays for the next run.
void SwapResults(const Folder& folder, const std::vector<std::string>& old);

/// Whether a swap was begun and not ended.
bool IsSwapOpen(const Folder& folder);

/// Finishes an open swap, or takes it back where it cannot be finished, and removes what is left of one that
/// never began. For one who is alone in the folder. Returns what was damaged, a sentence; empty when all was
/// well. Throws InputError where the system does not let it.
std::string RecoverResults(const Folder& folder);

/// Whether a name in an output folder is of a set: one entry, and none that belongs to the swap, the lock,
/// the mark or the checkpoints.
bool IsOfSet(const std::string& name);

/// The entry as a folder: made where it is missing, and where something else stands in its place, which is
/// removed. For names that nobody but millpose has a use for.
Folder FolderFor(const Folder& folder, const std::string& name);

}  // namespace millpose
