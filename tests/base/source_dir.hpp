// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace millpose {

/// The project's top folder, for tests that read its files. One file knows it, so that all others compile
/// alike wherever the clone lies and a compiler cache serves every clone.
const char* SourceDir();

}  // namespace millpose
