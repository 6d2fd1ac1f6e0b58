// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/fixed_figures.hpp"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace millpose
