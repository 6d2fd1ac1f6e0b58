// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/fixed_figures.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/units.hpp"
#include "report/lost_motion.hpp"

namespace millpose {
namespace {

struct WorstAndMedian {
  double worst = 0, median = 0;
};

WorstAndMedian Of(const std::vector<PointFigures>& points, double PointFigures::*member) {
  std::vector<double> values;
  for (const PointFigures& point : points) values.push_back(point.*member);
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return {values.back(), median};
}

std::string Ratio(double plan, double fixed) {
  return fixed > 0 ? fmt::format("{:.3f}", plan / fixed) : std::string("-");
}

}  // namespace

std::vector<FixedFigure> FixedFigures(const std::vector<PointFigures>& plan,
                                      const std::vector<PointFigures>& fixed) {
  std::vector<FixedFigure> figures;
  const auto add = [&](const char* key, const char* label, double PointFigures::*member) {
    const WorstAndMedian of_plan = Of(plan, member), of_fixed = Of(fixed, member);
    figures.push_back({key, label, of_plan.worst, of_fixed.worst, of_plan.median, of_fixed.median});
  };
  add("objective", "objective", &PointFigures::objective);
  if (std::any_of(plan.begin(), plan.end(), [](const PointFigures& point) { return point.length > 0; })) {
    add("normal", "|n'cF|", &PointFigures::normal);
    add("length", "|cF|", &PointFigures::length);
  }
  return figures;
}

std::string FixedRatios(const FixedFigure& figure) {
  return fmt::format("worst {}, median {}", Ratio(figure.plan_worst, figure.fixed_worst),
                     Ratio(figure.plan_median, figure.fixed_median));
}

std::string FixedReversals(const GearTally& plan, const GearTally& fixed, bool known) {
  return fmt::format("reversals {} / {}; marks {} / {}", plan.Turns(), fixed.Turns(), MarksText(plan, known),
                     MarksText(fixed, known));
}

std::vector<NamedChoice> NamedChoices(const FixedComparison& fixed) {
  std::vector<NamedChoice> named;
  const auto degrees = [](const FixedChoice& job) {
    return fmt::format("{:.0f} deg", RadToDeg(job.rotations.at(0)));
  };
  const std::string by_sum =
      fmt::format("by its sum within {:.0f} % of the best worst value", 100 * kNearBest);
  if (!fixed.job.points.empty()) {
    named.push_back({"the best single rotation of the job, " + degrees(fixed.job), &fixed.job});
    if (fixed.job_by_sum.rotations != fixed.job.rotations)
      named.push_back(
          {fmt::format("the job's best {}, {}", by_sum, degrees(fixed.job_by_sum)), &fixed.job_by_sum});
    if (!fixed.job_by_length.points.empty() && fixed.job_by_length.rotations != fixed.job.rotations)
      named.push_back({"the job's best in |cF|, " + degrees(fixed.job_by_length), &fixed.job_by_length});
  }
  if (!fixed.passes.points.empty()) {
    named.push_back({"the best rotation of each pass", &fixed.passes});
    if (fixed.passes_by_sum.rotations != fixed.passes.rotations)
      named.push_back({fmt::format("each pass's best {}", by_sum), &fixed.passes_by_sum});
    if (!fixed.passes_by_length.points.empty() && fixed.passes_by_length.rotations != fixed.passes.rotations)
      named.push_back({"each pass's best in |cF|", &fixed.passes_by_length});
  }
  return named;
}

}  // namespace millpose
