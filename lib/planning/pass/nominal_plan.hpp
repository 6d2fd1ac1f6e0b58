// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pose/scorer.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// A plan with the tool at every point as the tool path was laid, to compare places and ways with others of
/// the same pass. Joints and freedoms stay as planned. The same plan where nothing leans.
PassResult AtNominalLean(const PoseProblem& problem, PassResult plan);

}  // namespace millpose
