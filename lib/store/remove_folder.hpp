// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "store/output_folder.hpp"

namespace millpose {

/// Removes an output folder with all that it holds; `folder`, used for results, is of no more use then. Its
/// mark goes last: however the process ends meanwhile, what is left is known as millpose's and can be written
/// into or removed by the next run. Throws InputError.
void RemoveOutputFolder(const OutputFolder& folder);

}  // namespace millpose
