// SPDX-License-Identifier: GPL-3.0-or-later
// Strategies: where passes come from; Strategies().Add() registers one with its keys.
#pragma once

#include "toolpath/strategy_entry.hpp"
