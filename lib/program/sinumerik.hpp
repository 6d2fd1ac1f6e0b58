// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"

namespace millpose {

/// Siemens SINUMERIK 840D sl and ONE with robot transformation: NAME.mpf, docs/sinumerik.md.
class SinumerikPost : public Post {
 public:
  std::string Name() const override { return "sinumerik"; }
  ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                     const PostSettings& settings) const override;
  MotionProgram Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const override;
};

/// SINUMERIK's texts for events where the cell gives none.
std::map<std::string, std::string> SinumerikTexts();

/// Angles A, B, C (rad) of R as the machine counts: rpy R = Rz(C)·Ry(B)·Rx(A), euler R = Rz(A)·Rx(B)·Rz(C).
Eigen::Vector3d SinumerikAngles(const std::string& rotation, const Eigen::Matrix3d& R);
Eigen::Matrix3d FromSinumerikAngles(const std::string& rotation, const Eigen::Vector3d& abc);

}  // namespace millpose
