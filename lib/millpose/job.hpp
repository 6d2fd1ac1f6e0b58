// SPDX-License-Identifier: GPL-3.0-or-later
// A job, its cell and their meshes, read once.
#pragma once

#include "job/inputs.hpp"
