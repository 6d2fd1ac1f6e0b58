// SPDX-License-Identifier: GPL-3.0-or-later
// What two output folders differ in (docs/diff.md).
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/execution.hpp"
#include "base/file_root.hpp"

namespace millpose {

/// One difference.
struct Change {
  std::string section;         ///< settings | points | poses | figures | findings | programs
  std::string what;            ///< a key, a figure with its unit, or a sentence
  std::string before, after;   ///< empty: not there; of sentences always
  std::optional<double> by;    ///< of numbers: after less before, as a share of the greater of them
  std::string operation = {};  ///< of a job of several; of batches the job, see DiffBatches

  /// One line: "settings   process.feed_mm_min: 600 -> 60".
  std::string Text() const;
};

struct Differences {
  std::vector<Change> changes;
  std::set<std::string>
      figures;  ///< names of all numbers that were compared, also of those that are the same
};

struct DiffArguments {
  std::filesystem::path before, after;  ///< output folders of plan, or of batch
  FileRoot root;
};

inline const std::vector<std::string> kDiffSections{"settings", "points",   "poses",
                                                    "figures",  "findings", "programs"};

/// Compares two plans, two jobs of the same operations, or two batches (DiffBatches): resolved settings of
/// job and cell, milled points, poses, figures of summary.json, warnings and findings, and programs by their
/// motions as the readers of their controllers see them. Seeds, hashes, times and texts alone are no
/// difference. Throws InputError.
Differences DiffFolders(const DiffArguments& arguments);

}  // namespace millpose
