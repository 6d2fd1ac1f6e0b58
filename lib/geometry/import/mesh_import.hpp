// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/import/raw_mesh.hpp"
#include "geometry/import/repair.hpp"
#include "geometry/import/self_crossings.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// How a file's mesh becomes a workpiece.
struct ImportOptions {
  double unit = 1;               ///< mm per unit of the file
  double weld_tolerance = 1e-4;  ///< mm, ≥ 0: vertices nearer than this are one, flatter triangles none
  bool flip = false;  ///< turns the open pieces, whose outside nobody can tell, the other way round
};

/// A solid of a STEP model.
struct ImportedBody {
  std::string name;
  size_t pieces = 0, closed_pieces = 0;  ///< connected ones: a hollow has a shell of its own
  double area = 0;                       ///< mm²
};

/// What an import found and did; nothing is repaired without a count here.
struct ImportReport {
  size_t triangles_read = 0;
  size_t triangles = 0;  ///< after repair
  size_t vertices = 0;   ///< after repair
  size_t welded = 0;     ///< vertices that differed from the one they were joined with
  RepairCounts repairs;
  SelfCrossings crossings;
  size_t pieces = 0;  ///< connected ones, of the mesh as it came out
  size_t closed_pieces = 0;
  std::vector<ImportedBody> bodies;  ///< of a STEP model, in its order
  std::vector<int> body_of_source;   ///< by STEP face: into `bodies`; −1 in no solid
  double area = 0;                   ///< mm²
  double closed_area = 0;            ///< of closed pieces, where outside is certain, mm²
  size_t rims = 0;                   ///< closed lines of open edges; holes stay open
  double rim_length = 0;             ///< mm, all together
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  ///< bounds, mm
  std::vector<std::string> notes;                                                    ///< of the reader
  std::vector<std::string> lost_faces;  ///< of a STEP part: DescribeLost of each
};

struct ImportResult {
  Mesh mesh;
  ImportReport report;
};

/// Scales, welds and repairs (weld.hpp, repair.hpp) a mesh as read; bodies of a STEP model are not joined.
/// Throws InputError naming `name` when no triangle with area is left, when the file states another unit, or
/// when there is no open piece to flip. Give `raw` away to spare its memory.
ImportResult ImportMesh(RawMesh raw, const ImportOptions& options, const std::string& name);

/// One sentence for each thing worth telling: repairs that were made, rims, pieces, notes. Empty for a sound
/// closed mesh of one piece.
std::vector<std::string> Findings(const ImportReport& report);

/// A face of the solid model that could not be cut into triangles, with its number (from 0; told from 1),
/// area and place.
std::string DescribeLost(const Triangles& mesh, size_t number);

/// A warning when a part whose longest side is `extent` (mm) cannot be meant for an arm of `reach` (mm),
/// naming the unit that would make it fit (a factor 1000, 25.4 or 10 either way); empty when it may be.
std::optional<std::string> UnitWarning(double extent, double reach);

}  // namespace millpose
