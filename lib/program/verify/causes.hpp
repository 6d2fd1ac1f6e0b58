// SPDX-License-Identifier: GPL-3.0-or-later
// Findings told by their cause: what is wrong, how often, where first, which key cures it.
#pragma once

#include "program/verify/verify.hpp"

namespace millpose {

/// All findings of one cause.
struct CauseGroup {
  Cause cause = Cause::kOther;
  size_t count = 0;
  Finding first;  ///< in the order of the findings
};

/// The findings by cause, the cause of the most findings first.
std::vector<CauseGroup> GroupByCause(const std::vector<Finding>& findings);

/// "12 corners are rounded by too much, or passed too fast".
std::string Describe(const CauseGroup& group);

/// The keys that help; `controller` as in `controllers.<controller>`.
std::string Cure(Cause cause, const std::string& controller);

}  // namespace millpose
