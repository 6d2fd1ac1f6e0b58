// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "job/config/config.hpp"

namespace millpose {

/// One job of a manifest.
struct BatchEntry {
  std::string job_file;             ///< relative to the manifest
  std::string name;                 ///< in place of the job's own; empty: the job's own
  std::vector<Override> overrides;  ///< in the order of key paths
  int shares = 0;  ///< tasks of a cluster over which its passes are spread; 0: as for all jobs
};

/// A manifest: jobs with overrides of their own (key `millpose_batch: 1`).
struct BatchSettings {
  bool untrusted = false;  ///< its jobs see no file outside of the manifest's folder
  std::vector<BatchEntry> jobs;
};

/// Reads a manifest; throws InputError as ParseJob does.
BatchSettings ParseBatch(std::string_view yaml, const std::string& name);

/// JSON Schema (draft 2020-12) of manifests.
std::string BatchSchema();

}  // namespace millpose
