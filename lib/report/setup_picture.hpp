// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of a setup sheet: the part in its fixture, what is milled, and where the arm stands.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/triangles.hpp"
#include "report/words/words.hpp"

namespace millpose {

/// A solid of the picture, in the part's frame P, mm.
struct PictureSolid {
  Triangles mesh;
  bool part = false;  ///< the part itself; else what holds it
};

/// What one operation mills: lines of tips in P, mm, one for each piece.
struct PicturePath {
  std::vector<std::vector<Eigen::Vector3d>> cuts;
  std::vector<Eigen::Vector3d> skipped;  ///< tips that are not milled
};

struct SetupPicture {
  std::vector<PictureSolid> solids;
  std::vector<PicturePath> paths;
  std::vector<std::vector<Eigen::Vector3d>> elsewhere = {};  ///< lines of tips in P, mm: not milled as shown
  size_t part_faces = 4000;                                  ///< of the part that are drawn, at most
  Eigen::Vector3d towards = Eigen::Vector3d::UnitZ();        ///< in P: from the part towards who looks
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();             ///< in P: upwards in the workshop
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();             ///< in P, mm: the robot's base
  Language language = Language::kEnglish;                    ///< of its words
};

/// An SVG in parallel projection, mm of the part to one scale: solids shaded and sorted from far to near,
/// paths over them (each operation in its colour, its first tip numbered; grey what is milled elsewhere),
/// axes of P at its origin, an arrow towards the arm. A pure function of its argument.
std::string PictureOf(const SetupPicture& picture);

/// Colour of operation `i` in the picture, as CSS has it.
std::string PathColour(size_t i);

}  // namespace millpose
