// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of Chen et al. 2021 as printed.
#pragma once

#include "tests/machine/robot/arms.hpp"

namespace millpose {

inline const std::array<Joints, 6> kTable2{
    Degrees(0, -68.844, 85.789, -34.262, -106.945, 61.237),
    Degrees(-12.242, -69.876, 90.090, -34.696, 103.227, 66.995),
    Degrees(-15.601, -74.773, 86.168, -82.851, -96.728, 82.051),
    Degrees(8.250, -110.623, 121.625, 46.524, 44.622, 99.971),
    Degrees(29.126, -98.598, 135.896, -17.061, -61.474, 29.061),
    Degrees(-8.860, -83.924, 73.785, -81.996, -115.880, 98.603),
};
inline const std::array<Joints, 2> kTable4{Degrees(0.11, -93.76, 112.43, 0, 71.33, 0),
                                           Degrees(-0.35, -51.49, 54.3, 0, 87.46, 0)};
inline const std::array<Joints, 2> kTable5{Degrees(-45, -140, 38, -350, -118, -350),
                                           Degrees(45, -30, 120, 350, 106, 350)};
inline const std::array<Joints, 5> kTable6{
    Degrees(-4.512, -63.932, 103.263, 18.839, 53.130, 16.206),
    Degrees(-8.468, -61.606, 103.741, 35.867, 57.796, 30.678),
    Degrees(-11.750, -57.984, 104.228, 49.943, 65.186, 42.549),
    Degrees(-14.154, -53.296, 104.597, 61.066, 74.504, 51.833),
    Degrees(-15.536, -47.718, 104.628, 69.806, 85.137, 59.040),
};

/// The tool that explains Table 6 (docs/paper.md): axis from tip to holder and tip, in the flange.
inline const Eigen::Vector3d kToolAxis = Eigen::Vector3d(0.999833, -0.018257, 0.000586).normalized();
inline const Eigen::Vector3d kTip = Eigen::Vector3d(-0.66, -28.26, 250.33) - 250 * kToolAxis;

}  // namespace millpose
