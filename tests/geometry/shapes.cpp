// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/shapes.hpp"

#include <fmt/format.h>

#include <cstring>
#include <numbers>

#include "base/file.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {

Triangles BoxShape(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  Triangles box;
  for (int i = 0; i < 8; ++i)
    box.vertices.emplace_back((i & 1) != 0 ? upper.x() : lower.x(), (i & 2) != 0 ? upper.y() : lower.y(),
                              (i & 4) != 0 ? upper.z() : lower.z());
  box.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
               {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return box;
}

Triangles CylinderShape(double radius, double height, int count, int rows) {
  Triangles mesh;
  for (int row = 0; row <= rows; ++row)
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * k / count;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height * row / rows);
    }
  const int low = static_cast<int>(mesh.vertices.size()), high = low + 1, top = rows * count;
  mesh.vertices.emplace_back(0, 0, 0);
  mesh.vertices.emplace_back(0, 0, height);
  for (int k = 0; k < count; ++k) {
    const int next = (k + 1) % count;
    for (int row = 0; row < rows; ++row) {
      const int a = row * count + k, b = row * count + next;
      mesh.faces.push_back({a, b, b + count});
      mesh.faces.push_back({a, b + count, a + count});
    }
    mesh.faces.push_back({low, next, k});
    mesh.faces.push_back({high, top + k, top + next});
  }
  return mesh;
}

Triangles LatheShape(const std::vector<Eigen::Vector2d>& profile, int count) {
  Triangles mesh;
  std::vector<int> first;  // vertex of each profile point
  const bool closed = profile.front() == profile.back();
  for (size_t i = 0; i < profile.size(); ++i) {
    if (closed && i + 1 == profile.size()) {
      first.push_back(first.front());
      break;
    }
    first.push_back(static_cast<int>(mesh.vertices.size()));
    for (int k = 0; k < (profile[i].x() > 0 ? count : 1); ++k) {
      const double angle = 2 * std::numbers::pi * k / count;
      mesh.vertices.emplace_back(profile[i].x() * std::cos(angle), profile[i].x() * std::sin(angle),
                                 profile[i].y());
    }
  }
  for (size_t i = 0; i + 1 < profile.size(); ++i)
    for (int k = 0; k < count; ++k) {
      const auto at = [&](size_t p, int step) {
        return profile[p].x() > 0 ? first[p] + (k + step) % count : first[p];
      };
      if (profile[i].x() > 0) mesh.faces.push_back({at(i, 0), at(i, 1), at(i + 1, 1)});
      if (profile[i + 1].x() > 0) mesh.faces.push_back({at(i, 0), at(i + 1, 1), at(i + 1, 0)});
    }
  return mesh;
}

Triangles GridShape(int nx, int ny, double edge) {
  Triangles mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.vertices.emplace_back(i * edge, j * edge, 0);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = b + nx + 1, d = a + nx + 1;
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
  return mesh;
}

Triangles PlateShape(int nx, int ny, double edge,
                     const std::vector<std::array<Eigen::Vector2d, 2>>& openings) {
  Triangles plate = GridShape(nx, ny, edge);
  std::erase_if(plate.faces, [&](const std::array<int, 3>& face) {
    return std::ranges::any_of(openings, [&](const auto& opening) {
      return std::ranges::all_of(face, [&](int v) {
        const Eigen::Vector2d p = plate.vertices[v].head<2>();
        return ((p - opening[0]).array() > -edge / 2).all() && ((opening[1] - p).array() > -edge / 2).all();
      });
    });
  });
  return plate;
}

Triangles SphereShape(double radius, int rows) {
  Triangles mesh;
  const int columns = 2 * rows;
  mesh.vertices.emplace_back(0, 0, radius);
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double polar = std::numbers::pi * i / rows, around = 2 * std::numbers::pi * j / columns;
      mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(around),
                                 radius * std::sin(polar) * std::sin(around), radius * std::cos(polar));
    }
  const int last = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0, 0, -radius);
  const auto at = [&](int i, int j) { return 1 + (i - 1) * columns + j % columns; };
  for (int j = 0; j < columns; ++j) {
    mesh.faces.push_back({0, at(1, j), at(1, j + 1)});
    mesh.faces.push_back({last, at(rows - 1, j + 1), at(rows - 1, j)});
    for (int i = 1; i + 1 < rows; ++i) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

Triangles MoebiusShape() {
  Triangles mesh;
  const int count = 12;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d across = std::cos(angle / 2) * out + std::sin(angle / 2) * Eigen::Vector3d::UnitZ();
    mesh.vertices.push_back(10 * out - 2 * across);
    mesh.vertices.push_back(10 * out + 2 * across);
  }
  for (int k = 0; k < count; ++k) {
    const int a = 2 * k, b = a + 1, c = k + 1 < count ? a + 2 : 1, d = k + 1 < count ? a + 3 : 0;
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({c, b, d});
  }
  return mesh;
}

void Append(Triangles& mesh, const Triangles& other) {
  const int offset = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.faces) mesh.faces.push_back({a + offset, b + offset, c + offset});
}

void Flip(Triangles& mesh, size_t face) { std::swap(mesh.faces[face][1], mesh.faces[face][2]); }

Triangles Soup(const Triangles& mesh) {
  Triangles soup;
  for (const auto& face : mesh.faces) {
    const int first = static_cast<int>(soup.vertices.size());
    for (const int v : face) soup.vertices.push_back(mesh.vertices[v]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  return soup;
}

Triangles Moved(Triangles mesh, const Eigen::Isometry3d& X) {
  for (Eigen::Vector3d& p : mesh.vertices) p = X * p;
  return mesh;
}

Mesh SoundMesh(const Triangles& triangles) { return Mesh(triangles); }

Mesh SampleMesh(const std::string& name) {
  const std::string path = fmt::format("{}/toolpaths/{}/{}.stl", SourceDir(), name, name);
  return ImportMesh(ReadMesh(ReadFile(path), path), {}, path).mesh;
}

std::string BinaryStl(const Triangles& mesh, std::string header) {
  header.resize(80, ' ');
  const auto count = static_cast<uint32_t>(mesh.faces.size());
  std::string bytes = header;
  const auto append = [&](const void* data, size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  append(&count, 4);
  for (const auto& face : mesh.faces) {
    const std::array<float, 3> normal{};
    append(normal.data(), 12);
    for (const int v : face) {
      const Eigen::Vector3f p = mesh.vertices[v].cast<float>();
      append(p.data(), 12);
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string TextStl(const Triangles& mesh) {
  std::string text = "solid test\n";
  for (const auto& face : mesh.faces) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const int v : face) {
      const Eigen::Vector3d& p = mesh.vertices[v];
      text += fmt::format("      vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid test\n";
}

}  // namespace millpose
