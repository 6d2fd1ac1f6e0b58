// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/programming.hpp"

#include "job/assemble.hpp"

namespace millpose {

Programming::Programming(const JobInputs& all, std::string name, const World& at_zero, const Execution& run)
    : inputs(all),
      controller(std::move(name)),
      world(at_zero),
      settings(MakePostSettings(all.job, all.cell, controller)),
      post(*all.cell.controllers.at(controller).post),
      options(MakeVerifyOptions(all.job, at_zero.cell().arm)),
      execution(run) {}

}  // namespace millpose
