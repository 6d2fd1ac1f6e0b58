// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"

namespace millpose {

/// KUKA KRL for KRC4 (KSS 8.x): NAME.src and NAME.dat, docs/krl.md. A program whose blends are no distances
/// yet is rounded as the settings' tolerance allows.
class KrlPost : public Post {
 public:
  std::string Name() const override { return "krl"; }
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
  std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const override;
};

/// KRL's texts for events where the cell gives none: the operator switches the spindle by hand.
std::map<std::string, std::string> KrlTexts();

}  // namespace millpose
