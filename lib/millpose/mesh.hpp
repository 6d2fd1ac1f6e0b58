// SPDX-License-Identifier: GPL-3.0-or-later
// Import and repair of meshes.
#pragma once

#include "geometry/import/mesh_import.hpp"
#include "geometry/mesh/mesh.hpp"
