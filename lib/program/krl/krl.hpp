// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"

namespace millpose {

/// KUKA KRL for KRC4 (KSS 8.x): NAME.src and NAME.dat, docs/krl.md. A program whose blends are no distances
/// yet is rounded as the settings' tolerance allows.
class KrlPost : public Post {
 public:
  std::string Name() const override { return "krl"; }
  std::vector<std::string> Endings() const override { return {".src"}; }
  std::vector<std::string> Keys() const override;
  std::vector<LineModel> Lines(const PostSettings& settings) const override;
  void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const override;
  bool HasOwnWorld() const override { return true; }
  double UsualCycle() const override { return 0.012; }  // KRC4
  TimeOptions Times(const PostSettings& settings) const override {
    return {settings.ptp_share, settings.orientation_speed};
  }
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;
};

/// KRL's texts for events where the cell gives none: the operator switches the spindle by hand.
std::map<std::string, std::string> KrlTexts();

}  // namespace millpose
