// SPDX-License-Identifier: GPL-3.0-or-later
// Compliance at the tool tip and its indices in the milling plane.
#pragma once

#include "machine/stiffness/compliance.hpp"
#include "machine/stiffness/pose_stiffness.hpp"
