// SPDX-License-Identifier: GPL-3.0-or-later
// A sample's program for one variant of a controller, with everything to replay it.
#pragma once

#include "machine/collision/world.hpp"
#include "program/post_entry.hpp"
#include "program/verify/verify.hpp"
#include "run/pipeline/programs/program_motions.hpp"
#include "tests/samples/frozen_plan.hpp"

namespace millpose {

/// krl, sinumerik, linuxcnc, linuxcnc_cartesian.
std::vector<std::string> Variants();

struct ProgramCase {
  std::string controller;
  PostPointer post;
  PostSettings settings;
  VerifyOptions options;
  ProgramMotions motions;
  ProgramFiles files;
  std::string name;  ///< of the file that holds the motions

  /// The program with the text of `name` replaced.
  MotionProgram Read(const Arm& arm, const std::string& text) const;
};

/// As `plan` makes it of the sample; `set` changes the cell's settings for the variant.
ProgramCase MakeCase(const Sample& sample, const std::string& variant);

/// "file:line: message" of each.
std::string Text(const std::vector<Finding>& findings);

}  // namespace millpose
