// SPDX-License-Identifier: GPL-3.0-or-later
// What KRL asks of a program's files before a line of them runs.
#pragma once

#include "tests/campaign/runner.hpp"

namespace millpose::campaign {

/// The program that no other one calls; `files` by their names in capitals, without ".src". Throws Refusal
/// where each is called.
std::string KrlMain(const std::map<std::string, std::string>& files);

/// "GOTO": a label is defined once in its program. Throws Refusal.
void CheckKrlLabels(const std::vector<std::string>& lines);

}  // namespace millpose::campaign
