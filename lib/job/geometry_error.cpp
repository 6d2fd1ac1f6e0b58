// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/geometry_error.hpp"

#include "job/assemble.hpp"
#include "planning/face/arm_geometry.hpp"

namespace millpose {

std::optional<GeometryFigures> ErrorOfGeometry(const ArmSettings& arm, const PlanResult& plan,
                                               int finished_from) {
  if (!arm.deviations) return std::nullopt;
  const std::vector<OffPlace> places = OffPlaces(plan, MakeDeviations(*arm.deviations), finished_from);
  if (places.empty()) return std::nullopt;
  const MeasuredFrame frame = FrameByArm(places);
  GeometryFigures figures{0, 0, arm.serial, arm.deviations->date, false, arm.deviations->uncertainty};
  for (const OffPlace& place : places) {
    const Eigen::Vector3d off = place.off.head<3>(), left = off - frame.At(place.position).head<3>();
    figures.largest = std::max(figures.largest, std::abs(place.normal.dot(left)));
    figures.absolute = std::max(figures.absolute, std::abs(place.normal.dot(off)));
  }
  return figures;
}

}  // namespace millpose
