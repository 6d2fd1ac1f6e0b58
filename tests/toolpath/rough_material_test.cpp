// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_material.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;

/// From a cell to the nearest one that stands, looked for among all of them; mm.
double DistanceByLooking(const RoughMaterial& material, int cell) {
  const RoughGrid& grid = material.grid();
  double nearest = std::numeric_limits<double>::infinity();
  for (int other = 0; other < static_cast<int>(grid.size()); ++other)
    if (material.Stands(other))
      nearest = std::min(nearest, (grid.CentreOf(other) - grid.CentreOf(cell)).norm());
  return nearest;
}

/// How many cells are told apart from all others at all.
int CheckDistances(const RoughMaterial& material, double farthest) {
  int near = 0;
  for (int cell = 0; cell < static_cast<int>(material.grid().size()); ++cell) {
    const double looked = DistanceByLooking(material, cell);
    const double told = material.Distance(cell);
    if (looked < farthest) {
      EXPECT_NEAR(told, looked, 1e-5) << "cell " << cell;
      ++near;
    } else {
      EXPECT_GE(told, farthest - 1e-5) << "cell " << cell;
    }
  }
  return near;
}

// Whatever is taken off, in whatever order it becomes known, distances are those to what stands.
TEST(RoughMaterial, DistancesAreThoseToWhatStands) {
  RandomStream random(7, 0);
  for (int trial = 0; trial < 4; ++trial) {
    SCOPED_TRACE(trial);
    const RoughGrid grid{Vector2d(-3, 2), 0.5, 20 + 7 * trial, 45 - 5 * trial};
    std::vector<char> stands(grid.size(), 0);
    const double share = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 0.3 : 0.01;
    for (char& cell : stands) cell = random.Uniform(0, 1) < share;
    const double radius = 1.7 + 0.6 * trial;
    RoughMaterial material(grid, std::move(stands), radius);
    const auto place = [&] {
      return Vector2d(grid.origin + Vector2d(random.Uniform(0, grid.cell * grid.columns),
                                             random.Uniform(0, grid.cell * grid.rows)));
    };
    int near = CheckDistances(material, 2 * radius);
    for (int cut = 0; cut < 4; ++cut) {
      std::vector<int> taken;
      Vector2d at = place();
      for (int step = 0; step < 3; ++step) {
        const Vector2d to = at + (place() - at).normalized() * 2;
        material.Sweep(at, to, taken);
        at = to;
      }
      material.Refresh(taken);
      near += CheckDistances(material, 2 * radius);
    }
    EXPECT_GT(near, 0);
  }
}

}  // namespace
}  // namespace millpose
