// SPDX-License-Identifier: GPL-3.0-or-later
// PlanJob(): a job's plan as a value.
#pragma once

#include "pipeline/plan_job.hpp"
