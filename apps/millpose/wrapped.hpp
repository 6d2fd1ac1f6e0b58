// SPDX-License-Identifier: GPL-3.0-or-later
// Lines broken between words: a terminal breaks longer ones anywhere.
#pragma once

#include <cstddef>
#include <string>

namespace millpose {

/// Lines of at most `columns`, but for words that are longer; line feeds of the text stay.
std::string Wrapped(const std::string& text, size_t columns);

/// Text as the terminal that `file` is shows it: what is wider goes on in the next line, under the column in
/// which the line's text begins. Lines of JSON stay; all do where `file` is no terminal or one of less than
/// 50 columns.
std::string ForTerminal(const std::string& text, int file);

}  // namespace millpose
