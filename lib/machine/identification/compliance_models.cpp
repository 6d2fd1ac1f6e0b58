// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/compliance_models.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "machine/identification/leave_one_out.hpp"
#include "machine/identification/simplest_model.hpp"

namespace millpose {
namespace {

/// What a step adds to a model.
struct Offer {
  ComplianceStep step;
  std::vector<Give> gives;
};

class Models {
 public:
  Models(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options)
      : options_(options), pose_of_case_(identify::PosesOf(cases)) {
    for (int link = 1; link <= 6; ++link)
      offers_.push_back({{ComplianceStep::Kind::kTilting, link}, TiltingOf(link)});
    Offer base{{ComplianceStep::Kind::kBase}, {}}, lost{{ComplianceStep::Kind::kLostMotion}, {}};
    for (int axis = 0; axis < 3; ++axis) base.gives.push_back({0, axis, Give::Kind::kMoves});
    for (int joint = 1; joint <= 6; ++joint) lost.gives.push_back(TakingUpOf(joint));
    IdentifyOptions all = options;
    all.beside = lost.gives;
    const std::vector<std::string> reasons = identify::Observability(identify::MakeSystem(arm, cases, all).L);
    // Where no joint has a gap that is told, the step stands as a whole, to be refused by name.
    if (std::any_of(reasons.begin() + 6, reasons.end(), [](const std::string& r) { return r.empty(); }))
      std::erase_if(lost.gives,
                    [&](const Give& give) { return !reasons[5 + static_cast<size_t>(give.link)].empty(); });
    offers_.push_back(base);
    offers_.push_back(lost);
    offers_.push_back({{ComplianceStep::Kind::kPayload}, {}});
    all.beside.clear();
    for (const Offer& offer : offers_) std::ranges::copy(offer.gives, std::back_inserter(all.beside));
    all_ = all.beside;
    stated_ = identify::MakeSystem(arm, cases, all);
    weight_ = identify::MakeWeightSystem(arm, cases, all);
  }

  size_t poses() const { return pose_of_case_.back() + 1; }
  const std::vector<Offer>& offers() const { return offers_; }

  /// Sets the model's errors; says why where some of it cannot be told.
  std::optional<UntoldStep> Judge(ComplianceModel& model) const {
    std::vector<Eigen::Index> columns(6);
    std::iota(columns.begin(), columns.end(), 0);
    for (const Give& give : model.gives)
      columns.push_back(6 + (std::ranges::find(all_, give) - all_.begin()));
    const identify::System stated = identify::Columns(stated_, columns);
    const identify::System weight = identify::Columns(weight_, columns);
    model.unknowns = columns.size() + (model.payload() ? 1 : 0);
    const ComplianceStep step = model.steps.empty() ? ComplianceStep{} : model.steps.back();
    const UntoldStep few{step, std::nullopt, "not determined: too few measured numbers"};
    if (static_cast<size_t>(stated.x.size()) <= model.unknowns) return few;
    const identify::Fitted fit =
        identify::FitSystem(stated, model.payload() ? &weight : nullptr, options_.robust);
    for (size_t k = 6; k < fit.reasons.size(); ++k)
      if (!fit.reasons[k].empty())
        return UntoldStep{step, k < columns.size() ? std::optional(model.gives[k - 6]) : std::nullopt,
                          fit.reasons[k]};
    if (fit.freedom() < 1) return few;
    return Foretell(fit, model) ? std::nullopt
                                : std::optional(UntoldStep{
                                      step, std::nullopt, "not determined: one pose alone tells part of it"});
  }

 private:
  bool Foretell(const identify::Fitted& fit, ComplianceModel& model) const {
    const identify::LeaveOneOut others(fit, pose_of_case_);
    const double unit = options_.displacement_deviation * options_.displacement_deviation;
    std::vector<double> squares;
    for (size_t pose = 0; pose < poses(); ++pose) {
      const std::optional<double> square = others.Foretold(pose, 6);
      if (!square) return false;
      squares.push_back(unit * *square);
    }
    const auto count = static_cast<double>(squares.size());
    for (const double square : squares) model.mean_square += square / count;
    double spread = 0;
    for (const double square : squares) spread += (square - model.mean_square) * (square - model.mean_square);
    model.deviation = std::sqrt(spread / (count - 1) / count);
    return model.judged = true;
  }

  const IdentifyOptions& options_;
  const std::vector<size_t> pose_of_case_;
  std::vector<Offer> offers_;
  std::vector<Give> all_;  ///< of the columns after the sixth
  identify::System stated_, weight_;
};

/// The model with that step more which leaves the least error; steps that cannot be told go to `untold`.
std::optional<ComplianceModel> Next(const Models& judge, const ComplianceModel& last,
                                    std::vector<UntoldStep>& untold) {
  std::optional<ComplianceModel> best;
  untold.clear();
  for (const Offer& offer : judge.offers()) {
    if (std::ranges::find(last.steps, offer.step) != last.steps.end()) continue;
    ComplianceModel next{last.steps, last.gives};
    next.steps.push_back(offer.step);
    std::ranges::copy(offer.gives, std::back_inserter(next.gives));
    if (const std::optional<UntoldStep> why = judge.Judge(next))
      untold.push_back(*why);
    else if (!best || next.mean_square < best->mean_square)
      best = next;
  }
  return best;
}

}  // namespace

bool ComplianceModel::payload() const {
  return std::ranges::find(steps, ComplianceStep::Kind::kPayload, &ComplianceStep::kind) != steps.end();
}

ComplianceModels TryModels(const Arm& arm, const std::vector<LoadCase>& cases,
                           const IdentifyOptions& options) {
  ComplianceModels models;
  const Models judge(arm, cases, options);
  ComplianceModel springs;
  if (judge.poses() >= 2) judge.Judge(springs);
  models.tried.push_back(springs);
  if (judge.poses() < kLeastPosesForModels || !springs.judged) return models;
  while (const std::optional<ComplianceModel> next = Next(judge, models.tried.back(), models.untold))
    models.tried.push_back(*next);
  ChooseSimplest(models);
  return models;
}

}  // namespace millpose
