// SPDX-License-Identifier: GPL-3.0-or-later
// Objectives: what is minimised at each point; Objectives().Add() registers one.
#pragma once

#include "planning/pose/objective.hpp"
