// SPDX-License-Identifier: GPL-3.0-or-later
// A slip in a file, and what is said of it.
#pragma once

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace millpose {

struct Slip {
  const char* from;  ///< text to replace
  const char* to;
  int line = 0, column = 0;
  const char* message = "";  ///< beginning of the message
};

inline std::string Slipped(std::string text, const Slip& slip) {
  const size_t at = text.find(slip.from);
  EXPECT_NE(at, std::string::npos) << slip.from;
  return text.replace(at, std::string_view(slip.from).size(), slip.to);
}

template <class Parse>
void ExpectProblem(const Slip& slip, const std::string& text, Parse parse) {
  try {
    parse(text, "f.yaml");
    ADD_FAILURE() << "accepted: " << slip.to;
  } catch (const InputError& error) {
    ASSERT_FALSE(error.problems().empty());
    const Problem& problem = error.problems().front();
    EXPECT_EQ(problem.place.line, slip.line) << slip.to << '\n' << error.what();
    EXPECT_EQ(problem.place.column, slip.column) << slip.to << '\n' << error.what();
    EXPECT_TRUE(problem.message.starts_with(slip.message)) << slip.to << '\n' << error.what();
    EXPECT_EQ(error.problems().size(), 1u) << slip.to << '\n' << error.what();
  }
}

}  // namespace millpose
