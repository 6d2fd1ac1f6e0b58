// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/gzip.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"

namespace millpose {
namespace {

std::string Some(size_t size, uint64_t seed) {
  RandomStream random(seed, 0);
  std::string bytes;
  while (bytes.size() < size) {
    if (random.Uniform() < 0.5)
      bytes += "the same again ";
    else
      bytes += static_cast<char>(random.Below(256));
  }
  bytes.resize(size);
  return bytes;
}

TEST(Gzip, GivesBackWhatItGot) {
  std::string file, whole;
  for (const size_t size : {0, 1, 70000, 5 << 20, 3}) {
    const std::string bytes = Some(size, size);
    EXPECT_EQ(Gunzip(Gzip(bytes)), bytes) << size;
    EXPECT_EQ(Gzip(bytes), Gzip(bytes));
    file += Gzip(bytes);
    whole += bytes;
  }
  EXPECT_EQ(Gunzip(file), whole) << "members follow each other";
  EXPECT_LT(file.size(), whole.size() / 2);
}

TEST(Gzip, WhatIsNoGzipFileOrDamagedIsRefused) {
  const std::string file = Gzip(Some(4000, 1)) + Gzip(Some(4000, 2));
  EXPECT_FALSE(Gunzip(""));
  EXPECT_FALSE(Gunzip("plan"));
  EXPECT_FALSE(Gunzip(file + "x"));
  const size_t first = Gzip(Some(4000, 1)).size();
  for (size_t cut = 1; cut < file.size(); cut += 37)
    EXPECT_EQ(Gunzip(file.substr(0, cut)).has_value(), cut == first) << cut;
  int read = 0;
  for (size_t i = 0; i < file.size(); i += 11) {
    std::string damaged = file;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    const std::optional<std::string> bytes = Gunzip(damaged);
    read += bytes.has_value();
    if (bytes) {
      EXPECT_EQ(*bytes, Gunzip(file)) << i;  // in a field of the head that says nothing
    }
  }
  EXPECT_LT(read, 3);
}

TEST(Gzip, WhatWouldFillTheMemoryIsRefused) {
  const std::string file = Gzip(std::string(64 << 20, '\0'));
  EXPECT_LT(file.size(), 1 << 19);
  EXPECT_FALSE(Gunzip(file));
}

}  // namespace
}  // namespace millpose
