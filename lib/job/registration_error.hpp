// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/inputs.hpp"
#include "planning/result/plan_result.hpp"
#include "report/registration.hpp"

namespace millpose {

/// What the uncertainty of the part's registered place (`workpiece.registered`) does to the cut points of
/// passes from `finished_from` on; none where the part was not registered or nothing is cut.
std::optional<RegistrationFigures> ErrorOfRegistration(const JobSettings& job, const PlanResult& plan,
                                                       int finished_from);

/// The finding that a face is not known to the job's tolerance, or the warning that its part was not
/// registered; empty where there is none.
std::string RegistrationFinding(const RegistrationFigures& figures);
std::string RegistrationWarning(const JobSettings& job);

}  // namespace millpose
