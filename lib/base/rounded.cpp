// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rounded.hpp"

#include "base/text.hpp"

namespace millpose {

double WithDigits(double value, int digits) {
  return *ParseNumber(fmt::format("{:.{}g}", value, digits)) + 0.0;
}

double WithDecimals(double value, int decimals) {
  return *ParseNumber(fmt::format("{:.{}f}", value, decimals)) + 0.0;
}

}  // namespace millpose
