// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

namespace millpose {

/// How a STEP file becomes triangles, and what its reading may take.
struct StepOptions {
  double chord_tolerance = 0.05;  ///< mm, between the faces and their triangles; angles stay below 10 degrees
  int memory_MB = 2048;           ///< address space of the process that reads
  int seconds = 120;              ///< of its processor and of the clock
  std::filesystem::path program{};     ///< that reads; found beside the running one when empty
  std::function<void(int)> percent{};  ///< hears how far the reading has come, ascending to 100
  std::stop_token stop{};              ///< ends the process that reads; ReadStep throws Interrupted
};

}  // namespace millpose
