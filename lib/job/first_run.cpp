// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/first_run.hpp"

#include "job/assemble.hpp"

namespace millpose {

std::vector<std::pair<std::string, std::string>> FirstRunSteps(const JobInputs& inputs,
                                                               const std::string& controller) {
  return inputs.cell.controllers.at(controller)
      .post->BeforeFirstRun(MakePostSettings(inputs.job, inputs.cell, controller));
}

std::string FirstRunText(const JobInputs& inputs) {
  std::string text;
  for (const std::string& controller : inputs.job.programs) {
    text += fmt::format("{}, before a first run (docs/{}.md):\n", controller, controller);
    for (const auto& [what, how] : FirstRunSteps(inputs, controller))
      text += fmt::format("  [ ] {}: {}\n", what, how);
  }
  return text;
}

}  // namespace millpose
