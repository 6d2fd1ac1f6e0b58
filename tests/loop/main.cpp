// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a plan's compensated program on simulated arms. Prints what came of it as JSON.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "base/file.hpp"
#include "tests/loop/closed_loop.hpp"

int main(int argc, char** argv) {
  using namespace millpose;
  CLI::App app{"Runs a compensated program on simulated arms, drawn within the plan's own bounds."};
  std::filesystem::path folder, inputs;
  std::string controller = "linuxcnc";
  size_t draws = 1000;
  uint64_t seed = 1;
  app.add_option("DIR", folder, "output folder of `millpose plan`")->required();
  app.add_option("--inputs", inputs, "where the job file was, when DIR is not beside it");
  app.add_option("--controller", controller, "whose program is run")->capture_default_str();
  app.add_option("--draws", draws, "simulated arms")->capture_default_str();
  app.add_option("--seed", seed, "of the draws")->capture_default_str();
  bool own_arm = false;
  app.add_flag("--own-arm", own_arm, "with the deviations of the cell's arm, nothing drawn");
  std::filesystem::path truth;
  app.add_option("--true-arm", truth, "with --own-arm: a cell whose arm runs the programs instead");
  bool each = false;
  app.add_flag("--each", each, "with --own-arm: every point's error");
  CLI11_PARSE(app, argc, argv);
  try {
    const loop::Bounds bounds = loop::BoundsOf(ReadFile(folder / "job.yaml"), ReadFile(folder / "cell.yaml"));
    if (own_arm) {
      const audit::OwnArm arm = audit::ReadOwnArm(ReadFile(truth.empty() ? folder / "cell.yaml" : truth));
      std::cout << loop::ToJson(loop::RunOnOwnArm(audit::ReadFolder(folder, inputs), controller, arm), each);
      return 0;
    }
    std::cout << ToJson(Run(audit::ReadFolder(folder, inputs), controller, bounds, draws, seed));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "millpose_loop: " << error.what() << "\n";
    return 2;
  }
}
