// SPDX-License-Identifier: GPL-3.0-or-later
// How a reader sees one plan, and not a piece of two, while another run replaces it. Readers take no lock: a
// folder that may only be read has none to give, and a run that is to plan must not be refused because of one
// who only looks.
#pragma once

#include <filesystem>
#include <functional>

#include "base/file_root.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Calls `reading`, which reads files of the output folder `folder`, until the same manifest stood there
/// before and after: a manifest is the first file that goes and the last that comes. What `reading` throws
/// counts when nothing changed. Links, pipes and the like in the place of results are refused before, and
/// so is the plan of an earlier version. After three attempts throws InputError: the folder is being
/// replaced. That is also the answer where a run was ended while it did; the next `plan` finishes that.
void ReadWhole(const std::filesystem::path& folder, const std::function<void()>& reading);

/// The plan of an output folder. Throws InputError: for what cannot be read, for what this version did not
/// write, and for what lies outside of `root`.
PlanResult ReadPlanIn(const std::filesystem::path& folder, const FileRoot& root);

}  // namespace millpose
