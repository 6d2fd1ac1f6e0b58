// SPDX-License-Identifier: GPL-3.0-or-later
// Lines broken between words: a terminal breaks longer ones anywhere.
#pragma once

#include <cstddef>
#include <string>

namespace millpose {

/// Lines of at most `columns`, but for words that are longer; line feeds of the text stay.
std::string Wrapped(const std::string& text, size_t columns);

/// Lines that are a word in its column and what it says: what is wider than the terminal that stdout is goes
/// on in the next line, under the same column. As it is where stdout is no terminal.
std::string ForTerminal(const std::string& text);

}  // namespace millpose
