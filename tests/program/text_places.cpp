// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/text_places.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace millpose {

TextPlaces::TextPlaces(const std::string& variant)
    : post_(SamplePost(variant)), plan_(SamplePlan()), settings_(SampleSettings(variant)) {
  const MotionProgram program = MakeMotionProgram(plan_);
  const ProgramFiles files = post_->Write(program, plan_.arm, settings_);
  file_ = files.rbegin()->first;  // .src comes after .dat
  text_ = files.rbegin()->second;
}

std::string TextPlaces::Inserted(const std::string& line, const std::string& at, int nth) const {
  size_t place = text_.find(at);
  for (int i = 0; i < nth; ++i) place = text_.find(at, place + 1);
  EXPECT_NE(place, std::string::npos) << at;
  return text_.substr(0, place + 1) + line + "\n" + text_.substr(place + 1);
}

std::string TextPlaces::Changed(const std::string& from, const std::string& to) const {
  const size_t place = text_.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text_.substr(0, place) + to + text_.substr(place + from.size());
}

std::string TextPlaces::Behind(const std::string& at, const std::string& end) const {
  const size_t number = text_.find(at) + at.size();
  const size_t place = text_.find_first_not_of("+-.0123456789", number);
  return text_.substr(0, place) + end + text_.substr(place);
}

MotionProgram TextPlaces::Read(const std::string& text) const {
  return post_->Read({{file_, text}}, plan_.arm, settings_);
}

std::string TextPlaces::Problems(const std::string& text) const {
  std::string problems;
  try {
    Read(text);
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems())
      problems += std::to_string(problem.place.line) + ": " + problem.message + "\n";
  }
  return problems;
}

void TextPlaces::ExpectRefused(const std::string& text, const std::string& what,
                               const std::string& hint) const {
  const std::string problems = Problems(text);
  EXPECT_NE(problems, "") << what << " is read";
  EXPECT_NE(problems.find(hint), std::string::npos) << what << ": " << problems;
  const auto differ = std::mismatch(text.begin(), text.end(), text_.begin(), text_.end());
  const auto line = 1 + std::count(text.begin(), differ.first, '\n');
  if (problems.empty()) return;
  EXPECT_GE(std::stol(problems), line) << what << ": " << problems;
}

}  // namespace millpose
