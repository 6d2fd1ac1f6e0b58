// SPDX-License-Identifier: GPL-3.0-or-later
// The objective `piped`: its values come from another process over two pipes (docs/python.md).
#pragma once

#include <string>

namespace millpose {

/// Adds the objective `piped` to the registry; before the first job is read. Without pipes jobs that name it
/// can be read, verified and shown, and what would need its values ends with an InputError that says so.
void AddPipedObjective();

/// Takes "IN,OUT", the descriptors to read values from and to write indices to, and greets the other side.
/// Throws InputError for descriptors that are not open, and when nobody reads.
void ConnectPipedObjective(const std::string& descriptors);

}  // namespace millpose
