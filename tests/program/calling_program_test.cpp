// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/calling_program.hpp"

#include <gtest/gtest.h>

#include "program/post_entry.hpp"

namespace millpose {
namespace {

class Calling : public testing::TestWithParam<std::string> {
 protected:
  CallingSyntax syntax_ = MakePost(GetParam())->Calling();
  std::string main_ = "two parts";

  CalledProgram Called(const std::string& job) {
    return AsCalled(syntax_, job, {{ProgramName(syntax_, job) + syntax_.ending, "; text\n" + syntax_.tail}});
  }
  ProgramFiles Written() {
    CalledProgram first = Called("Part_1"), second = Called("Part_2");
    first.comments = {{"operation", "one"}, {"tool", "\xc3\xa4"}};
    return WriteCalling(syntax_, main_, {{"job", main_}}, {first, second});
  }
  std::string& Text(ProgramFiles& files) { return files.at(ProgramName(syntax_, main_) + syntax_.ending); }
  std::vector<std::string> Read(const ProgramFiles& files) { return ReadCalling(syntax_, main_, files); }
};

TEST_P(Calling, WhatIsWrittenIsReadBack) {
  const std::vector<std::string> names = {Called("Part_1").name, Called("Part_2").name};
  EXPECT_EQ(Read(Written()), names);
}

TEST_P(Calling, ACalledProgramIsTheProgramAndItsWayBack) {
  const CalledProgram called = Called("Part_1");
  ASSERT_EQ(called.files.size(), 1U);
  const auto& [name, text] = *called.files.begin();
  EXPECT_EQ(name, called.name + syntax_.called_ending);
  EXPECT_NE(text.find("; text\n"), std::string::npos);
  EXPECT_TRUE(text.find("M30") == std::string::npos && text.find("M2\n") == std::string::npos);
}

TEST_P(Calling, CommentsAndBlankLinesSayNothing) {
  ProgramFiles files = Written();
  std::string& text = Text(files);
  const size_t at = text.find("; job");
  text.insert(at, "\n  ; by hand\n\n");
  EXPECT_EQ(Read(files).size(), 2U);
}

TEST_P(Calling, WhateverElseStandsThereIsAnErrorWithItsLine) {
  for (const std::string foreign :
       {"M3", "PTP HOME", "G0 X0", "$OUT[1]=TRUE", "Part_3 ( ) ; and more", "IF TRUE THEN"}) {
    ProgramFiles files = Written();
    std::string& text = Text(files);
    text.insert(text.find("; operation"), foreign + "\n");
    const bool is_call =
        foreign == "M3" && GetParam() == "sinumerik";  // a name; which names are called is checked
    if (is_call) {
      EXPECT_EQ(Read(files).size(), 3U);
      continue;
    }
    try {
      Read(files);
      ADD_FAILURE() << foreign;
    } catch (const InputError& error) {
      EXPECT_NE(
          std::string(error.what())
              .find(":" + std::to_string(1 + std::count(text.begin(),
                                                        text.begin() + static_cast<long>(text.find(foreign)),
                                                        '\n'))),
          std::string::npos)
          << error.what();
    }
  }
}

TEST_P(Calling, WithoutItsEndOrBehindItNothingHolds) {
  ProgramFiles files = Written();
  std::string& text = Text(files);
  const std::string whole = text;
  text.resize(text.size() - syntax_.tail.size());
  EXPECT_THROW(Read(files), InputError);
  text = whole + whole.substr(whole.find("; operation"));
  EXPECT_THROW(Read(files), InputError);
  EXPECT_THROW(Read({}), InputError);
}

INSTANTIATE_TEST_SUITE_P(Controllers, Calling, testing::Values("krl", "sinumerik", "linuxcnc"));

}  // namespace
}  // namespace millpose
