// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/edge.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

constexpr int kCornerSlices = 8;  // of a quarter circle, at least
constexpr int kBottomSlices = 6;  // of the flat

int Parts(double length, double step) {
  return std::max(1, static_cast<int>(std::ceil(length / step - 1e-9)));
}

/// The flat below the corner: it cuts only where the cutter leans backwards.
void AddBottom(const CutterShape& cutter, std::vector<EdgeSlice>& slices) {
  const double flat = cutter.radius - cutter.corner_radius;
  if (flat <= 0) return;
  for (int i = 0; i < kBottomSlices; ++i)
    slices.push_back({flat * (i + 0.5) / kBottomSlices, 0, flat / kBottomSlices, 0, 1});
}

void AddCorner(const CutterShape& cutter, double height, double step, std::vector<EdgeSlice>& slices) {
  const double r = cutter.corner_radius, up_to = std::min(height, r);
  if (r <= 0) return;
  const double end = Acos(1 - up_to / r);
  // By angle, so that the flat lowest part has as many slices as the steep one.
  const int count = std::max(Parts(up_to, step), Parts(end, kPi / 2 / kCornerSlices));
  for (int i = 0; i < count; ++i) {
    const auto [s, c] = SinCos(end * (i + 0.5) / count);
    slices.push_back({cutter.radius - r + r * s, r * (1 - c), r * end / count, s, c});
  }
}

void AddCylinder(const CutterShape& cutter, double height, double step, std::vector<EdgeSlice>& slices) {
  const double rest = height - cutter.corner_radius;
  if (rest <= 0) return;
  const int count = Parts(rest, step);
  for (int i = 0; i < count; ++i)
    slices.push_back({cutter.radius, cutter.corner_radius + rest * (i + 0.5) / count, rest / count, 1, 0});
}

}  // namespace

std::vector<EdgeSlice> SliceEdge(const CutterShape& cutter, double height, double step) {
  const double up_to = std::min(height, cutter.length);
  std::vector<EdgeSlice> slices;
  AddBottom(cutter, slices);
  AddCorner(cutter, up_to, step, slices);
  AddCylinder(cutter, up_to, step, slices);
  return slices;
}

Eigen::Vector3d EdgeForce(const EdgeModel& model, double chip) {
  const double tangential = model.material.kc11 * Pow(chip, 1 - model.material.mc);
  return tangential * Eigen::Vector3d(1, model.radial_ratio, model.axial_ratio);
}

}  // namespace millpose
