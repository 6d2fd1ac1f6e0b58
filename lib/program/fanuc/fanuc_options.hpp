// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "program/post.hpp"

namespace millpose {

/// What of a cell only FANUC's controllers know. Every default here and only here; the keys stand in
/// fanuc_keys.cpp.
struct FanucOptions {
  int user_frame = 0, tool_frame = 0;  ///< UFRAME and UTOOL of programs, 1…; 0: not given
  int position_register = 0;  ///< PR by which programs set both; 0: the controller holds their values
  std::optional<double> world_height =
      std::nullopt;                       ///< mm, of the controller's world above the robot's base; needed
  std::array<int, 3> turn_axes{4, 5, 6};  ///< whose full turns CONFIG's numbers count
  /// The option of Advanced Constant Path is there: CRy.
  bool corner_region = false;
  std::optional<double> acceleration_time = std::nullopt;  ///< s: of a whole ramp at CNTn; empty: no CNTn
  int joint_speed_percent = 20;                            ///< of the axes' largest speed, in J
};

/// The robot's base in the controller's world, whose origin is on axis 1 at the height of axis 2.
Pose FanucBase(const FanucOptions& options);
/// UTOOL of a tool at X_FT, in the faceplate as FANUC counts it: turned by half about z against F.
Pose FanucTool(const PostSettings& settings, const Pose& X_FT);
/// The inverse: X_FT of a UTOOL.
Pose FanucFlangeTool(const PostSettings& settings, const Pose& utool);

/// Numbers have three decimals: mm, degrees.
inline constexpr int kFanucDecimals = 3;
/// X, Y, Z (mm), W, P, R (degrees) of R = Rz(R)·Ry(P)·Rx(W), rounded as they are written.
std::array<double, 6> FanucNumbers(const Pose& pose);
Pose FromFanucNumbers(const std::array<double, 6>& numbers);

/// Speed of L in whole numbers of a unit.
struct FanucSpeed {
  int number = 1;
  bool per_second = false;                                            ///< mm/sec, else cm/min
  double feed() const { return per_second ? number : number / 6.0; }  ///< mm/s
};
/// The fastest that is not faster than `feed` (mm/s), 1 cm/min at least.
FanucSpeed FanucSpeedOf(double feed);

/// CONFIG of a straight motion's end: which of the eight ways the arm stands, and full turns of
/// FanucOptions::turn_axes, 0 within half a turn of 0 degrees.
struct FanucConfig {
  int status = 0;  ///< as Status() counts
  std::array<int, 3> turns{};
};
/// "N U T, 0, 0, 0": N where J5 < 0 (F: flip), U elbow up (D: down), T wrist centre in front (B: behind).
std::string FanucConfigText(const FanucConfig& config);
FanucConfig FanucConfigOf(const FanucOptions& options, const PostSettings& settings, const Arm& arm,
                          const Joints& q);
/// The controller's angles from which on its axes may stand where `turns` hold (Motion::least), and back.
Joints FanucLeast(const FanucOptions& options, const std::array<int, 3>& turns);
std::array<int, 3> FanucTurns(const FanucOptions& options, const Joints& least);

/// An external axis in a position: of which motion group, by which word.
struct FanucAxis {
  const ControllerAxis* axis;
  int group = 1;
  std::string word;  ///< E1…E3 in group 1, J1…J3 in group 2
  bool rotary = false;
};
std::vector<FanucAxis> FanucAxes(const PostSettings& settings);
/// DEFAULT_GROUP: "1,*,*,*,*", or with group 2 "1,1,*,*,*".
std::string FanucGroups(const PostSettings& settings);

}  // namespace millpose
