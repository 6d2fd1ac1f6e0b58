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

}  // namespace millpose
