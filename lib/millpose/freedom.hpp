// SPDX-License-Identifier: GPL-3.0-or-later
// Freedoms: in what a milling point may be taken differently; Freedoms().Add() registers one.
#pragma once

#include "pose/freedom.hpp"
