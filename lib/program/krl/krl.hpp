// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/krl/krl_options.hpp"
#include "program/post.hpp"

namespace millpose {

/// KUKA KRL for KRC4 (KSS 8.x): NAME.src and NAME.dat, docs/krl.md. A program whose blends are no distances
/// yet is rounded as the settings' tolerance allows.
class KrlPost : public Post {
 public:
  using Options = KrlOptions;
  explicit KrlPost(Options options = {}) : options_(std::move(options)) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "krl"; }
  std::vector<std::string> Endings() const override { return {".src"}; }
  std::vector<LineModel> Lines(const PostSettings& settings) const override;
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  bool HasOwnWorld() const override { return true; }
  double UsualCycle() const override { return 0.012; }  // KRC4
  /// KUKA's zero: upper arm and forearm level and in one line; the senses of KUKA's axes.
  std::optional<AxisConvention> OwnZero() const override {
    return AxisConvention::OfSigns({-1, 1, 1, -1, 1, -1}, Joints::Zero());
  }
  Pose BaseInWorld(const PostSettings& settings) const override { return KrlBase(options_, settings); }
  TimeOptions Times() const override {
    return {options_.ptp_speed_percent / 100.0, options_.orientation_speed};
  }
  PathDynamics Dynamics(const PostOptions& options) const override;
  size_t Memory() const override { return static_cast<size_t>(options_.memory_kbytes) * 1000; }
  std::string WhyNotIn(const PostSettings& settings) const override;
  std::vector<std::pair<std::string, std::string>> BeforeFirstRun(
      const PostSettings& settings) const override;
  std::string ToolCheck(const PostSettings& settings) const override;
  FrameTexts Frames(const PostSettings& settings) const override;
  CallingSyntax Calling() const override;
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;

 private:
  Options options_;
};

/// KRL's texts for events where the cell gives none: the operator switches the spindle by hand.
std::map<std::string, std::string> KrlTexts(const PostSettings& settings);

}  // namespace millpose
