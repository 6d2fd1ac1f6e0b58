// SPDX-License-Identifier: GPL-3.0-or-later
// PlanJob(): a job's plan as a value.
#pragma once

#include "run/pipeline/stages/plan_job.hpp"
