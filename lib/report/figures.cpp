// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report.hpp"

namespace millpose {
namespace {

std::optional<Spread> SpreadOf(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return Spread{values.front(), median, values.back()};
}

std::optional<PaperFigures> FiguresOfPaper(const PlanResult& plan) {
  PaperFigures figures;
  std::vector<double> position, angle, above;
  for (const PassResult& pass : plan.passes) {
    for (const PlannedPoint& point : pass.points) {
      for (const PaperAnswer& answer : point.paper) {
        ++figures.searched;
        figures.within_tolerance += answer.within_tolerance;
        figures.usable += point.genetic_optimum > 0;
        figures.on_path += point.skip == Infeasibility::kNone && point.from_genetic;
        position.push_back(answer.position_error);
        angle.push_back(answer.angle_error);
        if (answer.within_tolerance && point.own_optimum > 0 && std::isfinite(answer.objective))
          above.push_back(answer.objective / point.own_optimum - 1);
      }
    }
  }
  if (figures.searched == 0) return std::nullopt;
  figures.position_error = *SpreadOf(std::move(position));
  figures.angle_error = *SpreadOf(std::move(angle));
  figures.above_exhaustive = SpreadOf(std::move(above));
  return figures;
}

}  // namespace

PlanFigures Figures(const PlanResult& plan) {
  PlanFigures figures;
  std::vector<double> t1, t2, n, f;
  double clearance = 0;
  size_t genetic = 0;
  Smoothing smoothing;
  for (const PassResult& pass : plan.passes) {
    smoothing.square_before += pass.smoothing.square_before;
    smoothing.square_after += pass.smoothing.square_after;
    smoothing.objective_before += pass.smoothing.objective_before;
    smoothing.objective_after += pass.smoothing.objective_after;
    figures.poses_checked += pass.poses_checked;
    figures.candidates += pass.nodes;
    figures.candidates_checked += pass.nodes_checked;
    figures.pairs_checked += pass.pairs_checked;
    figures.pairs_saved += pass.pairs_saved;
    figures.pieces += pass.pieces.size();
    for (const PlannedPoint& point : pass.points) {
      ++figures.total;
      if (point.skip != Infeasibility::kNone) continue;
      t1.push_back(point.indices.lambda_t1);
      t2.push_back(point.indices.lambda_t2);
      n.push_back(point.indices.lambda_n);
      f.push_back(point.objective);
      genetic += point.from_genetic ? 1 : 0;
      clearance = figures.planned == 0 ? point.clearance : std::min(clearance, point.clearance);
      ++figures.planned;
    }
  }
  for (const LinkMove& gap : plan.gaps) {
    figures.poses_checked += gap.poses_checked;
    if (!gap.planned) continue;
    ++figures.gaps_planned;
    if (figures.planned > 0) clearance = std::min(clearance, gap.clearance);
  }
  if (smoothing.square_before > 0)
    figures.acceleration_ratio = std::sqrt(smoothing.square_after / smoothing.square_before);
  if (smoothing.objective_before > 0)
    figures.smoothing_loss = smoothing.objective_after / smoothing.objective_before - 1;
  figures.lambda_t1 = SpreadOf(std::move(t1));
  figures.lambda_t2 = SpreadOf(std::move(t2));
  figures.lambda_n = SpreadOf(std::move(n));
  figures.objective = SpreadOf(std::move(f));
  figures.paper = FiguresOfPaper(plan);
  figures.price = PriceOf(plan);
  if (figures.planned > 0) {
    figures.ga_nodes_share = static_cast<double>(genetic) / static_cast<double>(figures.planned);
    figures.clearance_min = clearance;
  }
  return figures;
}

}  // namespace millpose
