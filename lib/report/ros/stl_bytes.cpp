// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/stl_bytes.hpp"

#include <bit>

#include "report/ros/ros_names.hpp"

namespace millpose {
namespace {

void AddBytes(uint32_t value, std::string& bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((value >> shift) & 0xff);
}

void AddVector(const Eigen::Vector3d& v, std::string& bytes) {
  for (const double value : v) AddBytes(std::bit_cast<uint32_t>(static_cast<float>(value + 0.0)), bytes);
}

}  // namespace

std::string StlBytes(const Triangles& mesh, const Eigen::Vector3d& centre, const std::string& head) {
  constexpr size_t kHead = 80, kFacet = 50;
  std::string bytes = " " + head.substr(0, kHead - 1);
  bytes.resize(kHead, ' ');
  bytes.reserve(kHead + 4 + kFacet * mesh.faces.size());
  AddBytes(static_cast<uint32_t>(mesh.faces.size()), bytes);
  for (const std::array<int, 3>& face : mesh.faces) {
    std::array<Eigen::Vector3d, 3> corners;
    for (size_t i = 0; i < 3; ++i)
      corners[i] = (mesh.vertices[static_cast<size_t>(face[i])] - centre) / kMetre;
    const Eigen::Vector3d across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    AddVector(across.norm() > 0 ? across.normalized() : Eigen::Vector3d::Zero().eval(), bytes);
    for (const Eigen::Vector3d& corner : corners) AddVector(corner, bytes);
    bytes.append(2, '\0');
  }
  return bytes;
}

}  // namespace millpose
