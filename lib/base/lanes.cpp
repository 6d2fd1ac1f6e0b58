// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/lanes.hpp"

#include <cstdlib>
#include <string>

#include "base/error.hpp"

namespace millpose {
namespace {

constexpr std::array<std::pair<const char*, InstructionSet>, 3> kNames{
    {{"avx512", InstructionSet::kAvx512},
     {"avx2", InstructionSet::kAvx2},
     {"baseline", InstructionSet::kBaseline}}};

InstructionSet ChooseInstructionSet() {
  const char* wanted = std::getenv("MILLPOSE_INSTRUCTION_SET");
  for (const auto& [name, set] : kNames)
    if (Supports(set) && (wanted == nullptr || std::string(wanted) == name)) return set;
  throw InputError(SourceLocation{},
                   fmt::format("MILLPOSE_INSTRUCTION_SET: given {}; allowed: baseline, or avx2 or avx512 "
                               "where the processor has it",
                               wanted));
}

}  // namespace

bool Supports(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return __builtin_cpu_supports("avx512f");
  if (set == InstructionSet::kAvx2) return __builtin_cpu_supports("avx2");
#endif
  return set == InstructionSet::kBaseline;
}

InstructionSet WidestInstructionSet() {
  static const InstructionSet widest = ChooseInstructionSet();
  return widest;
}

}  // namespace millpose
