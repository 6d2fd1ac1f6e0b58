// SPDX-License-Identifier: GPL-3.0-or-later
// The independent judge: recomputes from a plan's output folder what the plan claims. Status 0 when every law
// holds, 1 when one is broken, 2 when the folder cannot be read.
#include <CLI/CLI.hpp>
#include <iostream>
#include <thread>

#include "tests/audit/audit.hpp"

int main(int argc, char** argv) {
  using namespace millpose::audit;
  CLI::App app{"Recomputes every figure of a plan from its output folder."};
  std::string folder, inputs;
  Options options;
  options.threads = static_cast<int>(std::thread::hardware_concurrency());
  app.add_option("DIR", folder, "output folder of `millpose plan`")->required();
  app.add_option("--inputs", inputs, "where the job file was, when DIR is not beside it");
  app.add_option("--travel-mm", options.travel_mm, "travel of any point of the arm between poses looked at")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "threads")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    const Verdict verdict = Audit(ReadFolder(folder, inputs), options);
    std::cout << ToJson(verdict);
    return verdict.Holds() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "millpose_audit: " << error.what() << "\n";
    return 2;
  }
}
