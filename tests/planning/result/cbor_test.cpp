// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/cbor.hpp"

#include <limits>
#include <nlohmann/json.hpp>

namespace millpose {
namespace {

// Another library reads what is written, and writes the same of it.
TEST(Cbor, AnotherLibraryWritesTheSameBytes) {
  std::string bytes;
  CborWriter to(bytes);
  to.Map(3);
  to.Text("numbers");
  const std::vector<double> numbers{0, -0.0, 1.5, 1.0 / 3, -1e300, 5e-324, 3.4e38, 3.5e38, 1e-45};
  to.List(numbers.size());
  for (const double number : numbers) to.Number(number);
  to.Text("whole");
  const std::vector<int64_t> whole{0,
                                   23,
                                   24,
                                   255,
                                   256,
                                   65535,
                                   65536,
                                   4294967295,
                                   4294967296,
                                   -1,
                                   -24,
                                   -25,
                                   -256,
                                   -257,
                                   -65537,
                                   -4294967297,
                                   std::numeric_limits<int64_t>::min()};
  to.List(whole.size() + 1);
  for (const int64_t number : whole) to.Integer(number);
  to.Unsigned(std::numeric_limits<uint64_t>::max());
  to.Text(std::string(300, 'x'));
  to.List(3);
  to.Bool(true);
  to.Text("");
  to.Number(-std::numeric_limits<double>::infinity());

  const auto json = nlohmann::ordered_json::from_cbor(bytes);
  EXPECT_EQ(json.at("numbers").get<std::vector<double>>(), numbers);
  for (size_t i = 0; i < whole.size(); ++i) EXPECT_EQ(json.at("whole").at(i).get<int64_t>(), whole[i]);
  std::string again;
  nlohmann::ordered_json::to_cbor(json, again);
  EXPECT_EQ(again, bytes);

  CborReader from(bytes);
  EXPECT_EQ(from.Map(), 3u);
  EXPECT_FALSE(from.IsNext("number"));
  EXPECT_TRUE(from.IsNext("numbers"));
  EXPECT_EQ(from.Text(), "numbers");
  ASSERT_EQ(from.List(), numbers.size());
  for (const double number : numbers)
    EXPECT_EQ(std::bit_cast<uint64_t>(from.Number()), std::bit_cast<uint64_t>(number));
  EXPECT_EQ(from.Text(), "whole");
  ASSERT_EQ(from.List(), whole.size() + 1);
  for (const int64_t number : whole) EXPECT_EQ(from.Integer(), number);
  EXPECT_EQ(from.Unsigned(), std::numeric_limits<uint64_t>::max());
  EXPECT_EQ(from.Text().size(), 300u);
  EXPECT_EQ(from.List(), 3u);
  EXPECT_TRUE(from.Bool());
  EXPECT_EQ(from.Text(), "");
  EXPECT_EQ(from.Number(), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(from.AtEnd());
}

TEST(Cbor, RefusesWhatIsNotThere) {
  const auto refuses = [](std::string_view bytes, auto read) {
    CborReader from(bytes);
    EXPECT_THROW(read(from), std::runtime_error);
  };
  const auto text = [](CborReader& from) { from.Text(); };
  const auto list = [](CborReader& from) { from.List(); };
  refuses("", text);
  refuses(
      "\x63"
      "ab",
      text);              // three bytes, two are there
  refuses("\x01", text);  // a number
  refuses(
      "\x7f"
      "\x61"
      "a"
      "\xff",
      text);  // of unknown length
  refuses(
      "\x9a\xff\xff\xff\xff"
      "\x01",
      list);  // more items than bytes
  refuses("\xf6", [](CborReader& from) { from.Bool(); });
  refuses("\xf9\x3c", [](CborReader& from) { from.Number(); });
  refuses(std::string_view("\xf9\x3c\x00", 3), [](CborReader& from) { from.Number(); });  // a half
  refuses("\x1b\xff\xff\xff\xff\xff\xff\xff\xff", [](CborReader& from) { from.Integer(); });
}

}  // namespace
}  // namespace millpose
