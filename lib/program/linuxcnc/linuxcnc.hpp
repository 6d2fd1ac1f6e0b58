// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"

namespace millpose {

/// What of a cell only LinuxCNC knows; the keys stand in linuxcnc_keys.cpp.
struct LinuxCncOptions {
  bool cartesian = false;        ///< cuts as tool poses, not joints
  std::optional<bool> m6_moves;  ///< the machine moves by itself at M6, see docs/linuxcnc.md
};

/// LinuxCNC (RS-274/NGC): NAME.ngc, docs/linuxcnc.md. In joint space X, Y, Z, A, B, C are the joints 1..6 in
/// degrees; straight lines of the tip become joint motions in inverse time, short enough that the tip leaves
/// the line by at most kHalfwayDeviation. Cartesian, cuts are poses of the tool in the robot's base with A,
/// B, C running evenly, short enough that the orientation stays within kHalfwayAngle of an even turn; motions
/// between cuts remain joint positions, between two switches of the kinematics. A control built on LinuxCNC
/// is one of these with another Name() and Endings().
class LinuxCncPost : public Post {
 public:
  using Options = LinuxCncOptions;
  explicit LinuxCncPost(Options options = {}) : options_(options) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "linuxcnc"; }
  std::vector<std::string> Endings() const override { return {".ngc"}; }
  std::string ToolCheck(const PostSettings& settings) const override;
  double AngleReserve() const override;
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  std::string WhyNotIn(const PostSettings& settings) const override;
  std::vector<std::string> Assumptions(const PostSettings& settings) const override;
  std::vector<std::pair<std::string, std::string>> BeforeFirstRun(
      const PostSettings& settings) const override;
  bool NeedsSphericalWrist() const override { return false; }
  bool ReadsFromDisk() const override { return true; }
  double UsualCycle() const override { return 0.001; }  // the servo period
  bool MovesAllTogether() const override { return !options_.cartesian; }
  CallingSyntax Calling() const override;
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;

 private:
  Options options_;
};

inline constexpr double kHalfwayDeviation = 0.005;  ///< mm
inline constexpr double kHalfwayAngle = 8.7266e-5;  ///< rad (0.005°)
/// Share of the line by which the tip may be ahead half-way; the feed is off by twice that.
inline constexpr double kHalfwayLead = 0.008;
inline constexpr double kHalfwayTurn = 1.7453e-4;  ///< rad (0.01°), that the tool turns within that deviation
/// rad (0.001°): what the rounding of numbers and the places between the points may add to both.
inline constexpr double kAngleMargin = 1.7453e-5;

/// LinuxCNC's texts for events where the cell gives none.
std::map<std::string, std::string> LinuxCncTexts(const PostSettings& settings);

/// Selects a coordinate system without offsets, whatever the machine's others hold: "G10 L2 P9 X0 Y0 Z0 A0 B0
/// C0 R0", with the letters of external axes.
std::string NoOffsets(const PostSettings& settings);

/// The interpreter turns G93's F into a speed of at least this many degrees (or mm) per minute.
inline constexpr double kInverseTimeFloor = 0.1;

/// G64's tolerance counts in the units of X, Y, Z, here degrees: the tip's tolerance (mm) over the arm's
/// reach.
double BlendDegrees(double blend, const Arm& arm, const Pose& X_FT);

/// U, V, W (mm or degrees) of the external axes at `external`, in the order of the settings; 0 for others.
Eigen::Vector3d ExternalWords(const PostSettings& settings, const ExternalPosition& external);

/// Length that F counts along between two positions (degrees, or mm and degrees of tool poses), `external`
/// (mm or degrees) being what U, V, W move by: that of X, Y, Z; where they stand still, that of U, V, W;
/// where these do too, that of A, B, C.
double FeedLength(const Joints& from, const Joints& to, const Eigen::Vector3d& external);

}  // namespace millpose
