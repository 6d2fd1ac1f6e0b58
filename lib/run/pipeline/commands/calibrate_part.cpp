// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/calibrate_part.hpp"

#include <limits>

#include "base/csv.hpp"
#include "base/error.hpp"
#include "job/assemble.hpp"
#include "planning/result/station.hpp"
#include "report/deflection.hpp"
#include "run/pipeline/commands/plan_folder.hpp"
#include "run/pipeline/outputs/write_results.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A cut point of the finished face, in P.
struct PlaceOfReading {
  Vector3d position;
  FaceReading predicted;
};

std::vector<PlaceOfReading> FaceOf(const PlanResult& plan, const JobInputs& inputs) {
  const int finished_from = FinishedFrom(inputs.job, plan.passes.size());
  const DeflectionReport report =
      PredictDeflections(plan, CuttingForce{}, MakeCompliances(inputs.cell), finished_from);
  std::vector<const PlannedPoint*> points;
  std::vector<const ExternalPosition*> externals;
  for (const PassResult& pass : plan.passes)
    for (size_t i = 0; i < pass.points.size(); ++i) {
      points.push_back(&pass.points[i]);
      externals.push_back(&ExternalAt(pass, i));
    }
  std::vector<PlaceOfReading> face;
  for (const DeflectedPoint& deflected : report.points) {
    const PlannedPoint& point = *points[deflected.number];
    const Pose X_PW = PartAt(plan, *externals[deflected.number]).inverse();
    if (deflected.pass < finished_from) continue;
    FaceReading predicted;
    predicted.side = deflected.engagement.side;
    predicted.predicted = deflected.deflection.normal;
    if (point.compensation && !point.compensation->force.isZero(0.0)) {
      predicted.predicted = point.compensation->normal.expected;
      predicted.taken = point.compensation->normal.taken;
    } else if (predicted.side == CutSide::kAir) {
      continue;
    }
    if (point.compensation) predicted.taken += point.compensation->map;
    face.push_back({X_PW * point.point.position, predicted});
  }
  return face;
}

/// Readings at the same place share a number.
void NumberPlaces(const std::vector<Vector3d>& places, std::vector<FaceReading>& readings) {
  constexpr double kSame = 0.01;  // mm
  for (size_t i = 0; i < places.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if ((places[i] - places[j]).norm() < kSame) {
        if (readings[j].place < 0) readings[j].place = static_cast<int>(j);
        readings[i].place = readings[j].place;
        break;
      }
}

}  // namespace

CalibratedPart CalibratePart(const CalibrateArguments& arguments) {
  constexpr double kMillimetre = 1e-3, kMost = 1e5;  // µm to mm; µm
  const std::string name = arguments.measured.string();
  const CsvTable table =
      ReadCsv(arguments.root.Read(arguments.measured), name, {{"x_mm", "y_mm", "z_mm", "error_um"}, {}});
  const auto& [plan, inputs, summary] =
      ReadPlanFolder(arguments.plan, arguments.job, arguments.root, PlanFiles::kAsTheyStand);
  const std::vector<PlaceOfReading> face = FaceOf(plan, inputs);
  if (face.empty())
    throw InputError({arguments.plan.string()},
                     "the plan predicts no deflection: it needs process.cutting, or compensation by measured "
                     "forces");
  CalibratedPart part;
  std::vector<FaceReading> readings;
  std::vector<Vector3d> places;
  std::vector<Problem> problems;
  for (size_t row = 0; row < table.size(); ++row) {
    const Vector3d place(table.At(row, "x_mm"), table.At(row, "y_mm"), table.At(row, "z_mm"));
    const auto nearest = std::ranges::min_element(
        face, {}, [&](const PlaceOfReading& other) { return (other.position - place).squaredNorm(); });
    const double distance = (nearest->position - place).norm();
    const double most = inputs.cell.tool.cutter_diameter;
    const double error = table.At(row, "error_um");
    if (distance > most)
      problems.push_back(
          {{name, table.line(row)},
           fmt::format("the place is {:.3g} mm from the nearest cut point of the plan's finished "
                       "face; allowed: the cutter's diameter, {:.6g} mm (x_mm, y_mm, z_mm count "
                       "in the workpiece's frame)",
                       distance, most)});
    if (std::abs(error) > kMost)
      problems.push_back(
          {{name, table.line(row)}, fmt::format("error_um: given {}; allowed: within ±{}", error, kMost)});
    part.farthest = std::max(part.farthest, distance);
    FaceReading reading = nearest->predicted;
    reading.measured = kMillimetre * error;
    readings.push_back(reading);
    places.push_back(place);
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  NumberPlaces(places, readings);
  part.found = Calibrate(readings);
  part.factors = inputs.job.force_factors;
  for (const auto& [side, factor] : {std::pair{CutSide::kUp, &part.factors.up},
                                     {CutSide::kDown, &part.factors.down},
                                     {CutSide::kSlot, &part.factors.slot}}) {
    const CalibratedFactor& of_side = part.found.sides[static_cast<size_t>(side)];
    *factor *= of_side.determined ? of_side.value : part.found.scale.value;
  }
  return part;
}

}  // namespace millpose
