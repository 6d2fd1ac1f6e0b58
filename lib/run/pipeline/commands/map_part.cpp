// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/map_part.hpp"

#include "base/csv.hpp"
#include "base/error.hpp"
#include "geometry/mesh/bvh.hpp"
#include "job/assemble.hpp"
#include "job/measured_map.hpp"
#include "planning/result/gear_course.hpp"
#include "planning/result/station.hpp"
#include "run/pipeline/commands/plan_folder.hpp"
#include "run/pipeline/outputs/write_results.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kReadMicrometre = 1e-3;  // mm

/// Where the points of a plan are on the part, and how the gears then stand: by pass and point.
std::vector<std::vector<MilledPlace>> PlacesOnPart(const PlanResult& plan, const JobInputs& inputs) {
  const std::vector<std::vector<GearValues>> flanks = FlankLevers(plan, MakeGearModel(inputs.cell));
  std::vector<std::vector<MilledPlace>> places;
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const PassResult& pass = plan.passes[p];
    places.emplace_back();
    for (size_t i = 0; i < pass.points.size(); ++i)
      places[p].push_back(
          {PartAt(plan, ExternalAt(pass, i)).inverse(Eigen::Isometry) * pass.points[i].point.position,
           flanks[p][i]});
  }
  return places;
}

/// The cut points of the finished face, in P, to be asked for the nearest.
class MappedFace {
 public:
  MappedFace(const PlanResult& plan, const std::vector<std::vector<MilledPlace>>& places, int finished_from) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (size_t p = 0; p < plan.passes.size(); ++p) {
      const PassResult& pass = plan.passes[p];
      if (pass.pass < finished_from) continue;
      for (size_t i = 0; i < pass.points.size(); ++i) {
        const PlannedPoint& point = pass.points[i];
        if (point.skip != Infeasibility::kNone || point.point.kind != PointKind::kCut) continue;
        places_.push_back(places[p][i]);
        boxes.emplace_back(places_.back().position);
      }
    }
    tree_ = Bvh(boxes);
  }

  bool empty() const { return places_.empty(); }
  /// The cut point nearest to p.
  const MilledPlace& Nearest(const Vector3d& p) const {
    const auto distance = [&](int i) { return (places_[static_cast<size_t>(i)].position - p).squaredNorm(); };
    return places_[static_cast<size_t>(
        tree_.Nearest(p, std::numeric_limits<double>::infinity(), distance).first)];
  }

 private:
  std::vector<MilledPlace> places_;
  Bvh tree_;
};

std::vector<ErrorReading> ReadErrors(const std::filesystem::path& file, const FileRoot& root,
                                     const MappedFace& face, double most_distance, double& farthest) {
  constexpr double kMostError = 1e4;  // µm
  const std::string name = file.string();
  const CsvTable table = ReadCsv(root.Read(file), name, {{"x_mm", "y_mm", "z_mm", "error_um"}, {}});
  std::vector<ErrorReading> readings;
  std::vector<Problem> problems;
  for (size_t row = 0; row < table.size(); ++row) {
    const Vector3d place(table.At(row, "x_mm"), table.At(row, "y_mm"), table.At(row, "z_mm"));
    const MilledPlace& nearest = face.Nearest(place);
    const double error = table.At(row, "error_um"), distance = (nearest.position - place).norm();
    if (distance > most_distance)
      problems.push_back(
          {{name, table.line(row)},
           fmt::format("the place is {:.3g} mm from the nearest cut point of the finished face; "
                       "allowed: the cutter's diameter, {:.6g} mm (workpiece's frame)",
                       distance, most_distance)});
    if (std::abs(error) > kMostError)
      problems.push_back({{name, table.line(row)},
                          fmt::format("error_um: given {}; allowed: within ±{}", error, kMostError)});
    farthest = std::max(farthest, distance);
    readings.push_back({{place, nearest.flanks}, kReadMicrometre * error});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return readings;
}

/// What the map says at every planned point. Leads and upper layers go with the face below or beside them.
void FillMap(const PlanResult& plan, const std::vector<std::vector<MilledPlace>>& places, MappedPart& part) {
  std::vector<MapRow> rows;
  size_t number = 0;
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t i = 0; i < plan.passes[p].points.size(); ++i, ++number) {
      const PlannedPoint& point = plan.passes[p].points[i];
      if (point.skip != Infeasibility::kNone) continue;
      MapRow row;
      row.point = number;
      const MilledPlace& place = places[p][i];
      row.place = place.position;
      row.q = point.q;
      row.other = OtherAlongNormal(point);
      const double before = point.compensation ? point.compensation->map : 0;
      part.corrected_before = part.corrected_before || before != 0;
      row.amount = before + part.share * part.fitted.field.At(place);
      row.sd = part.fitted.field.DeviationAt(place);
      part.largest = std::max(part.largest, std::abs(row.amount));
      part.largest_sd = std::max(part.largest_sd, row.sd);
      rows.push_back(row);
    }
  part.csv = MapCsv(rows);
}

std::string VerdictOf(const MappedPart& part) {
  constexpr double kShown = 1000;
  const FittedErrors& fitted = part.fitted;
  if (!fitted.significant)
    return fmt::format(
        "nothing to correct: what {} readings say of each other is no more than chance makes of "
        "readings without a pattern",
        fitted.readings);
  if (part.repeats && !part.repeats->certain())
    return "nothing to correct: the first part's error does not come back on the second";
  std::string text = fmt::format(
      "the face errs smoothly: {:.0f} % of the readings' squares are foretold by their "
      "neighbours, {:.1f} µm (RMS) are not",
      100 * fitted.explained, kShown * fitted.left);
  if (!part.repeats) text += "; whether another part errs likewise, only a second one tells (--second)";
  return text;
}

}  // namespace

MappedPart MapPart(const CalibrateArguments& arguments, const std::optional<std::filesystem::path>& second) {
  const auto& [plan, inputs, summary] =
      ReadPlanFolder(arguments.plan, arguments.job, arguments.root, PlanFiles::kAsTheyStand);
  const std::vector<std::vector<MilledPlace>> places = PlacesOnPart(plan, inputs);
  const MappedFace face(plan, places, FinishedFrom(inputs.job, plan.passes.size()));
  if (face.empty()) throw InputError({arguments.plan.string()}, "the plan cuts nothing");
  MappedPart part;
  const double most = inputs.cell.tool.cutter_diameter;
  std::vector<ErrorReading> readings =
      ReadErrors(arguments.measured, arguments.root, face, most, part.farthest);
  part.fitted = FitErrors(readings);
  if (second) {
    const std::vector<ErrorReading> other = ReadErrors(*second, arguments.root, face, most, part.farthest);
    part.repeats = RepeatsOf(part.fitted.field, other);
    part.share = std::clamp(part.repeats->share, 0.0, 1.0);
    const bool first_significant = part.fitted.significant;
    readings.insert(readings.end(), other.begin(), other.end());
    part.fitted = FitErrors(readings);
    part.fitted.significant = part.fitted.significant && first_significant;
  }
  part.usable = part.fitted.significant && (!part.repeats || part.repeats->certain());
  part.verdict = VerdictOf(part);
  if (part.usable) FillMap(plan, places, part);
  return part;
}

}  // namespace millpose
