// SPDX-License-Identifier: GPL-3.0-or-later
// Mean cutting force of a cylindrical end mill by a mechanistic model, and what it moves
// (docs/process-force.md).
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "base/enum_words.hpp"

namespace millpose {

/// Kienzle's model: the tangential force on an edge of width b at chip thickness h is k_c1.1·b·h^(1−m_c).
struct CuttingMaterial {
  std::string name;
  double kc11 = 0;  ///< specific cutting force at h = 1 mm, N/mm²
  double mc = 0;    ///< exponent, 0..1
  std::string source;
};

/// The built-in table: a tool maker's values by material group. Other sources differ by up to a factor of 2
/// (docs/process-force.md).
const std::vector<CuttingMaterial>& CuttingMaterials();

enum class MillingSide : uint8_t { kUp, kDown, kSlot };  ///< conventional, climb, full width
inline constexpr EnumWords<MillingSide, 3> kMillingSideWords = {
    {{"up", MillingSide::kUp}, {"down", MillingSide::kDown}, {"slot", MillingSide::kSlot}}};

/// One cut. The cutter turns clockwise seen from the holder (M3).
struct Cut {
  CuttingMaterial material;
  double diameter = 0;  ///< of the cutter, mm
  int teeth = 0;
  double depth = 0;           ///< axial depth a_p, mm
  double width = 0;           ///< radial width a_e, mm, at most the diameter (ignored for a slot)
  double feed_per_tooth = 0;  ///< mm
  MillingSide side = MillingSide::kDown;
  double radial_ratio = 0.3;  ///< radial ÷ tangential force
  double axial_ratio =
      0;  ///< force on the tool towards the holder ÷ tangential force; negative pulls the tool out
};

/// Force on the tool: x along the feed, y = z × x, z along the tool axis to the holder; N.
struct CuttingForce {
  Eigen::Vector3d mean;  ///< over a revolution
  double peak = 0;       ///< largest length of the sum over all teeth: a load figure, not a deflection
  double engaged = 0;    ///< mean number of teeth in the material
};

/// Integrates the edges' forces over the engagement (Altintas, Manufacturing Automation, 2nd ed. 2012, ch. 2,
/// with Kienzle's law for the tangential force).
CuttingForce MeanCuttingForce(const Cut& cut);

/// d = c·F split where a reader wants it, mm.
struct PredictedDeflection {
  double normal = 0;  ///< along the surface normal: positive away from the part
  double feed = 0;    ///< along the feed
  double across = 0;  ///< along normal × feed
  double length = 0;  ///< of the whole vector
};

/// `c` in mm/N; `force` on the tool, N; all in one frame, directions as unit vectors.
PredictedDeflection PredictDeflection(const Eigen::Matrix3d& c, const Eigen::Vector3d& force,
                                      const Eigen::Vector3d& normal, const Eigen::Vector3d& feed);

/// Deflections along the normal over one face: a constant level is an offset of depth, only the variation is
/// flatness.
struct FaceDeflection {
  double level = 0;      ///< mean, mm
  double variation = 0;  ///< eq. 37 of the deflected face: max − min about its own least-squares plane, mm
  double largest_step = 0;  ///< from a point to the nearest one of any other pass, mm
};

/// One point of a face: where it is (mm), its pass, and its deflection along the normal (mm).
struct FacePoint {
  Eigen::Vector3d position;
  int pass = 0;
  double deflection = 0;
};

/// Empty when there are fewer than 3 points. The variation fits a + b·x + c·y over the face's own plane.
std::optional<FaceDeflection> OverFace(const std::vector<FacePoint>& points);

}  // namespace millpose
