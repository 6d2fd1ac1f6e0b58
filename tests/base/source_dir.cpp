// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/base/source_dir.hpp"

namespace millpose {

const char* SourceDir() { return MILLPOSE_SOURCE_DIR; }

}  // namespace millpose
