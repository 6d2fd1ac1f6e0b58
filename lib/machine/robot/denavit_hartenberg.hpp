// SPDX-License-Identifier: GPL-3.0-or-later
// Arms given by the table that textbooks and many makers' papers give them by.
#pragma once

#include <array>

#include "machine/robot/joint_chain.hpp"

namespace millpose {

/// Where a row's a and α stand: behind its joint (Denavit and Hartenberg 1955), or before it (Craig).
enum class DhConvention : uint8_t { kStandard, kModified };
inline constexpr EnumWords<DhConvention, 2> kDhConventionWords = {
    {{"standard", DhConvention::kStandard}, {"modified", DhConvention::kModified}}};

/// One axis. θ of the table is sign · A + theta at the arm's own angle A.
struct DhRow {
  double a = 0, d = 0;          ///< mm
  double alpha = 0, theta = 0;  ///< rad
  int sign = 1;                 ///< 1 or −1
};

/// The chain of a table: its base is S, its last frame E. From frame i−1 to frame i
///   standard: Rz(θi) · Tz(di) · Tx(ai) · Rx(αi)      modified: Rx(αi) · Tx(ai) · Rz(θi) · Tz(di)
/// where row i of a modified table holds what Craig writes as α and a of i−1. The chain has neither limits
/// nor speeds.
JointChain ChainOf(const std::array<DhRow, 6>& rows, DhConvention convention);

}  // namespace millpose
