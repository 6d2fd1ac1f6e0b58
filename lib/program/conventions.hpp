// SPDX-License-Identifier: GPL-3.0-or-later
// How controllers count: axes of frames, orientation angles.
#pragma once

#include <Eigen/Core>

#include "base/enum_words.hpp"

namespace millpose {

/// An axis of a frame, one way or the other.
enum class FrameAxis : uint8_t { kX, kY, kZ, kMinusX, kMinusY, kMinusZ };
inline constexpr EnumWords<FrameAxis, 6> kFrameAxisWords = {{{"x", FrameAxis::kX},
                                                             {"y", FrameAxis::kY},
                                                             {"z", FrameAxis::kZ},
                                                             {"-x", FrameAxis::kMinusX},
                                                             {"-y", FrameAxis::kMinusY},
                                                             {"-z", FrameAxis::kMinusZ}}};
/// Unit, in that frame.
Eigen::Vector3d DirectionOf(FrameAxis axis);

/// The controller's tool frame C in T when `axis` of it lies along T's z (from tip to holder): the other axes
/// follow by cyclic exchange, so z is the identity.
Eigen::Matrix3d ToolAxis(FrameAxis axis);

/// How SINUMERIK and LinuxCNC count A, B, C, see ToolAngles(); kRpy2 SINUMERIK alone.
enum class AngleOrder : uint8_t { kRpy, kEuler, kRpy2 };
inline constexpr EnumWords<AngleOrder, 2> kAngleOrderWords = {
    {{"rpy", AngleOrder::kRpy}, {"euler", AngleOrder::kEuler}}};
/// SINUMERIK's words of G group 50 for them.
inline constexpr EnumWords<AngleOrder, 3> kOrientationGroupWords = {
    {{"orirpy", AngleOrder::kRpy}, {"orirpy2", AngleOrder::kRpy2}, {"orieuler", AngleOrder::kEuler}}};

}  // namespace millpose
