// SPDX-License-Identifier: GPL-3.0-or-later
// Work on several values at once: blocks of kLanes doubles and the loop over them, compiled for several
// instruction sets. All of them give the same bits: lanes never meet and products are never fused with sums.
#pragma once

#include <cstdint>

#if defined(__clang__)
#define MILLPOSE_LANES_APART _Pragma("clang loop vectorize(assume_safety)")
#define MILLPOSE_AVX512 "avx512f"
#else
#define MILLPOSE_LANES_APART _Pragma("GCC ivdep")
#define MILLPOSE_AVX512 "avx512f,prefer-vector-width=512"
#endif

namespace millpose {

/// Blocks are this many values wide: one AVX-512 register, two AVX, four SSE2.
inline constexpr int kLanes = 8;

/// One value per lane.
struct alignas(64) Lanes {
  double v[kLanes];
};

enum class InstructionSet : uint8_t { kBaseline, kAvx2, kAvx512 };

/// Whether this processor has the set.
bool Supports(InstructionSet set);

/// The widest set this processor has, or the one that the environment names
/// (MILLPOSE_INSTRUCTION_SET=baseline, avx2 or avx512: for tests and for finding faults, results are the
/// same). Throws InputError for any other.
InstructionSet WidestInstructionSet();

namespace lanes {

template <class Body>
void LoopBaseline(const Body& body) {
  MILLPOSE_LANES_APART
  for (int lane = 0; lane < kLanes; ++lane) body(lane);
}

#if defined(__x86_64__)
template <class Body>
[[gnu::target("avx2")]] void LoopAvx2(const Body& body) {
  MILLPOSE_LANES_APART
  for (int lane = 0; lane < kLanes; ++lane) body(lane);
}

template <class Body>
[[gnu::target(MILLPOSE_AVX512)]] void LoopAvx512(const Body& body) {
  MILLPOSE_LANES_APART
  for (int lane = 0; lane < kLanes; ++lane) body(lane);
}
#endif

}  // namespace lanes

#undef MILLPOSE_LANES_APART
#undef MILLPOSE_AVX512

/// Calls `body(lane)` for every lane with the code of `set`. `body` is a lambda marked [[gnu::always_inline]]
/// whose calls inline too, without branches; what it writes for a lane must not depend on other lanes. Files
/// that use it are compiled by millpose_lane_sources (lib/CMakeLists.txt), whose options let the compiler
/// vectorise.
template <class Body>
void ForEachLane(InstructionSet set, const Body& body) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return lanes::LoopAvx512(body);
  if (set == InstructionSet::kAvx2) return lanes::LoopAvx2(body);
#endif
  static_cast<void>(set);
  lanes::LoopBaseline(body);
}

}  // namespace millpose
