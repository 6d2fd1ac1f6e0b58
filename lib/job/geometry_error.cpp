// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/geometry_error.hpp"

#include "machine/robot/deviations.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A place of the face on the part, its normal, and how far the tip is off along it, mm.
struct OffPlace {
  Vector3d position, normal;
  double off = 0;
};

ArmDeviations MakeDeviations(const DeviationSettings& settings) {
  ArmDeviations deviations;
  for (size_t i = 0; i < deviations.shift.size(); ++i) {
    deviations.shift[i] = settings.shifts[i];
    deviations.turn[i] = settings.turns[i];
  }
  return deviations;
}

/// What is left, at the worst place, once the part's frame follows the arm.
double LeftOfFrame(const std::vector<OffPlace>& places) {
  Vector3d centre = Vector3d::Zero();
  for (const OffPlace& place : places) centre += place.position / static_cast<double>(places.size());
  double size = 1;
  for (const OffPlace& place : places) size = std::max(size, (place.position - centre).norm());
  Eigen::MatrixXd rows(places.size(), 6);
  Eigen::VectorXd off(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    rows.block<1, 3>(row, 0) = places[i].normal.transpose();
    rows.block<1, 3>(row, 3) = ((places[i].position - centre) / size).cross(places[i].normal).transpose();
    off[row] = places[i].off;
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> fit;
  fit.setThreshold(1e-6);  // a flat face says nothing of shifts along it
  fit.compute(rows);
  const Eigen::VectorXd frame = fit.solve(off);
  return (off - rows * frame).cwiseAbs().maxCoeff();
}

}  // namespace

std::optional<GeometryFigures> ErrorOfGeometry(const ArmSettings& arm, const PlanResult& plan,
                                               int finished_from) {
  if (!arm.deviations) return std::nullopt;
  const ArmDeviations deviations = MakeDeviations(*arm.deviations);
  std::vector<OffPlace> places;
  for (const PassResult& pass : plan.passes) {
    if (pass.pass < finished_from) continue;
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const PlannedPoint& planned = pass.points[i];
      if (planned.point.kind != PointKind::kCut || planned.skip != Infeasibility::kNone) continue;
      const ExternalPosition& external = ExternalAt(pass, i);
      const Vector3d tip = plan.X_FT.translation();
      const Vector3d moved =
          TrueFlange(plan.arm, deviations, planned.q) * tip - ForwardFlange(plan.arm, planned.q) * tip;
      const Pose X_PW = PartAt(plan, external).inverse(Eigen::Isometry);
      places.push_back({X_PW * planned.point.position, X_PW.linear() * planned.point.normal,
                        planned.point.normal.dot(BaseAt(plan, external).linear() * moved)});
    }
  }
  if (places.empty()) return std::nullopt;
  GeometryFigures figures{LeftOfFrame(places), 0, arm.serial, arm.deviations->date};
  for (const OffPlace& place : places) figures.absolute = std::max(figures.absolute, std::abs(place.off));
  return figures;
}

}  // namespace millpose
