// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>

#include "program/motion_program.hpp"

namespace millpose {

/// What a controller's program needs to know beyond the motions; from the cell's `controllers:` section.
struct PostSettings {
  Joints sign = Joints::Ones();    ///< controller angle = sign·A + offset
  Joints offset = Joints::Zero();  ///< rad
  Eigen::Matrix3d R_TC =
      Eigen::Matrix3d::Identity();  ///< controller's tool frame C in T (KUKA often X along the tool)
  double blend = 0.01;              ///< mm, $APO.CDIS or CTOL, no larger than the chord tolerance
  int max_motions = 1400;
  std::map<std::string, std::string> texts;  ///< templates: spindle_on, spindle_off, …
};

/// The files of one program by name, e.g. {"cabin_panel.src", …}.
using ProgramFiles = std::map<std::string, std::string>;

/// Writes and reads one controller's programs. One file and one registry line per controller.
class Post {
 public:
  virtual ~Post() = default;
  virtual std::string Name() const = 0;  ///< krl, sinumerik, linuxcnc: also the folder's name
  virtual ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                             const PostSettings& settings) const = 0;
  /// Reads back what Write() writes. Throws InputError with file:line:column.
  virtual MotionProgram Read(const ProgramFiles& files, const Arm& arm,
                             const PostSettings& settings) const = 0;
};

/// The post registered under `name`; InputError with the nearest name when there is none.
std::unique_ptr<Post> MakePost(const std::string& name);
std::vector<std::string> PostNames();

}  // namespace millpose
