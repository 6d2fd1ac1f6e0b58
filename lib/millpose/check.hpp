// SPDX-License-Identifier: GPL-3.0-or-later
// CheckOperations(), CheckMesh(): reads everything, plans nothing.
#pragma once

#include "run/pipeline/operations/check_job.hpp"
