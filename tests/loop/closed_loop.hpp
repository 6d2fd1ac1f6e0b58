// SPDX-License-Identifier: GPL-3.0-or-later
// A simulated arm that runs a compensated program under load: its stiffness and the cutting force are drawn
// within the bounds that the plan was made for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/audit/folder.hpp"

namespace millpose::loop {

using audit::Real;
using audit::Vector3;

/// Within which the truth is drawn: shares, rad.
struct Bounds {
  Real force = 0.3L, direction = 20 * audit::kDegree;
  std::array<Real, 6> joints{};
  Real beside = 0.1L;
};

/// The bounds that a folder's job and cell give.
Bounds BoundsOf(const std::string& job_yaml, const std::string& cell_yaml);

/// Errors along the surface normal over all draws, mm.
struct Verdict {
  size_t points = 0, draws = 0;
  Real program = 0;           ///< largest distance along n of the program's tip from its commanded place
  Real nominal = 0;           ///< nothing drawn: largest difference from what the plan expects to remain
  Real nominal_residual = 0;  ///< and the largest residual itself
  Real quantile_before = 0, quantile_after = 0;  ///< 95 % of the draws' worst error
  Real beyond = 0;  ///< largest excess of an error over the reported worst of its point
  size_t worse =
      0;  ///< points, over all draws, that compensation made worse by more than the program's own error
  Real remains = 1;  ///< median over compensated points and draws of |error after ÷ before|
};

Verdict Run(const audit::Folder& folder, const std::string& controller, const Bounds& bounds, size_t draws,
            uint64_t seed);

std::string ToJson(const Verdict& verdict);

/// Where the tool of an arm that is not its sheet's goes when its controller, which computes with the nominal
/// arm, runs a program: largest distance of a planned cut point from the way of the tip, mm, along the normal
/// alone, and of the tool's direction, rad. Expected deflections left aside.
struct OwnArmVerdict {
  size_t points = 0;
  Real tip = 0, normal = 0, axis = 0;
  Real between = 0;  ///< along the normal, of the way between two planned cut points
  /// Each cut point: number, place and normal in W, the tip's error along it, mm.
  struct Each {
    int point;
    Vector3 place, normal;
    Real off;
  };
  std::vector<Each> each;
  Real nominal_tip = 0;  ///< the same distance of the tip that the controller believes in
};
OwnArmVerdict RunOnOwnArm(const audit::Folder& folder, const std::string& controller,
                          const audit::OwnArm& arm);

/// `each`: with every point.
std::string ToJson(const OwnArmVerdict& verdict, bool each);

}  // namespace millpose::loop
