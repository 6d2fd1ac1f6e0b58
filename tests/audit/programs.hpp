// SPDX-License-Identifier: GPL-3.0-or-later
// Programs read back with a tolerance for everything that does not move the arm.
#pragma once

#include <functional>
#include <optional>

#include "tests/audit/folder.hpp"

namespace millpose::audit {

/// How a control may turn the tool on a straight motion; each of the ways must do.
struct Turning {
  bool even = true;  ///< about one axis
  /// This direction of the tool runs on a great circle, and the tool turns evenly about it.
  std::optional<Vector3> swivel = {};
  /// The angles as written run evenly, where the motion before has them too; else it turns about one axis.
  std::optional<Vector3> angles = {};
  std::function<Matrix3(const Vector3&)> of_angles = {};  ///< the tool in P
};

/// Where a motion of a program ends.
struct Target {
  std::string file;
  int line = 0;
  std::optional<Angles> angles;  ///< rad, where programmed as axes
  Matrix4 X_PT;                  ///< tool on the part; from the angles where those are given
  Turning turning = {};
  std::vector<Real> external = {};  ///< where the external axes are then, mm or rad
};

/// All targets of one controller's program in order, sub-programs followed. Throws std::runtime_error for a
/// controller that it does not know.
std::vector<Target> ReadProgram(const std::string& controller,
                                const std::map<std::string, std::string>& files, const Setup& setup);

/// How far a program and points.csv are apart, looked at both ways along every piece.
struct Deviation {
  Real position = 0;  ///< mm
  Real angle = 0;     ///< rad, of the whole tool frame
  std::string where;  ///< of the larger one, in units of its bound
  Real external = 0;  ///< mm or degrees, of any external axis
  std::string external_where;
};

/// Points that are cut in one go, and where in a program that is.
struct Cut {
  std::vector<const Row*> rows;
  bool closed = false;         ///< returns to its first point
  size_t first = 0, last = 0;  ///< targets of the program from its first to its last point
};

/// The pieces of points.csv in their order.
std::vector<Cut> CutsOf(const std::vector<Row>& rows, const Setup& setup);

/// Compares, and sets `first` and `last` of every cut.
Deviation Compare(const std::vector<Target>& targets, std::vector<Cut>& cuts, const Setup& setup);

/// What external axes do that they must not: be elsewhere than at home or at an end of a cut beside, outside
/// of cuts; move there while the arm moves; or move along a straight motion of the tool of which the
/// controller does not count them in; each with its line. `cuts` as Compare() has left them.
std::vector<std::string> ExternalViolations(const std::string& controller, const std::vector<Target>& targets,
                                            const std::vector<Cut>& cuts, const Setup& setup);

inline constexpr Real kExternalBound = 0.02L;         // mm or degrees
inline constexpr Real kPositionBound = 0.02L;         // mm
inline constexpr Real kAngleBound = 0.02L * kDegree;  // rad

}  // namespace millpose::audit
