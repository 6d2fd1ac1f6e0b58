// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/units.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

/// The material that stands over the part, taken off in layers across the tool axis (docs/rough.md).
struct Rough final : Strategy {
  double allowance = 0;                  ///< left on the part, mm
  double per_layer = 0;                  ///< largest depth of a layer, mm
  double max_engagement = DegToRad(70);  ///< of the edge round the cutter, rad
  bool climb = true;
  double ramp = DegToRad(3);     ///< of helix and ramp, rad
  double thicker_than = 0;       ///< thinner material counts as none, mm
  std::optional<double> bottom;  ///< lowest place of the tip along the tool axis, mm

  std::string Name() const override { return "rough"; }
  bool IsPrescribed() const override { return true; }
  bool NeedsStock() const override { return true; }
  std::vector<std::string> WithoutEffect() const override;
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;
};

}  // namespace millpose
