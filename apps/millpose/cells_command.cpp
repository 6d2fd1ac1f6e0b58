// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "clean_output.hpp"
#include "commands.hpp"
#include "run/init/list_cells.hpp"

namespace millpose {

void AddCellsCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("cells", "The cells that come with millpose (docs/init.md)");
  struct CellsWords {
    std::string name;
    bool json = false;
  };
  const auto words = std::make_shared<CellsWords>();
  CLI::Option* name = command->add_option("NAME", words->name, "Print the YAML of this one");
  command->add_flag("--json", words->json, "The list as JSON")->excludes(name);
  command->callback([&run, words] {
    run = [words](Session&) {
      if (!words->name.empty())
        PrintAsIs(CellYaml(words->name));
      else
        fmt::print("{}", words->json ? CellsJson(ListCells()) : CellsText(ListCells()));
      return kDone;
    };
  });
}

}  // namespace millpose
