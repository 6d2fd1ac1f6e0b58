// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

/// How a child process ended.
struct ProcessResult {
  int status = 0;              ///< exit status; 128 + signal when a signal ended it, as shells count
  std::string output, errors;  ///< what it wrote to stdout and stderr
  double wall_s = 0;           ///< from start to end
  double peak_memory_MB = 0;   ///< largest resident set
};

/// Runs `arguments` (the program first, by path or found in PATH) with `input` on its stdin and waits for its
/// end. When `stop` is requested the child gets SIGTERM, and SIGKILL five seconds later; then Interrupted is
/// thrown. Throws InputError when the program cannot be started. `told` hears each line of the child's stderr
/// as it comes, without its end.
ProcessResult RunProcess(const std::vector<std::string>& arguments, std::stop_token stop,
                         std::string_view input = {}, const std::function<void(std::string_view)>& told = {});

/// Makes this process end when its parent does, however that one ends. For a child of RunProcess to call
/// first; ends it at once when the parent is gone already (nobody reads stdout any more).
void EndWithParent();

/// Memory that this process may come to have, bytes: the machine's, or its own limit where that is lower.
double MachineMemory();

/// The path of the running program.
std::string OwnProgram();

/// Identifies the running program: another build, another id. The linker's build id; the hash of the
/// program's file where it was linked without one.
std::string ProgramId();

}  // namespace millpose
