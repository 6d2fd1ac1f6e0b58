// SPDX-License-Identifier: GPL-3.0-or-later
// Freedoms: in what a milling point may be taken differently; Freedoms().Add() registers one with its key.
#pragma once

#include "planning/pose/freedom_entry.hpp"
