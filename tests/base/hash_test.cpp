// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.hpp"

namespace millpose {

TEST(Hash, IsStableAndSeesEveryByte) {
  EXPECT_EQ(Hash(""), "99aa06d3014798d86001c324468d497f");  // published test vector of XXH3_128bits
  std::string bytes(300, 'a');
  const std::string before = Hash(bytes);
  for (char& byte : bytes) {
    byte = 'b';
    EXPECT_NE(Hash(bytes), before);
    byte = 'a';
  }
  EXPECT_EQ(Hash(bytes), before);
}

TEST(Hasher, PartsCountAsTheWhole) {
  const std::string bytes(1000, 'x');
  for (const size_t part : {1u, 7u, 300u, 1000u}) {
    Hasher hasher;
    for (size_t at = 0; at < bytes.size(); at += part) hasher.Add(std::string_view(bytes).substr(at, part));
    EXPECT_EQ(hasher.Digits(), Hash(bytes));
  }
  EXPECT_EQ(Hasher().Digits(), Hash(""));
}

}  // namespace millpose
