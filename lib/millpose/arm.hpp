// SPDX-License-Identifier: GPL-3.0-or-later
// The arm: forward kinematics, Jacobian, closed-form inverse.
#pragma once

#include "machine/robot/arm.hpp"
