// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/geometry_error.hpp"

#include "job/assemble.hpp"
#include "planning/face/arm_geometry.hpp"

namespace millpose {
namespace {

/// The largest along the normals, mm: less what a frame measured with the arm takes up, and whole.
struct LargestOffs {
  double after_frame = 0, absolute = 0;
};

std::optional<LargestOffs> LargestOffsOf(const PlanResult& plan, const ArmDeviations& deviations,
                                         int finished_from) {
  const std::vector<OffPlace> places = OffPlaces(plan, deviations, finished_from);
  if (places.empty()) return std::nullopt;
  const MeasuredFrame frame = FrameByArm(places);
  LargestOffs largest;
  for (const OffPlace& place : places) {
    const Eigen::Vector3d off = place.off.head<3>(), left = off - frame.At(place.position).head<3>();
    largest.after_frame = std::max(largest.after_frame, std::abs(place.normal.dot(left)));
    largest.absolute = std::max(largest.absolute, std::abs(place.normal.dot(off)));
  }
  return largest;
}

}  // namespace

std::optional<GeometryFigures> ErrorOfGeometry(const ArmSettings& arm, const PlanResult& plan,
                                               int finished_from, bool taken_out) {
  if (!arm.deviations) return std::nullopt;
  ArmDeviations frames = MakeDeviations(*arm.deviations);
  ArmDeviations joints;
  // What is left of both together is told as geometry.
  if (!taken_out) joints.law = std::exchange(frames.law, {});
  const std::optional<LargestOffs> by_frames = LargestOffsOf(plan, frames, finished_from);
  if (!by_frames) return std::nullopt;
  GeometryFigures figures{by_frames->after_frame, by_frames->absolute, arm.serial,
                          arm.deviations->date,   taken_out,           arm.deviations->uncertainty};
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      if (point.compensation && point.compensation->arm_left)
        figures.left = std::max(figures.left.value_or(0), *point.compensation->arm_left);
  if (!arm.deviations->gears.empty() || !arm.deviations->couplings.empty())
    figures.gears = taken_out ? LeftBetweenPoints(plan, frames.law, finished_from)
                              : LargestOffsOf(plan, joints, finished_from)->after_frame;
  return figures;
}

}  // namespace millpose
