// SPDX-License-Identifier: GPL-3.0-or-later
// Reading, repairing and checking a large mesh; peak memory beside the time.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "geometry/import/mesh_import.hpp"

namespace millpose {
namespace {

void Append(std::string& bytes, const Eigen::Vector3d& p) {
  for (int k = 0; k < 3; ++k) {
    const auto bits = std::bit_cast<uint32_t>(static_cast<float>(p[k]));
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> (8 * i) & 0xff);
  }
}

// A binary STL of a bumpy torus of 2 · rows · columns triangles.
std::string Torus(int rows, int columns) {
  const auto at = [&](int i, int k) {
    const double u = 2 * M_PI * (i % rows) / rows, v = 2 * M_PI * (k % columns) / columns;
    const double r = 400 + 5 * std::sin(40 * u) * std::sin(20 * v);
    return Eigen::Vector3d((1500 + r * std::cos(v)) * std::cos(u), (1500 + r * std::cos(v)) * std::sin(u),
                           r * std::sin(v));
  };
  std::string bytes(80, ' ');
  const uint32_t count = 2 * static_cast<uint32_t>(rows) * static_cast<uint32_t>(columns);
  bytes.reserve(84 + 50 * size_t{count});
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k)
      for (const auto& corners : {std::array{at(i, k), at(i + 1, k), at(i + 1, k + 1)},
                                  std::array{at(i, k), at(i + 1, k + 1), at(i, k + 1)}}) {
        bytes.append(12, '\0');
        for (const auto& p : corners) Append(bytes, p);
        bytes.append(2, '\0');
      }
  return bytes;
}

void ImportStl(benchmark::State& state) {
  const int columns = 1000, rows = static_cast<int>(state.range(0)) / 2 / columns;
  const std::string bytes = Torus(rows, columns);
  for (auto _ : state) {
    const ImportResult import = ImportMesh(ReadMesh(bytes, "torus"), {}, "torus");
    if (import.report.rims > 0 || import.report.crossings.pairs > 0)
      state.SkipWithError("the torus is not sound");
    benchmark::DoNotOptimize(import.mesh.face_count());
  }
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;
}
BENCHMARK(ImportStl)->Arg(200'000)->Arg(2'000'000)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace millpose
