// SPDX-License-Identifier: GPL-3.0-or-later
// The sample's program of a controller with lines put in or changed, read again.
#pragma once

#include <string>

#include "tests/program/sample_plan.hpp"

namespace millpose {

class TextPlaces {
 public:
  /// `variant`: see SampleSettings().
  explicit TextPlaces(const std::string& variant);

  const std::string& text() const { return text_; }
  /// The text with `line` before the nth (from 0) place where `at` ("\nG1 X") begins.
  std::string Inserted(const std::string& line, const std::string& at, int nth) const;
  /// The first `from` replaced.
  std::string Changed(const std::string& from, const std::string& to) const;
  /// The number behind the first `at` with `end` appended.
  std::string Behind(const std::string& at, const std::string& end) const;
  MotionProgram Read(const std::string& text) const;
  /// What the reader has against the text, "line: message" each; empty when it reads it.
  std::string Problems(const std::string& text) const;
  /// The first problem names the first line in which `text` differs from the sample, and holds `hint`.
  void ExpectRefused(const std::string& text, const std::string& what, const std::string& hint) const;

 private:
  std::unique_ptr<Post> post_;
  std::string file_, text_;
  PlanResult plan_;
  PostSettings settings_;
};

}  // namespace millpose
