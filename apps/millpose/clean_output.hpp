// SPDX-License-Identifier: GPL-3.0-or-later
// The one place through which text reaches a terminal.
#pragma once

#include <string>
#include <string_view>

namespace millpose {

/// From here on nothing that the program writes to stdout or stderr commands a terminal, whatever names and
/// texts of foreign files it repeats: control characters but line feed and tab, characters that turn the
/// direction of text, and what is no UTF-8 become "?"; and no line is wider than the terminal (ForTerminal).
/// Called once, before anything is written.
void CleanOutput();

/// Text for stdout that somebody may copy, such as YAML: clean, with its lines as they are.
void PrintAsIs(const std::string& text);

/// Clears the line of stderr that the cursor stands in, if it is a terminal; the one command that is meant.
void ClearLine();

/// What CleanOutput() makes of a text; `rest` is what it ends with of an unfinished character (at most three
/// bytes), which goes before the next text.
std::string Cleaned(std::string_view text, std::string& rest);

}  // namespace millpose
