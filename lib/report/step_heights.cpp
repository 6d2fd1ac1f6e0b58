// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/step_heights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/trig.hpp"
#include "base/units.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

struct CutPoint {
  const PlannedPoint* planned = nullptr;
  size_t number = 0;
  int pass = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< on the part as it stands with all external axes at 0
};

PoseStep Between(const ToolUncertainty& tool, PoseStep::Why why, const CutPoint& a, const CutPoint& b) {
  PoseStep step{why, a.number, b.number, a.pass, b.pass, 0, a.planned->branch != b.planned->branch, 0};
  if (!a.planned->freedoms.empty() && !b.planned->freedoms.empty())
    step.rotation = std::abs(std::remainder(a.planned->freedoms[0] - b.planned->freedoms[0], 2 * kPi));
  step.height = StepHeight(tool, step.rotation, step.other_branch);
  return step;
}

/// The planned cut points of a pass by pieces.
std::vector<std::vector<CutPoint>> CutsOf(const PlanResult& plan, const PassResult& pass,
                                          size_t first_number) {
  std::vector<std::vector<CutPoint>> cuts;
  for (const Segment& piece : pass.pieces) {
    std::vector<CutPoint>& cut = cuts.emplace_back();
    for (int t = piece.first; t <= piece.last; ++t) {
      const PlannedPoint& point = pass.points[static_cast<size_t>(t)];
      if (point.skip == Infeasibility::kNone && point.point.kind == PointKind::kCut)
        cut.push_back({&point, first_number + static_cast<size_t>(t), pass.pass,
                       OnPartAtZero(plan, ExternalAt(pass, static_cast<size_t>(t)), point.point.position)});
    }
  }
  return cuts;
}

void AddParts(const PassResult& pass, const std::vector<std::vector<CutPoint>>& cuts,
              const ToolUncertainty& tool, std::vector<PoseStep>& parts) {
  using Why = PoseStep::Why;
  for (size_t p = 1; p < cuts.size(); ++p) {
    if (cuts[p - 1].empty() || cuts[p].empty()) continue;
    const bool lift = std::ranges::count(pass.lifts, static_cast<int>(p)) > 0;
    parts.push_back(Between(tool, lift ? Why::kLift : Why::kSplit, cuts[p - 1].back(), cuts[p].front()));
  }
  if (pass.opened_at >= 0 && !cuts.empty() && !cuts.front().empty() && !cuts.back().empty())
    parts.push_back(Between(tool, Why::kRing, cuts.back().back(), cuts.front().front()));
}

/// The planned cut points of the passes from `finished_from` on, sorted along their longest side, so that few
/// have to be looked at for a neighbour.
class FacePlaces {
 public:
  FacePlaces(const PlanResult& plan, int finished_from) {
    size_t first = 0;
    for (const PassResult& pass : plan.passes) {
      if (pass.pass >= finished_from)
        for (const std::vector<CutPoint>& cut : CutsOf(plan, pass, first))
          points_.insert(points_.end(), cut.begin(), cut.end());
      first += pass.points.size();
    }
    if (points_.empty()) return;
    Eigen::Vector3d lower = At(points_.front()), upper = lower;
    for (const CutPoint& point : points_)
      lower = lower.cwiseMin(At(point)), upper = upper.cwiseMax(At(point));
    (upper - lower).maxCoeff(&axis_);
    std::ranges::stable_sort(points_, {}, [&](const CutPoint& point) { return At(point)[axis_]; });
  }

  const std::vector<CutPoint>& points() const { return points_; }

  /// From a point of the list to its nearest in another pass, within the cutter's diameter.
  std::optional<PoseStep> ToNeighbour(size_t i, const ToolUncertainty& tool) const {
    double best = 2 * tool.radius * (1 + 1e-9);
    const CutPoint* nearest = nullptr;
    const auto look = [&](const CutPoint& other) {
      if (std::abs(At(other)[axis_] - At(points_[i])[axis_]) > best) return false;
      const double distance = (At(other) - At(points_[i])).norm();
      if (other.pass != points_[i].pass && distance < best) best = distance, nearest = &other;
      return true;
    };
    for (size_t j = i + 1; j < points_.size() && look(points_[j]); ++j) {
    }
    for (size_t j = i; j > 0 && look(points_[j - 1]); --j) {
    }
    if (!nearest) return std::nullopt;
    return Between(tool, PoseStep::Why::kNeighbours, points_[i], *nearest);
  }

 private:
  static const Eigen::Vector3d& At(const CutPoint& point) { return point.place; }

  std::vector<CutPoint> points_;
  int axis_ = 0;
};

std::string InWords(const PoseStep& step) {
  return fmt::format("{:.3g} mm (points {} and {}: {})", step.height, step.point, step.other,
                     step.other_branch
                         ? "in another branch"
                         : fmt::format("{:.0f} deg of rotation apart", RadToDeg(step.rotation)));
}

}  // namespace

double StepHeight(const ToolUncertainty& tool, double rotation, bool other_branch) {
  const double error = tool.tip + tool.radius * tool.axis;
  return 2 * error * (other_branch ? 1 : std::abs(SinCos(rotation / 2).sin));
}

const char* Name(PoseStep::Why why) {
  constexpr const char* kNames[] = {"lift", "split", "ring", "neighbours"};
  return kNames[static_cast<size_t>(why)];
}

PoseSteps FindPoseSteps(const PlanResult& plan, const ToolUncertainty& tool, int finished_from) {
  PoseSteps steps{tool, {}, std::nullopt};
  size_t first = 0;
  for (const PassResult& pass : plan.passes) {
    AddParts(pass, CutsOf(plan, pass, first), tool, steps.parts);
    first += pass.points.size();
  }
  const FacePlaces face(plan, finished_from);
  for (size_t i = 0; i < face.points().size(); ++i)
    if (const std::optional<PoseStep> step = face.ToNeighbour(i, tool))
      if (!steps.neighbours || step->height > steps.neighbours->height) steps.neighbours = step;
  return steps;
}

std::vector<PoseStep> FindPoseStepsAt(const PlanResult& plan, const ToolUncertainty& tool, int finished_from,
                                      size_t point) {
  std::vector<PoseStep> steps = FindPoseSteps(plan, tool, finished_from).parts;
  std::erase_if(steps, [&](const PoseStep& step) { return step.point != point && step.other != point; });
  const FacePlaces face(plan, finished_from);
  const auto here = std::ranges::find(face.points(), point, &CutPoint::number);
  if (here == face.points().end()) return steps;
  if (const auto step = face.ToNeighbour(static_cast<size_t>(here - face.points().begin()), tool))
    steps.push_back(*step);
  return steps;
}

std::string Describe(const PoseSteps& steps) {
  std::string text;
  const auto worst = std::ranges::max_element(steps.parts, {}, &PoseStep::height);
  if (worst != steps.parts.end())
    text += fmt::format(" {} where parts of pass {} meet", InWords(*worst), worst->pass);
  if (steps.neighbours)
    text += fmt::format("{} {} between passes {} and {}", text.empty() ? "" : ",", InWords(*steps.neighbours),
                        steps.neighbours->pass, steps.neighbours->other_pass);
  if (text.empty()) return text;
  return fmt::format(
      "the tool's tip is known to {:.3g} mm and its axis to {:.3g} deg: where poses change, steps in the "
      "surface "
      "may be up to{}",
      steps.tool.tip, RadToDeg(steps.tool.axis), text);
}

}  // namespace millpose
