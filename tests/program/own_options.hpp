// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post_entry.hpp"

namespace millpose {

/// The options of a cell's controller that are its own.
template <class P>
typename P::Options OwnOptions(const ControllerOptions& controller) {
  return dynamic_cast<const P&>(*controller.post).options();
}

template <class P>
void SetOwnOptions(ControllerOptions& controller, const typename P::Options& options) {
  controller.post = std::make_shared<const P>(options);
}

}  // namespace millpose
