// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"
#include "program/rapid/rapid_options.hpp"

namespace millpose {

/// ABB RAPID for IRC5 and OmniCore: NAME.mod, docs/rapid.md. A program whose blends are no distances yet is
/// rounded as the settings' tolerance allows.
class RapidPost : public Post {
 public:
  using Options = RapidOptions;
  explicit RapidPost(Options options = {}) : options_(std::move(options)) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "rapid"; }
  std::vector<std::string> Endings() const override { return {".mod"}; }
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  double UsualCycle() const override { return 0.004; }  // of path interpolation; docs/rapid.md
  /// ABB's zero: upper arm upright, forearm level; senses as the inner angles.
  std::optional<AxisConvention> OwnZero() const override;
  Pose BaseInWorld(const PostSettings& settings) const override;
  size_t BytesPerMotion() const override { return 220; }
  /// Joint targets say which way every axis goes; turn bits there are none.
  bool EntersByJoints() const override { return true; }
  TimeOptions Times() const override;
  size_t Memory() const override { return options_.Memory(); }
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

/// RAPID's texts for events where the cell gives none: the operator switches the spindle by hand.
std::map<std::string, std::string> RapidTexts(const PostSettings& settings);

/// What a program states before its first motion and behind every call of the plant, one statement each,
/// without ';'.
std::vector<std::string> RapidSettings(const RapidOptions& options);

/// Names of external axes by their place in a robtarget.
const std::vector<std::string>& RapidAxisNames();

/// What stands for an axis that there is none of.
inline constexpr char kNoRapidAxis[] = "9E9";

/// The work object for the base frame X_BP in the robot's base as it stands with the external axes at
/// `external`, and that frame of a work object.
Pose RapidObjectFrame(const RapidOptions& options, const PostSettings& settings,
                      const ExternalPosition& external, const Pose& X_BP);
Pose RapidBaseFrame(const RapidOptions& options, const PostSettings& settings,
                    const ExternalPosition& external, const Pose& object);

}  // namespace millpose
