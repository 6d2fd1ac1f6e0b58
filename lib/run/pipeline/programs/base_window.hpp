// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/execution.hpp"
#include "job/inputs.hpp"
#include "machine/collision/cell.hpp"
#include "planning/result/plan_result.hpp"
#include "report/report.hpp"

namespace millpose {

/// How far the base of a job's programs may be shifted together with the part, for a part whose place was
/// measured: the asked window, or a half or a quarter of it, of which 16 corners were replayed with reach,
/// configuration, limits, speeds, singularity and interference (docs/verification.md). Empty when the place
/// was not measured or there is no program. Throws Interrupted.
std::optional<BaseWindow> FindBaseWindow(const PlanResult& plan, const JobInputs& inputs, const Cell& cell,
                                         const Execution& execution);

/// The window in a line, as programs' headers print it.
std::string BaseWindowText(const BaseWindow& window);

}  // namespace millpose
