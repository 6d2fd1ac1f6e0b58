// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace millpose {

/// Of `models.tried`, the simplest first, each with `mean_square` of what it leaves out and that mean's
/// standard `deviation`: which foretells best (`least`), and the simplest within one standard deviation of it
/// (`chosen`). The rule of one standard error: Breiman and others, Classification and Regression Trees, 1984.
/// Precondition: at least one was tried.
template <class Models>
void ChooseSimplest(Models& models) {
  models.least = 0;
  for (size_t i = 1; i < models.tried.size(); ++i)
    if (models.tried[i].mean_square < models.tried[models.least].mean_square) models.least = i;
  const auto& least = models.tried[models.least];
  models.chosen = 0;
  while (models.tried[models.chosen].mean_square > least.mean_square + least.deviation) ++models.chosen;
}

}  // namespace millpose
