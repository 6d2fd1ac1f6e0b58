// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/programming.hpp"

#include "base/error.hpp"
#include "job/assemble.hpp"
#include "job/compensate_job.hpp"

namespace millpose {

Programming::Programming(const JobInputs& all, std::string name, const World& at_zero, const Execution& run)
    : inputs(all),
      controller(std::move(name)),
      world(at_zero),
      settings(MakePostSettings(all.job, all.cell, controller)),
      post(*all.cell.controllers.at(controller).post),
      options(MakeVerifyOptions(all.job, at_zero.cell().arm)),
      execution(run) {
  options.confirmed = confirmed.get();
  if (const auto deviations = CommandedDeviations(all.job, all.cell)) {
    as_it_is = std::make_shared<const World>(AsItIs(at_zero.cell(), *deviations));
    options.as_it_is = as_it_is.get();
  }
  if (settings.max_corner) options.max_corner = *settings.max_corner;
  if (options.max_corner > options.clearance_reserve)
    throw InputError(
        SourceLocation{inputs.cell.file, 0, 0, -1},
        fmt::format("controllers.{}.max_corner_mm: given {} mm; at most interference.swept_resolution_mm, {} "
                    "mm, allowed: by so much motions may fall short of the clearance that was proven",
                    controller, options.max_corner, options.clearance_reserve));
}

}  // namespace millpose
