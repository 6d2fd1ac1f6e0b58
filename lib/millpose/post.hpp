// SPDX-License-Identifier: GPL-3.0-or-later
// Posts: how one controller's programs are written and read back; Posts().Add() registers one with its keys.
#pragma once

#include "program/post_entry.hpp"
