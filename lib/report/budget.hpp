// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of the error of the face along its normal, source by source, and what is not
// (docs/budget.md): no report may let a reader take one source for all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/deflection.hpp"
#include "report/geometry.hpp"
#include "report/lost_motion.hpp"
#include "report/registration.hpp"

namespace millpose {

/// One source of error.
struct BudgetRow {
  std::string key;                ///< static_compliance | force_uncertainty | lost_motion | gear_error | …
  std::string name;               ///< "lost motion"
  std::optional<double> largest;  ///< along the normal on this plan, mm; empty: nothing states it
  std::string
      basis;  ///< what the figure is of; of one that is not stated the published magnitude, with source
};

struct Budget {
  std::vector<BudgetRow> rows;

  /// Of the stated ones, as if all were largest at one point, mm.
  double Sum() const;
  /// The stated ones, the largest first; equal ones as they stand.
  std::vector<const BudgetRow*> Largest() const;
  /// Names of those that are not stated.
  std::vector<std::string> LeftOut() const;
};

/// `deflection`: null where the job does not say what is cut; `registration`: where nothing registered the
/// part's place; `geometry`: where nobody measured the arm's own.
Budget MakeBudget(const DeflectionReport* deflection, const LostMotionReport& lost,
                  const RegistrationFigures* registration = nullptr,
                  const GeometryFigures* geometry = nullptr);

/// One line for the terminal, without a line end: the largest three, their sum and what that leaves out.
std::string BudgetText(const Budget& budget);
/// The same in fewer words.
std::string BudgetBrief(const Budget& budget);

}  // namespace millpose
