// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that are tried on random or large cases: few in the quick tier, many in the slow one.
#pragma once

#include <cstdlib>

namespace millpose {

/// How large a case is: `quick`, or `slow` where millpose_long_test() of tests/CMakeLists.txt runs it.
inline int OfTier(int quick, int slow) { return std::getenv("MILLPOSE_SLOW") == nullptr ? quick : slow; }

}  // namespace millpose
