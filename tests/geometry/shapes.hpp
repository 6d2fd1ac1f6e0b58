// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes made for tests: exact shapes, and ways to spoil them.
#pragma once

#include <string>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// A box between two corners, 12 triangles, outside out.
Triangles BoxShape(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);
/// A closed cylinder about z from z = 0 to `height`, `count` sides with their corners on the radius; its
/// lateral surface in `rows` rows of quads.
Triangles CylinderShape(double radius, double height, int count, int rows = 1);
/// A profile of (radius, z) turned about z in `count` steps; outside lies on the right of its way. Closed
/// where it ends in its first point; points with radius 0 become one vertex.
Triangles LatheShape(const std::vector<Eigen::Vector2d>& profile, int count);
/// A flat grid of nx × ny squares of `edge` mm with its corner at the origin, facing +z; open.
Triangles GridShape(int nx, int ny, double edge);
/// A grid of nx × ny squares of `edge` mm without the squares that lie within one of the openings (lower and
/// upper corner in x and y; on lines of the grid).
Triangles PlateShape(int nx, int ny, double edge,
                     const std::vector<std::array<Eigen::Vector2d, 2>>& openings);
/// A sphere of `rows` × 2·`rows` patches about the origin.
Triangles SphereShape(double radius, int rows);

/// A band of 12 quads about z that joins itself twisted: it has one side.
Triangles MoebiusShape();

/// Appends another mesh's triangles.
void Append(Triangles& mesh, const Triangles& other);
/// Turns a face round.
void Flip(Triangles& mesh, size_t face);
/// Each face with vertices of its own, as STL has them.
Triangles Soup(const Triangles& mesh);
/// Moves all vertices.
Triangles Moved(Triangles mesh, const Eigen::Isometry3d& X);

/// A mesh from triangles that need no repair.
Mesh SoundMesh(const Triangles& triangles);

/// The mesh of a sample job of toolpaths/.
Mesh SampleMesh(const std::string& name);

/// Bytes of a binary STL with the given header text.
std::string BinaryStl(const Triangles& mesh, std::string header = "");
/// An ASCII STL in lower case with LF.
std::string TextStl(const Triangles& mesh);

}  // namespace millpose
