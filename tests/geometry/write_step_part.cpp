// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "tests/geometry/step_parts.hpp"

int main() {
  const std::string part = millpose::DrilledBlockStep("MM");
  return std::fwrite(part.data(), 1, part.size(), stdout) == part.size() ? 0 : 1;
}
