// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "report/check_html.hpp"
#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// What the arm can do at every point of a job's tool path, over rotations that are `step` (rad) apart and
/// all branches; interference is not looked at. The same for any number of threads.
std::vector<PointReach> FindReach(const PreparedJob& prepared, double step, const Execution& execution);

}  // namespace millpose
