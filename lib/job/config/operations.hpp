// SPDX-License-Identifier: GPL-3.0-or-later
// A job of several operations: one after the other on the same part, each with what differs from the job's
// own sections.
#pragma once

#include "job/config/fields.hpp"
#include "program/post_keys.hpp"

namespace millpose::config {

/// The key `operations`, for the schema and the reference page; `fields`: those of a job. Its value is read
/// by OperationNames() and OperationRoot(), before a job's fields are.
Field<JobSettings> OperationsField(const std::vector<Field<JobSettings>>& fields);

/// What is required of a section that operations have key by key moves in the schema of a job to those
/// without `operations`.
void LeaveToOperations(Value& schema);

/// The names of the operations in their order; problems join `context`'s.
std::vector<std::string> OperationNames(const Value& root, const Context& context);

/// Operation `number` (from 0) as the file of a job that is this operation alone: the job's sections with the
/// operation's keys in their place, a whole `toolpath` in that of the job's. Precondition: OperationNames()
/// found no problem.
Value OperationRoot(const Value& root, size_t number);

}  // namespace millpose::config
