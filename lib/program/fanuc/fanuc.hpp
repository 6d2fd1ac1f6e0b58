// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/units.hpp"
#include "program/fanuc/fanuc_options.hpp"

namespace millpose {

/// FANUC LS for R-30iB and R-30iB Plus: NAME.ls, docs/fanuc.md. Straight motions are poses in a user frame
/// with CONFIG, joint motions joint positions.
class FanucPost : public Post {
 public:
  using Options = FanucOptions;
  explicit FanucPost(Options options = {}) : options_(options) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "fanuc"; }
  std::vector<std::string> Endings() const override { return {".ls"}; }
  std::vector<LineModel> Lines(const PostSettings& settings) const override;
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  Pose BaseInWorld(const PostSettings&) const override { return FanucBase(options_); }
  /// FANUC's zero: upper arm upright, forearm level; the senses of FANUC's axes, J3 without its coupling.
  std::optional<AxisConvention> OwnZero() const override {
    return AxisConvention::OfSigns({1, 1, -1, -1, -1, -1},
                                   (Joints() << 0, kPi / 2, kPi / 2, 0, 0, 0).finished());
  }
  double UsualCycle() const override { return 0.008; }  // ITP
  TimeOptions Times() const override { return {options_.joint_speed_percent / 100.0, 0}; }
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

/// FANUC's texts for events where the cell gives none: the operator switches the spindle by hand.
std::map<std::string, std::string> FanucTexts(const PostSettings& settings);

/// Lines of at most 32 characters that hold "key: value"; those from the second on begin with ": " where a
/// blank stood before them, else with ":".
std::vector<std::string> FanucRemarks(const std::string& key, const std::string& value);
inline constexpr size_t kFanucRemark = 32;  ///< characters of a remark

/// The notice of a compensated program as the pendant shows it, in lines of 23 characters.
inline constexpr std::array<const char*, 2> kFanucNotice = {"MESSAGE[COMPENSATED: NOT TO BE]",
                                                            "MESSAGE[RUN TWICE ON ONE PART]"};

}  // namespace millpose
