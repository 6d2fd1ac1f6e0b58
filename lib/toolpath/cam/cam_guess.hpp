// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace millpose {

/// What a file that is no tool path seems to be, by its content: "a KRL program (KUKA)", "a STEP model".
/// Empty where nothing tells. Never said of a file that holds a GOTO.
std::optional<std::string> GuessFormat(std::string_view bytes);

}  // namespace millpose
