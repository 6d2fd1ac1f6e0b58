// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"millpose: robotic milling in the stiffest pose, without a GUI"};
  app.require_subcommand(0);
  CLI11_PARSE(app, argc, argv);
  return 0;
}
