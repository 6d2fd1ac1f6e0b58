// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/first_run.hpp"

#include "job/assemble.hpp"

namespace millpose {

std::string FirstRunText(const JobInputs& inputs) {
  std::string text;
  for (const std::string& controller : inputs.job.programs) {
    const PostSettings settings = MakePostSettings(inputs.job, inputs.cell, controller);
    text += fmt::format("{}, before a first run (docs/{}.md):\n", controller, controller);
    for (const auto& [what, how] : inputs.cell.controllers.at(controller).post->BeforeFirstRun(settings))
      text += fmt::format("  [ ] {}: {}\n", what, how);
  }
  return text;
}

}  // namespace millpose
