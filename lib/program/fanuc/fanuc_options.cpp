// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/fanuc/fanuc_options.hpp"

#include <limits>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"

namespace millpose {
namespace {

constexpr double kWhole = 1e-9;  // relative: a feed that is a whole number but for arithmetic
constexpr int kBehind = 1, kElbowUp = 2, kFlip = 4;  // bits of Status()
constexpr const char* kSecondGroup = "GP2_";

/// The faceplate as FANUC counts it, in F: x up where all axes are 0. Its own inverse.
Pose Faceplate() {
  Pose faceplate = Pose::Identity();
  faceplate.linear().diagonal() << -1, -1, 1;
  return faceplate;
}

}  // namespace

Pose FanucBase(const FanucOptions& options) {
  return Pose(Eigen::Translation3d(0, 0, -options.world_height.value_or(0)));
}

Pose FanucTool(const PostSettings& settings, const Pose& X_FT) {
  Pose utool = X_FT;
  utool.linear() = X_FT.linear() * settings.R_TC();
  return Faceplate() * utool;
}

Pose FanucFlangeTool(const PostSettings& settings, const Pose& utool) {
  Pose X_FT = Faceplate() * utool;
  X_FT.linear() = X_FT.linear() * settings.R_TC().transpose();
  return X_FT;
}

std::array<double, 6> FanucNumbers(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation(), rpw = AnglesZyx(pose.linear()) * kDegPerRad;
  std::array<double, 6> numbers{p.x(), p.y(), p.z(), rpw[2], rpw[1], rpw[0]};
  for (double& number : numbers) number = Rounded(number, kFanucDecimals);
  if (std::abs(numbers[4]) == 90) {
    // Only W and R together are determined there: R = 0, as whoever reads it finds.
    const double both = numbers[4] > 0 ? numbers[3] - numbers[5] : numbers[3] + numbers[5];
    numbers[3] = Rounded(std::remainder(both, 360), kFanucDecimals);
    numbers[5] = 0;
  }
  for (const size_t angle : {3, 5})
    if (numbers[angle] <= -180) numbers[angle] += 360;  // as pendants show it
  return numbers;
}

Pose FromFanucNumbers(const std::array<double, 6>& numbers) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  pose.linear() = FromAnglesZyx(Eigen::Vector3d(numbers[5], numbers[4], numbers[3]) * kRadPerDeg);
  return pose;
}

FanucSpeed FanucSpeedOf(double feed) {
  const auto whole = [](double number) { return static_cast<int>(std::floor(number * (1 + kWhole))); };
  const FanucSpeed seconds{std::min(whole(feed), 2000), true},
      minutes{std::min(whole(feed * 6), 12000), false};
  if (seconds.number > 0 && seconds.feed() >= minutes.feed()) return seconds;
  return {std::max(1, minutes.number), false};
}

std::string FanucConfigText(const FanucConfig& config) {
  const auto letter = [&](int bit, char set, char otherwise) {
    return (config.status & bit) != 0 ? set : otherwise;
  };
  return fmt::format("{} {} {}, {}", letter(kFlip, 'F', 'N'), letter(kElbowUp, 'U', 'D'),
                     letter(kBehind, 'B', 'T'), fmt::join(config.turns, ", "));
}

FanucConfig FanucConfigOf(const FanucOptions& options, const PostSettings& settings, const Arm& arm,
                          const Joints& q) {
  FanucConfig config{Status(arm, q), {}};
  const Joints angles = settings.axes.FromArm(q);
  for (size_t i = 0; i < 3; ++i)
    config.turns[i] = static_cast<int>(std::floor((angles[options.turn_axes[i] - 1] + kPi) / (2 * kPi)));
  return config;
}

Joints FanucLeast(const FanucOptions& options, const std::array<int, 3>& turns) {
  Joints least = Joints::Constant(-std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < 3; ++i) least[options.turn_axes[i] - 1] = (2 * turns[i] - 1) * kPi;
  return least;
}

std::array<int, 3> FanucTurns(const FanucOptions& options, const Joints& least) {
  std::array<int, 3> turns{};
  for (size_t i = 0; i < 3; ++i)
    turns[i] = static_cast<int>(std::lround((least[options.turn_axes[i] - 1] + kPi) / (2 * kPi)));
  return turns;
}

std::vector<FanucAxis> FanucAxes(const PostSettings& settings) {
  std::vector<FanucAxis> axes;
  for (const ControllerAxis& axis : settings.controller_axes) {
    const bool second = axis.name.starts_with(kSecondGroup);
    axes.push_back(
        {&axis, second ? 2 : 1, second ? axis.name.substr(4) : axis.name, IsRotary(settings, axis)});
  }
  return axes;
}

std::string FanucGroups(const PostSettings& settings) {
  const std::vector<FanucAxis> axes = FanucAxes(settings);
  return std::ranges::any_of(axes, [](const FanucAxis& axis) { return axis.group == 2; }) ? "1,1,*,*,*"
                                                                                          : "1,*,*,*,*";
}

}  // namespace millpose
