// SPDX-License-Identifier: GPL-3.0-or-later
// Setups of a job: where the part stands for some of its operations (docs/setups.md).
#pragma once

#include "job/config/fields.hpp"

namespace millpose::config {

/// The key `setups`, for the schema and the reference page; `fields`: those of a job. What is read here
/// stands in a job without operations, and is refused.
Field<JobSettings> SetupsField(const std::vector<Field<JobSettings>>& fields);

/// What is wrong with the setups of a job and with which operation is of which. `names`: of the operations.
void CheckSetups(const Value& root, const std::vector<std::string>& names, const Context& context);

/// The setup of operation `number`; empty where the job has none.
std::string SetupOf(const Value& root, size_t number);

/// Puts where the part stands for operation `number` into `own`, the file of the operation as a job.
void PlaceInSetup(const Value& root, size_t number, Value& own);

}  // namespace millpose::config
