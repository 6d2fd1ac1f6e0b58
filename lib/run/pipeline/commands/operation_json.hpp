// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <utility>

#include "run/pipeline/commands/reported_folder.hpp"

namespace millpose {

/// An operation of a reported folder with its summary.json as a tree.
struct OperationWithTree : FolderOperation {
  explicit OperationWithTree(FolderOperation one)
      : FolderOperation(std::move(one)), json(nlohmann::json::parse(summary, nullptr, false)) {}
  nlohmann::json json;
};

}  // namespace millpose
