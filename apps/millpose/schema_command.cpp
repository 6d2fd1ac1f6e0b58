// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "job/config/batch_settings.hpp"

namespace millpose {

void AddSchemaCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "schema", "Print the JSON Schema of job, cell, tools or batch files, or the page of keys");
  const auto what = std::make_shared<std::string>();
  command->add_option("what", *what, "job, cell, tools, batch, or reference (Markdown)")
      ->required()
      ->check(CLI::IsMember({"job", "cell", "tools", "batch", "reference"}));
  command->callback([&run, what] {
    run = [what](Session&) {
      const std::string text = *what == "job"     ? JobSchema()
                               : *what == "cell"  ? CellSchema()
                               : *what == "tools" ? ToolsSchema()
                               : *what == "batch" ? BatchSchema()
                                                  : YamlReference();
      fmt::print("{}", text);
      return kDone;
    };
  });
}

}  // namespace millpose
