// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <TopoDS_Face.hxx>
#include <array>
#include <vector>

namespace millpose {

/// Area of a face's triangles, mm²; 0 without any.
double TriangleArea(const TopoDS_Face& face);

/// How a face is cut that could not be cut with the others.
struct RecutLength {
  bool other_algorithm;  ///< Delabella's triangulation in place of Watson's
  bool coarse;           ///< an interior as coarse as it comes; it is refined later
  bool repaired;         ///< what ShapeFix makes of the face
};
inline constexpr std::array<RecutLength, 6> kRecutWays{{{true, false, false},
                                                        {false, true, false},
                                                        {true, true, false},
                                                        {false, false, true},
                                                        {true, false, true},
                                                        {true, true, true}}};

/// A face of `area` (mm²) cut in one of these ways: itself, or what ShapeFix made of it. Empty when that
/// gives triangles for less than half of the area. `angle`: rad between neighbouring facets.
std::vector<TopoDS_Face> Recut(const TopoDS_Face& face, double area, double chord_tolerance, double angle,
                               const RecutLength& way);

}  // namespace millpose
