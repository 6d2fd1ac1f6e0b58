// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategies/curve_strategy.hpp"
#include "toolpath/strategies/drill.hpp"
#include "toolpath/strategies/pad.hpp"
#include "toolpath/strategies/parallel_planes.hpp"
#include "toolpath/strategies/rings.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {

/// The options' strategy as an S to be changed: a copy of theirs, or a new one where they have another.
template <class S>
S& With(ToolpathOptions& options) {
  const auto* had = dynamic_cast<const S*>(options.strategy.get());
  auto own = std::make_shared<S>(had ? *had : S());
  S& changed = *own;
  options.strategy = std::move(own);
  return changed;
}

/// The options' strategy becomes the one of this name, as it is by default.
inline void Choose(ToolpathOptions& options, const std::string& name) {
  options.strategy = Strategies().At(name).make();
}

}  // namespace millpose
