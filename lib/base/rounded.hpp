// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace millpose {

/// The number that a text with so many digits says, 1 to 17: what is worked with is then what a file has.
/// Never −0. WithDigits(1234.56, 3) is 1230, WithDecimals(1234.56, 1) is 1234.6.
double WithDigits(double value, int digits);
/// The same with so many digits behind the point, 0 to 17.
double WithDecimals(double value, int decimals);

}  // namespace millpose
