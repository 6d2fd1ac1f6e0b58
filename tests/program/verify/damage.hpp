// SPDX-License-Identifier: GPL-3.0-or-later
// Ways in which a program text goes wrong between the post and the machine, and edits that do no harm.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace millpose {

struct TextEdit {
  std::string name;
  std::string controllers;  ///< which it is for: letters of K (KRL), S (SINUMERIK), L (LinuxCNC)
  /// The edited text; empty when the text has nothing to edit.
  std::function<std::optional<std::string>(const std::string&)> apply;
};

std::vector<TextEdit> Damages();
std::vector<TextEdit> HarmlessEdits();

/// A KRL text whose LINs name every word, as those that stay are left out: for edits of single words. Other
/// texts as they are.
std::string WithWholeLines(const std::string& text);

}  // namespace millpose
