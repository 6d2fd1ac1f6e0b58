// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/yaml/edit.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace millpose {
namespace {

std::string Put(const std::string& text, const std::string& value = "[7, 8]") {
  return yaml::WithKey(text, "x.yaml", "s", "k", value);
}

// What stands around the value: before it, and what ends or follows it.
struct Surrounding {
  const char *before, *old, *after;
};

TEST(Edit, OnlyTheValueChangesWhateverStandsAroundIt) {
  const Surrounding texts[] = {
      {"# a\ns:\n  a: 1\n  k: ", "[1, 2]", "  # said by hand\n\nrest: {x: 1}\n"},
      {"s:\r\n  k: ", "[1, 2]", "\r\n  b: 2   \r\nrest: 3\r\n"},  // CRLF
      {"s:\r\n  k: ", "plain words", "\r\n"},                     // whose end is no part of a word
      {"s:\n  k: ", "plain words", "  \t # comment\n  b: 'x'\n"},
      {"s:\n  k: ", "3", ""},                  // no end of line at all
      {"s: {a: 1, k: ", "bare", ", b: 2}\n"},  // the next key stays
      {"s: {k: ", "bare", "}  # last\n"},
      {"s: {k: ", "{a: 1, b: [2, '}']}", ", b: 2}\n"},
      {"s:\n  k: ", "{a: \"]}\", b: 'it''s }'}", "\n"},
      {"s:\n  k: ", "\"a \\\" # b\"", " # c\n"},
      {"s:\n  k: ", "'it''s'", "\n"},
      {"\xef\xbb\xbfs: {k: ", "1", "}\n"},  // a byte order mark in front
      {"\xef\xbb\xbfs:\r\n  ü: 'Fräser'\r\n  k: ", "1", "\r\n"},
      {"ä: 'öüß'\ns: {ü: 'ß', k: ", "1", ", b: 'ö'}\n"},
  };
  for (const auto& [before, old, after] : texts)
    EXPECT_EQ(Put(std::string(before) + old + after), std::string(before) + "[7, 8]" + after)
        << before << old;
}

TEST(Edit, AKeyMoreTakesTheTextsOwnLineEnds) {
  EXPECT_EQ(Put("a: 1\ns:\n    b: 2\n    c: 3\n"), "a: 1\ns:\n    k: [7, 8]\n    b: 2\n    c: 3\n");
  EXPECT_EQ(Put("a: 1\r\ns:\r\n  b: 2\r\n"), "a: 1\r\ns:\r\n  k: [7, 8]\r\n  b: 2\r\n");
  EXPECT_EQ(Put("a: 1\r\ns:\r\n  b: 2"), "a: 1\r\ns:\r\n  k: [7, 8]\r\n  b: 2");
  EXPECT_EQ(Put("s: {b: 2}  # c\n"), "s: {k: [7, 8], b: 2}  # c\n");
  EXPECT_EQ(Put("\xef\xbb\xbfs: {b: 2}\n"), "\xef\xbb\xbfs: {k: [7, 8], b: 2}\n");
}

TEST(Edit, ASecondEditIsTheSameAsOne) {
  for (const char* text : {"s:\r\n  b: 2\r\n", "s: {b: 2}\n", "s:\n  k: old # c\n"})
    EXPECT_EQ(Put(Put(text, "{x: 1}")), Put(text)) << text;
}

TEST(Edit, WhatIsNotInOneLineIsRefusedAndNamed) {
  for (const char* text : {"s:\n  k:\n    a: 1\n", "s:\n  k: [1,\n    2]\n", "s:\n  k: |\n    a\n",
                           "s:\n  k: >\n    a\n", "s:\n  k:\n  b: 1\n", "s:\n  k: a\n    b\n",
                           "s:\n  k: \"a\n    b\"\n", "s:\n  k:\n    - 1\n", "s: {k: [1, # c\n 2]}\n"})
    EXPECT_THROW(Put(text), InputError) << text;
  for (const char* text : {"a: 1\n", "s: 1\n", "s: {}\n", "s:\n", "s: [1]\n", ""})
    EXPECT_THROW(Put(text), InputError) << text;
}

}  // namespace
}  // namespace millpose
