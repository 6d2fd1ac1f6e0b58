// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "program/post.hpp"
#include "program/programmed_line.hpp"

namespace millpose {

/// The words of a tool's orientation: of its angles A, B, C (see ToolAngles), and of how they count.
struct OrientationWords {
  std::array<std::string, 3> names = {"A", "B", "C"};
  AngleOrder group = AngleOrder::kRpy;
};

/// What of a cell only SINUMERIK knows. Every default here and only here; the keys stand in
/// sinumerik_keys.cpp.
struct SinumerikOptions {
  std::array<std::string, 6> axis_names = {"RA1", "RA2", "RA3", "RA4", "RA5", "RA6"};
  std::optional<int> settable_frame;        ///< 505…599, which holds the workpiece; a cell always gives it
  std::optional<bool> ori_ipo_with_g_code;  ///< MD21104: how the tool turns
  std::optional<bool> ori_def_with_g_code;  ///< MD21102: whether ORIRPY and ORIEULER count

  std::optional<OrientationWords> orientation_words;  ///< a cell always gives it; `group` is its `rotation`
  std::optional<bool> stat_a5_positive;               ///< STAT bit 2 means A5 > 0, not A5 < 0; likewise

  int Frame() const { return settable_frame.value_or(505); }
  std::array<std::string, 3> Words() const { return orientation_words.value_or(OrientationWords{}).names; }
  /// STAT of the arm's own status, whose bit 2 means A5 < 0, and back.
  int Stat(int status) const { return stat_a5_positive.value_or(false) ? status ^ 4 : status; }
};

/// Siemens SINUMERIK 840D sl and ONE with robot transformation: NAME.mpf, docs/sinumerik.md.
class SinumerikPost : public Post {
 public:
  using Options = SinumerikOptions;
  explicit SinumerikPost(Options options = {}) : options_(std::move(options)) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "sinumerik"; }
  std::vector<std::string> Endings() const override { return {".mpf", ".spf"}; }
  /// ORIVECT and ORIWKS both ask for a great circle of Z of the tool frame; where nobody knows which of them
  /// counts (MD21104), evenly running angles and one even turn must do as well.
  std::string ToolCheck(const PostSettings& settings) const override;
  std::vector<LineModel> Lines(const PostSettings& settings) const override;
  double Blend(const PathTolerance& tolerance, double) const override { return tolerance.position; }
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  std::string WhyNotIn(const PostSettings& settings) const override;
  std::vector<std::string> Assumptions(const PostSettings& settings) const override;
  std::vector<std::pair<std::string, std::string>> BeforeFirstRun(
      const PostSettings& settings) const override;
  std::string HeldTool() const override { return "D1"; }  // its edge holds from here on, whatever ran before
  double UsualCycle() const override { return 0.004; }    // 840D sl as it is often set up (MD10071)
  CallingSyntax Calling() const override;
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;

 private:
  Options options_;
};

/// ORIRPY, ORIRPY2 or ORIEULER.
std::string SinumerikAngleWord(AngleOrder rotation);

/// SINUMERIK's texts for events where the cell gives none.
std::map<std::string, std::string> SinumerikTexts();

}  // namespace millpose
