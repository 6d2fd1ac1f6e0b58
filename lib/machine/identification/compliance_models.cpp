// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/compliance_models.hpp"

#include <algorithm>
#include <cmath>

#include "machine/identification/identify_system.hpp"

namespace millpose {
namespace {

using Eigen::VectorXd;

class Models {
 public:
  Models(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options)
      : arm_(arm), cases_(cases), options_(options), pose_of_case_(identify::PosesOf(cases)) {}

  size_t poses() const { return pose_of_case_.back() + 1; }

  /// Sets the model's errors; false where some of it cannot be told.
  bool Judge(ComplianceModel& model) const {
    IdentifyOptions options = options_;
    options.beside = model.Gives();
    model.unknowns = 6 + options.beside.size();
    const identify::System system = identify::MakeSystem(arm_, cases_, options);
    const std::vector<std::string> reasons = identify::Observability(system.L);
    for (size_t k = 6; k < reasons.size(); ++k)
      if (!reasons[k].empty()) return false;
    std::vector<double> squares;
    for (size_t pose = 0; pose < poses(); ++pose) {
      const std::optional<double> square = Foretold(system, reasons, pose);
      if (!square) return false;
      squares.push_back(*square);
    }
    const auto count = static_cast<double>(squares.size());
    for (const double square : squares) model.mean_square += square / count;
    double spread = 0;
    for (const double square : squares) spread += (square - model.mean_square) * (square - model.mean_square);
    model.deviation = std::sqrt(spread / (count - 1) / count);
    return true;
  }

 private:
  /// mm², mean over the displacements of a pose of what the others do not foretell.
  std::optional<double> Foretold(const identify::System& system, const std::vector<std::string>& reasons,
                                 size_t pose) const {
    const identify::System rest = identify::Without(system, pose_of_case_, pose);
    if (rest.L.rows() <= rest.L.cols()) return std::nullopt;
    const std::vector<std::string> still = identify::Observability(rest.L);
    std::vector<char> free;
    for (size_t j = 0; j < still.size(); ++j) {
      if (j >= 6 && !still[j].empty()) return std::nullopt;
      free.push_back(reasons[j].empty() && still[j].empty());
    }
    VectorXd weights;
    const VectorXd c = identify::Solve(rest, free, options_.robust, weights).c;
    double square = 0, count = 0;
    for (Eigen::Index row = 0; row < system.x.size(); row += cases_[CaseOf(system, row)].rotation ? 6 : 3) {
      if (pose_of_case_[CaseOf(system, row)] != pose) continue;
      const VectorXd off = system.L.middleRows(row, 3) * c - system.x.segment(row, 3);
      square += off.squaredNorm() * options_.displacement_deviation * options_.displacement_deviation;
      ++count;
    }
    return square / count;
  }

  static size_t CaseOf(const identify::System& system, Eigen::Index row) {
    return system.case_of_row[static_cast<size_t>(row)];
  }

  const Arm& arm_;
  const std::vector<LoadCase>& cases_;
  const IdentifyOptions& options_;
  const std::vector<size_t> pose_of_case_;
};

}  // namespace

std::vector<Give> ComplianceModel::Gives() const {
  std::vector<Give> gives;
  for (const int link : tilting) std::ranges::copy(TiltingOf(link), std::back_inserter(gives));
  for (int axis = 0; base && axis < 3; ++axis) gives.push_back({0, axis, true});
  return gives;
}

ComplianceModels TryModels(const Arm& arm, const std::vector<LoadCase>& cases,
                           const IdentifyOptions& options) {
  ComplianceModels models;
  const Models judge(arm, cases, options);
  ComplianceModel springs;
  if (judge.poses() >= 2) judge.Judge(springs);
  models.tried.push_back(springs);
  if (judge.poses() < kLeastPosesForModels) return models;
  for (;;) {
    std::optional<ComplianceModel> best;
    for (int link = 1; link <= 6; ++link) {
      const std::vector<int>& taken = models.tried.back().tilting;
      if (std::ranges::find(taken, link) != taken.end()) continue;
      ComplianceModel next;
      next.tilting = taken;
      next.tilting.push_back(link);
      if (judge.Judge(next) && (!best || next.mean_square < best->mean_square)) best = next;
    }
    if (!best) break;
    models.tried.push_back(*best);
  }
  ComplianceModel whole;
  whole.tilting = models.tried.back().tilting;
  whole.base = true;
  if (judge.Judge(whole)) models.tried.push_back(whole);
  for (size_t i = 1; i < models.tried.size(); ++i)
    if (models.tried[i].mean_square < models.tried[models.least].mean_square) models.least = i;
  const ComplianceModel& least = models.tried[models.least];
  while (models.tried[models.chosen].mean_square > least.mean_square + least.deviation) ++models.chosen;
  return models;
}

}  // namespace millpose
