// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

namespace millpose {
namespace {

template <typename T>
void Put(std::string& bytes, T value, bool big) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (big == (std::endian::native == std::endian::little)) std::ranges::reverse(raw);
  bytes += raw;
}

// Triangles of a fan from each first corner.
std::vector<std::array<int, 3>> Fans(const PolygonMesh& mesh) {
  std::vector<std::array<int, 3>> triangles;
  for (const auto& face : mesh.faces)
    for (size_t k = 2; k < face.size(); ++k) triangles.push_back({face[0], face[k - 1], face[k]});
  return triangles;
}

std::string Stl(const PolygonMesh& mesh) {
  const auto triangles = Fans(mesh);
  std::string bytes(80, ' ');
  Put(bytes, static_cast<uint32_t>(triangles.size()), false);
  for (const auto& face : triangles) {
    bytes.append(12, '\0');
    for (const int v : face)
      for (int k = 0; k < 3; ++k) Put(bytes, static_cast<float>(mesh.vertices[v][k]), false);
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string StlText(const PolygonMesh& mesh) {
  std::string text = "solid part\n";
  for (const auto& face : Fans(mesh)) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int v : face)
      text +=
          fmt::format("vertex {} {} {}\n", mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z());
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

std::string Numbers(const PolygonMesh& mesh, const char* before) {
  std::string text;
  for (const auto& p : mesh.vertices) text += fmt::format("{}{} {} {}\n", before, p.x(), p.y(), p.z());
  return text;
}

std::string Obj(const PolygonMesh& mesh) {
  std::string text = Numbers(mesh, "v ");
  for (const auto& face : mesh.faces) {
    text += "f";
    for (const int v : face) text += fmt::format(" {}", v + 1);
    text += "\n";
  }
  return text;
}

std::string FaceLines(const PolygonMesh& mesh) {
  std::string text;
  for (const auto& face : mesh.faces) text += fmt::format("{} {}\n", face.size(), fmt::join(face, " "));
  return text;
}

std::string Ply(const PolygonMesh& mesh, const std::string& format) {
  std::string bytes = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      format, mesh.vertices.size(), mesh.faces.size());
  if (format == "ascii") return bytes + Numbers(mesh, "") + FaceLines(mesh);
  const bool big = format == "binary_big_endian";
  for (const auto& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) Put(bytes, p[k], big);
  for (const auto& face : mesh.faces) {
    Put(bytes, static_cast<uint8_t>(face.size()), big);
    for (const int v : face) Put(bytes, static_cast<int32_t>(v), big);
  }
  return bytes;
}

}  // namespace

PolygonMesh Polygons(const Triangles& triangles) {
  PolygonMesh mesh{triangles.vertices, {}};
  for (const auto& [a, b, c] : triangles.faces) mesh.faces.push_back({a, b, c});
  return mesh;
}

std::map<std::string, std::string> InAllFormats(const PolygonMesh& mesh) {
  return {{"stl", Stl(mesh)},
          {"stl text", StlText(mesh)},
          {"obj", Obj(mesh)},
          {"off", fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.faces.size()) + Numbers(mesh, "") +
                      FaceLines(mesh)},
          {"ply", Ply(mesh, "ascii")},
          {"ply little", Ply(mesh, "binary_little_endian")},
          {"ply big", Ply(mesh, "binary_big_endian")}};
}

}  // namespace millpose
