// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"

namespace millpose {

/// What of a cell only URScript knows; the keys stand in urscript_keys.cpp.
struct UrScriptOptions {
  bool movel = false;              ///< cuts by movel, not movep
  int movej_speed_percent = 30;    ///< of the slowest joint's largest speed, between cuts
  double path_acceleration = 500;  ///< mm/s², `a` of the cuts where the cell gives none
};

/// Universal Robots (CB3, e-Series): NAME.script with one function, docs/urscript.md. Ways are joint
/// positions (movej) that stop at each; cuts are poses of the tool in the robot's base (movep, or movel) with
/// a blend radius at every corner, which never meet. The maker does not document the path of a blend.
class UrScriptPost : public Post {
 public:
  using Options = UrScriptOptions;
  explicit UrScriptPost(Options options = {}) : options_(options) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "urscript"; }
  std::vector<std::string> Endings() const override { return {".script"}; }
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  /// The pendant's zero: upper arm and forearm level, stretched out against X of the base.
  std::optional<AxisConvention> OwnZero() const override;
  bool NeedsSphericalWrist() const override { return false; }
  bool HasExternalAxes() const override { return false; }
  bool ReadsFromDisk() const override { return true; }  // one file, however long
  double UsualCycle() const override { return 0.002; }  // e-Series; CB3 0.008
  TimeOptions Times() const override { return {options_.movej_speed_percent / 100.0, 0}; }
  PathDynamics Dynamics(const PostOptions& options) const override;
  std::string WhyNotIn(const PostSettings& settings) const override;
  std::vector<std::string> Assumptions(const PostSettings& settings) const override;
  std::vector<std::pair<std::string, std::string>> BeforeFirstRun(
      const PostSettings& settings) const override;
  FrameTexts Frames(const PostSettings& settings) const override;
  CallingSyntax Calling() const override;
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;

 private:
  Options options_;
};

/// URScript's texts for events where the cell gives none: the operator switches the spindle by hand.
std::map<std::string, std::string> UrScriptTexts(const PostSettings& settings);

/// What a corner is taken to stay within: MotionProgram::corner_assumption.
inline constexpr const char* kUrScriptCorner =
    "a blend begins and ends at its radius and stays in the triangle that it cuts off, tip and turn together";

/// "set_payload(4.2, [0, 0, 0.05])": as the cell's tool.load has it. Precondition: it has one.
std::string UrScriptPayload(const PostSettings& settings);

/// Largest `a` (rad/s²) and `v` (rad/s) of movej: whichever joint leads, none is faster than its own.
double UrScriptMovejAcceleration(const Arm& arm);
double UrScriptMovejSpeed(const Arm& arm, const UrScriptOptions& options);

/// mm/s²: `a` of cuts.
double UrScriptAcceleration(const PostOptions& settings, const UrScriptOptions& options);

inline constexpr int kUrScriptOutputs = 8;  ///< standard digital outputs 0 to 7

}  // namespace millpose
