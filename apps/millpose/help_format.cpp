// SPDX-License-Identifier: GPL-3.0-or-later
#include "help_format.hpp"

#include "wrapped.hpp"

namespace millpose {
namespace {

constexpr size_t kHelpColumns = 79;

}  // namespace

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
  return Wrapped(option->get_description(), kHelpColumns - get_column_width());
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  std::ostringstream out;
  CLI::detail::format_help(out, command->get_display_name(true),
                           Wrapped(command->get_description(), kHelpColumns - get_column_width()),
                           get_column_width());
  return out.str();
}

std::string HelpFormat::make_description(const CLI::App* app) const {
  return Wrapped(Formatter::make_description(app), kHelpColumns);
}

}  // namespace millpose
