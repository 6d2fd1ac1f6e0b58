// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.hpp"

namespace millpose {

RootOption AddRootOption(CLI::App& command) {
  const auto folder = std::make_shared<std::optional<std::filesystem::path>>();
  command.add_option(
      "--root", *folder,
      "For jobs of others: no file outside of this folder is read, none that a job names is written "
      "outside of it; symbolic links are followed first");
  return folder;
}

}  // namespace millpose
