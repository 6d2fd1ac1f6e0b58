// SPDX-License-Identifier: GPL-3.0-or-later
// RunPlan(): from a job file to a folder of programs and reports.
#pragma once

#include "run/pipeline/outputs/run.hpp"
