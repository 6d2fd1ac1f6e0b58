// SPDX-License-Identifier: GPL-3.0-or-later
// Posts: how one controller's programs are written and read back; Posts().Add() registers one.
#pragma once

#include "program/post.hpp"
