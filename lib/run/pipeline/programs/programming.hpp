// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "job/inputs.hpp"
#include "machine/collision/world.hpp"
#include "program/post.hpp"
#include "program/verify/confirmed_runs.hpp"

namespace millpose {

/// With what the programs of one controller are made, read back and replayed. What it is made of outlives it.
struct Programming {
  /// Throws InputError where the cell lacks what the controller needs.
  Programming(const JobInputs& all, std::string name, const World& at_zero, const Execution& run);

  const JobInputs& inputs;
  const std::string controller;
  const World& world;  ///< with the external axes at 0
  const PostSettings settings;
  const Post& post;
  std::shared_ptr<const World> as_it_is;  ///< where the job takes the arm's deviations out
  const std::shared_ptr<ConfirmedRuns> confirmed = std::make_shared<ConfirmedRuns>();
  VerifyOptions options;
  const Execution execution;
};

}  // namespace millpose
