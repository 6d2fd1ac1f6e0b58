// SPDX-License-Identifier: GPL-3.0-or-later
// Material taken off plates by zigzags of a bull-nose cutter; "points" are the motions, "lines" the
// lattice's.
#include <benchmark/benchmark.h>

#include "tests/geometry/shapes.hpp"
#include "toolpath/stock/standing_stock.hpp"

namespace millpose {
namespace {

/// Over a plate of that edge, 8 mm from pass to pass, a point every 5 mm.
std::vector<CutterMotion> Zigzag(double edge) {
  std::vector<CutterMotion> motions;
  bool back = false;
  for (double y = 0; y <= edge; y += 8, back = !back)
    for (double x = 0; x + 5 <= edge; x += 5) {
      const auto place = [&](double at) -> CutterPlace {
        return {{back ? edge - at : at, y, 7}, Eigen::Vector3d(0.02, 0.01, 1).normalized()};
      };
      motions.push_back({place(x), place(x + 5), 0});
    }
  return motions;
}

void Removal(benchmark::State& state) {
  const auto edge = static_cast<double>(state.range(0));
  const double spacing = static_cast<double>(state.range(1)) / 1000;
  const Triangles blank = BoxShape({0, 0, 0}, {edge, edge, 10});
  const std::vector<CutterMotion> motions = Zigzag(edge);
  double removed = 0;
  for (auto _ : state) {
    StandingStock stock(blank, spacing);
    const double before = stock.Volume();
    stock.Remove({10, 2, 40}, motions, 2);
    removed = before - stock.Volume();
  }
  state.counters["points"] = static_cast<double>(motions.size());
  state.counters["removed_cm3"] = removed / 1e3;
}
BENCHMARK(Removal)->Args({600, 500})->Args({2000, 1000})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace millpose
