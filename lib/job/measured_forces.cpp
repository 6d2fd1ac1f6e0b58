// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/measured_forces.hpp"

#include "base/csv.hpp"
#include "base/error.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

class MeasuredForces {
 public:
  MeasuredForces(const JobInputs& inputs, const PlanResult& plan)
      : file_(inputs.job.force_file),
        table_(ReadCsv(inputs.force_bytes, file_,
                       {{"point", "x_mm", "y_mm", "z_mm", "force_x_N", "force_y_N", "force_z_N"}, {}})),
        plan_(plan) {}

  PointForces Read() {
    PointForces forces;
    std::vector<const PlannedPoint*> points;
    std::vector<const ExternalPosition*> externals;  // of each
    std::vector<Vector3d*> places;
    for (const PassResult& pass : plan_.passes) forces.emplace_back(pass.points.size(), Vector3d::Zero());
    for (size_t p = 0; p < plan_.passes.size(); ++p)
      for (size_t i = 0; i < plan_.passes[p].points.size(); ++i) {
        points.push_back(&plan_.passes[p].points[i]);
        externals.push_back(&ExternalAt(plan_.passes[p], i));
        places.push_back(&forces[p][i]);
      }
    std::vector<char> given(points.size(), 0);
    for (size_t row = 0; row < table_.size(); ++row) {
      const double number = table_.At(row, "point");
      if (number != std::floor(number) || number < 0 || number >= static_cast<double>(points.size())) {
        Add(row, fmt::format("point: given {}; allowed: 0 to {}, the points of this plan", number,
                             points.size() - 1));
        continue;
      }
      const auto at = static_cast<size_t>(number);
      if (std::exchange(given[at], 1) != 0) Add(row, fmt::format("point {} is given twice", at));
      CheckPlace(row, at, points[at]->point);
      const Vector3d force = Three(row, {"force_x_N", "force_y_N", "force_z_N"});
      if (force.norm() > kMostForce)
        Add(row, fmt::format("a force of {:.6g} N; allowed: up to {} N", force.norm(), kMostForce));
      *places[at] = PartAt(plan_, *externals[at]).linear() * force;
    }
    for (size_t at = 0; at < points.size() && problems_.size() < kMostProblems; ++at)
      if (given[at] == 0 && points[at]->skip == Infeasibility::kNone &&
          points[at]->point.kind == PointKind::kCut)
        problems_.push_back({{file_}, fmt::format("point {} is cut and has no row", at)});
    if (!problems_.empty()) throw InputError(std::move(problems_));
    return forces;
  }

 private:
  static constexpr double kMostForce = 1e6, kSamePlace = 0.01;  // N, mm
  static constexpr size_t kMostProblems = 100;

  void Add(size_t row, std::string message) {
    if (problems_.size() < kMostProblems)
      problems_.push_back({{file_, table_.line(row)}, std::move(message)});
  }

  Vector3d Three(size_t row, const std::array<const char*, 3>& columns) const {
    return {table_.At(row, columns[0]), table_.At(row, columns[1]), table_.At(row, columns[2])};
  }

  void CheckPlace(size_t row, size_t number, const MillingPoint& point) {
    const double off = (Three(row, {"x_mm", "y_mm", "z_mm"}) - point.position).norm();
    if (off > kSamePlace)
      Add(row, fmt::format("point {} of this plan is {:.3f} mm from x_mm, y_mm, z_mm; allowed: {} mm: the "
                           "forces were measured on another plan",
                           number, off, kSamePlace));
  }

  std::string file_;
  CsvTable table_;
  const PlanResult& plan_;
  std::vector<Problem> problems_;
};

}  // namespace

PointForces ReadMeasuredForces(const JobInputs& inputs, const PlanResult& plan) {
  return MeasuredForces(inputs, plan).Read();
}

}  // namespace millpose
