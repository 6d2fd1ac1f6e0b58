// SPDX-License-Identifier: GPL-3.0-or-later
// Import and repair of meshes.
#pragma once

#include "surface/mesh.hpp"
#include "surface/mesh_import.hpp"
