// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/raw_mesh.hpp"

#include "surface/stl_reader.hpp"

namespace millpose {

RawMesh ReadMesh(std::string_view bytes, const std::string& name) { return ReadStl(bytes, name); }

}  // namespace millpose
