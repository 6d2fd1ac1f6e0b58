// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"
#include "program/programmed_line.hpp"

namespace millpose {

/// Siemens SINUMERIK 840D sl and ONE with robot transformation: NAME.mpf, docs/sinumerik.md.
class SinumerikPost : public Post {
 public:
  std::string Name() const override { return "sinumerik"; }
  std::vector<std::string> Endings() const override { return {".mpf", ".spf"}; }
  std::vector<std::string> Keys() const override;
  std::vector<NeededKey> NeededKeys() const override;
  std::vector<LineModel> Lines(const PostSettings& settings) const override;
  double Blend(const PathTolerance& tolerance, double) const override { return tolerance.position; }
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  double UsualCycle() const override { return 0.004; }  // 840D sl as it is often set up (MD10071)
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;
};

/// The ways in which SINUMERIK may make a straight motion. ORIVECT and ORIWKS both ask for a great circle of
/// Z of the tool frame; where nobody knows which of them counts (MD21104), evenly running angles and one even
/// turn must do as well.
std::vector<LineModel> SinumerikLines(const PostSettings& settings);

/// SINUMERIK's texts for events where the cell gives none.
std::map<std::string, std::string> SinumerikTexts();

}  // namespace millpose
