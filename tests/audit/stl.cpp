// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <sstream>

#include "tests/audit/folder.hpp"

namespace millpose::audit {
namespace {

Real Number(const std::string& text) { return std::stold(text); }

Mesh ReadAsciiStl(const std::string& bytes, Real unit) {
  std::istringstream words(bytes);
  std::string word;
  std::vector<Vector3> corners;
  while (words >> word) {
    if (word != "vertex" && word != "VERTEX") continue;
    std::string x, y, z;
    words >> x >> y >> z;
    corners.push_back({Number(x) * unit, Number(y) * unit, Number(z) * unit});
  }
  Mesh mesh;
  for (size_t i = 0; i + 2 < corners.size(); i += 3)
    mesh.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return mesh;
}

}  // namespace

Mesh ReadStl(const std::string& bytes, Real unit) {
  uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() != 84 + size_t{50} * count) return ReadAsciiStl(bytes, unit);
  Mesh mesh(count);
  for (size_t i = 0; i < count; ++i)
    for (size_t corner = 0; corner < 3; ++corner) {
      float xyz[3];
      std::memcpy(xyz, bytes.data() + 84 + 50 * i + 12 * (corner + 1), 12);
      mesh[i][corner] = Vector3(xyz[0], xyz[1], xyz[2]) * unit;
    }
  return mesh;
}

}  // namespace millpose::audit
