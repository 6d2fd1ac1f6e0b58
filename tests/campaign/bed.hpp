// SPDX-License-Identifier: GPL-3.0-or-later
// A confirmed program of one controller, and what reading and verifying make of its mutants.
#pragma once

#include "program/post.hpp"
#include "program/verify/verify.hpp"
#include "tests/campaign/trace.hpp"

namespace millpose::campaign {

/// Whether a program is let out, and if not, why.
struct Answer {
  bool accepted = false;
  std::string why;
};

class Bed {
 public:
  /// `variant`: as SampleSettings() knows them, or krl_more, krl_split, sinumerik_split, rapid_split,
  /// rapid_load.
  explicit Bed(const std::string& variant);

  const std::string& variant() const { return variant_; }
  const std::string& controller() const { return controller_; }
  const Files& files() const { return files_; }
  const Files& other() const { return other_; }  ///< of another plan, under the same names
  const Trace& trace() const { return trace_; }
  const Machine& machine() const { return machine_; }

  Trace Run(const Files& files) const;
  Answer Ask(const Files& files) const;

 private:
  MotionProgram Read(const Files& files) const;

  std::string variant_, controller_;
  PlanResult plan_;
  PostSettings settings_;
  MotionProgram program_;
  std::unique_ptr<Post> post_;
  std::unique_ptr<World> world_;
  VerifyOptions options_;
  Machine machine_;
  Files files_, other_;
  MotionProgram written_;  // as read back
  Trace trace_;
};

/// One of each kind of program that the posts write; the two of LinuxCNC last.
const std::vector<std::unique_ptr<Bed>>& Beds();

}  // namespace millpose::campaign
