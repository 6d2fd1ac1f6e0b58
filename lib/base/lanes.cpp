// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/lanes.hpp"

namespace millpose {

bool Supports(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return __builtin_cpu_supports("avx512f");
  if (set == InstructionSet::kAvx2) return __builtin_cpu_supports("avx2");
#endif
  return set == InstructionSet::kBaseline;
}

InstructionSet WidestInstructionSet() {
  static const InstructionSet widest = Supports(InstructionSet::kAvx512) ? InstructionSet::kAvx512
                                       : Supports(InstructionSet::kAvx2) ? InstructionSet::kAvx2
                                                                         : InstructionSet::kBaseline;
  return widest;
}

}  // namespace millpose
