// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose identify` says and writes of what gives way besides the joints (docs/compliance-models.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "job/config/cell_settings.hpp"
#include "machine/identification/compliance_models.hpp"

namespace millpose {

/// The models tried, and what none of them has as the poses do not tell it.
nlohmann::ordered_json ModelsJson(const ComplianceModels& models);

/// What gives way beside the joints, each with its unit and 95 % interval.
nlohmann::ordered_json BesideJson(const Identification& found);
/// null where the chosen model has none.
nlohmann::ordered_json PayloadJson(const Identification& found);

/// All of it on the terminal.
void PrintModels(const ComplianceModels& models, const Identification& found);

/// What tilts and moves as a cell has it, by link, the intervals in the names.
std::vector<ComplianceSettings> CompliancesOf(const Identification& found);

/// What was found and is no part of a cell's stiffness: one sentence; empty where there is none.
std::string NotWritten(const Identification& found);

}  // namespace millpose
