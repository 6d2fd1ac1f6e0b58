// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/fixed_figures.hpp"

#include <fmt/format.h>

#include "base/units.hpp"
#include "report/lost_motion.hpp"

namespace millpose {
namespace {

std::string Ratio(double plan, double fixed) {
  return fixed > 0 ? fmt::format("{:.3f}", plan / fixed) : std::string("-");
}

}  // namespace

std::vector<FixedFigure> FixedFigures(const ComparedFigures& plan, const ComparedFigures& fixed) {
  std::vector<FixedFigure> figures;
  const auto add = [&](const char* key, const char* label, OverPoints ComparedFigures::*figure) {
    figures.push_back({key, label, plan.*figure, fixed.*figure});
  };
  add("objective", "objective", &ComparedFigures::objective);
  if (plan.length.worst > 0) {
    add("normal", "|n'cF|", &ComparedFigures::normal);
    add("length", "|cF|", &ComparedFigures::length);
  }
  return figures;
}

std::string FixedRatios(const FixedFigure& figure) {
  return fmt::format("worst {}, median {}", Ratio(figure.plan.worst, figure.fixed.worst),
                     Ratio(figure.plan.median, figure.fixed.median));
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
  if (fixed.job.Exists()) {
    named.push_back({"the best single rotation of the job, " + degrees(fixed.job), &fixed.job});
    if (fixed.job_by_sum.rotations != fixed.job.rotations)
      named.push_back(
          {fmt::format("the job's best {}, {}", by_sum, degrees(fixed.job_by_sum)), &fixed.job_by_sum});
    if (fixed.job_by_length.Exists() && fixed.job_by_length.rotations != fixed.job.rotations)
      named.push_back({"the job's best in |cF|, " + degrees(fixed.job_by_length), &fixed.job_by_length});
  }
  if (fixed.passes.Exists()) {
    named.push_back({"the best rotation of each pass", &fixed.passes});
    if (fixed.passes_by_sum.rotations != fixed.passes.rotations)
      named.push_back({fmt::format("each pass's best {}", by_sum), &fixed.passes_by_sum});
    if (fixed.passes_by_length.Exists() && fixed.passes_by_length.rotations != fixed.passes.rotations)
      named.push_back({"each pass's best in |cF|", &fixed.passes_by_length});
  }
  return named;
}

}  // namespace millpose
