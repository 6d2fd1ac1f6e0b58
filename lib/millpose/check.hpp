// SPDX-License-Identifier: GPL-3.0-or-later
// CheckJob(), CheckMesh(): reads everything, plans nothing.
#pragma once

#include "pipeline/check.hpp"
