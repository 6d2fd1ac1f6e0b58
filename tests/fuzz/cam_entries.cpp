// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "tests/fuzz/entries.hpp"
#include "toolpath/cam/cam_import.hpp"

namespace millpose {
namespace {

void Path(const CamPath& path) {
  Demand(!path.points.empty() || !path.holes_left_out.empty());
  for (const CamPoint& point : path.points) {
    Demand(point.position.allFinite() && std::isfinite(point.feed_rate));
    Demand(std::abs(point.axis.norm() - 1) < 1e-6);
  }
  if (path.points.size() > 20'000) return;
  CamImportOptions options;
  options.spacing = 1e9;
  ImportCamPath(path, nullptr, options, nullptr);
}

void Apt(std::string_view bytes) {
  CamReadOptions options;
  options.chord_tolerance = 0.1;
  LetRefuse([&] { Path(ReadApt(bytes, "fuzz", options)); });
}

void Gcode(std::string_view bytes) {
  CamReadOptions options;
  options.chord_tolerance = 0.1;
  options.rotary_axes = RotaryAxes({{'C', -Eigen::Vector3d::UnitZ(), {10, 0, 0}, true},
                                    {'B', Eigen::Vector3d::UnitY(), {0, 0, 200}, false}});
  LetRefuse([&] { Path(ReadGcode(bytes, "fuzz", options)); });
}

}  // namespace

std::vector<FuzzEntry> CamEntries() {
  return {{"apt", Apt}, {"gcode", Gcode}, {"cam_csv", [](std::string_view bytes) {
                                             LetRefuse([&] { Path(ReadCamCsv(bytes, "fuzz")); });
                                           }}};
}

}  // namespace millpose
