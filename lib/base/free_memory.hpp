// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <malloc.h>

namespace millpose {

/// Gives the system back what was freed: the next stage of a large plan need not carry what the last one
/// needed.
inline void ReleaseFreeMemory() {
#if defined(__GLIBC__)
  ::malloc_trim(0);
#endif
}

}  // namespace millpose
