// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// CompareWithFixed(), where what was found out about each pass is kept and serves again, also after an
/// obstacle has moved that made no difference to it.
FixedComparison CompareFixed(const JobInputs& inputs, const PreparedJob& prepared,
                             const std::vector<PassResult>& passes, const CheckpointStore& checkpoints,
                             const Execution& execution);

}  // namespace millpose
