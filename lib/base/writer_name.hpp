// SPDX-License-Identifier: GPL-3.0-or-later
// Names of files that are being written. They say who writes them, so that what a killed run left can be told
// from what another is writing just now.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace millpose {

/// The name of this machine.
std::string HostName();

/// A name that no other thread, process or machine uses: ".NAME.HOST.PROCESS.START.NUMBER.tmp", with NAME cut
/// where it is long. START: when the process began, in the clock ticks of /proc/PROCESS/stat.
std::string TemporaryName(std::string_view name);

/// The same beside `path`.
std::filesystem::path TemporaryBeside(const std::filesystem::path& path);

/// Whether a file name is one that TemporaryName() makes.
bool IsTemporaryName(std::string_view file_name);

/// Whether it is, of this machine, and the process that it names is gone. Of another machine nothing can be
/// known: false.
bool IsOfEndedWriter(std::string_view file_name);

/// The same, but for another machine true: for one who knows that nobody else writes in the folder.
bool IsOfNoWriterHere(std::string_view file_name);

}  // namespace millpose
