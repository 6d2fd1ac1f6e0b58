// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/controller_zero.hpp"

#include <fmt/ranges.h>

#include "base/text.hpp"
#include "job/assemble.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/axis_convention.hpp"

namespace millpose {
namespace {

constexpr double kQuarterWithin = 1e-6;  // rad: that a zero is a whole number of quarter turns

std::array<int, 6> SignsOf(const AxisConvention& axes) {
  std::array<int, 6> signs{};
  for (int i = 0; i < 6; ++i) signs[static_cast<size_t>(i)] = axes.matrix()(i, i) < 0 ? -1 : 1;
  return signs;
}

/// Whole turns taken out, and what is within rounding of a quarter turn made that.
Joints Tidy(const Joints& offset) {
  Joints tidy;
  for (int i = 0; i < 6; ++i) {
    const double quarters = std::round(Principal(offset[i]) / (kPi / 2));
    const bool whole = std::abs(Principal(offset[i]) - quarters * (kPi / 2)) < kQuarterWithin;
    tidy[i] = whole ? DegToRad(90 * quarters) + 0.0 : Principal(offset[i]);
  }
  return tidy;
}

std::string Offsets(const Joints& offset) {
  std::vector<std::string> degrees;
  for (const double angle : offset)
    degrees.push_back(ShortestNumber(std::round(RadToDeg(angle) * 1e6) / 1e6));
  return fmt::format("[{}]", fmt::join(degrees, ", "));
}

std::string Keys(const std::array<int, 6>& signs, const Joints& offset) {
  return fmt::format("axis_signs: [{}], axis_offsets_deg: {}", fmt::join(signs, ", "), Offsets(offset));
}

/// "level", "upright", "hanging", or so many degrees above or below the level; `down`: rad.
std::string Lean(double down) {
  const double degrees = std::round(RadToDeg(Principal(down)) * 10) / 10 + 0.0;
  if (degrees == 0) return "level";
  if (std::abs(degrees) == 180) return "level, backwards";
  if (degrees == -90) return "upright";
  if (degrees == 90) return "hanging";
  return fmt::format("{:.1f}° {} the level", std::abs(degrees), degrees < 0 ? "above" : "below");
}

class Settling {
 public:
  Settling(bool from_urdf, CellSettings& cell)
      : from_urdf_(from_urdf), cell_(cell), arm_(MakeArm(cell.arm)) {}

  std::vector<Problem> Settle() {
    for (auto& [name, controller] : cell_.controllers) {
      PostOptions& options = controller.shared;
      const bool both = options.axis_signs && options.axis_offsets;
      if (const auto own = controller.post->OwnZero())
        Follow(name, *own, options);
      else if (from_urdf_ && !both)
        Refuse(name, options,
               fmt::format("the zero of an arm from a URDF need not be the controller's (here {}). Where "
                           "it counts as the file does: {}",
                           DescribeZero(arm_), Keys({1, 1, 1, 1, 1, 1}, Joints::Zero())));
      const AxisConvention settled = options.UncoupledAxes();
      options.axis_signs = SignsOf(settled);
      options.axis_offsets = settled.offset();
    }
    return std::move(problems_);
  }

 private:
  /// From the maker's zero.
  void Follow(const std::string& name, const AxisConvention& own, PostOptions& options) {
    const AxisConvention follows = own.After(InnerConvention(arm_));
    const std::array<int, 6> signs = SignsOf(follows);
    const Joints offset = Tidy(follows.offset());
    const bool own_count = signs == std::array<int, 6>{1, 1, 1, 1, 1, 1} && offset.isZero(0.0);
    const bool both = options.axis_signs && options.axis_offsets,
               any = options.axis_signs || options.axis_offsets;
    if (both || (own_count && !from_urdf_)) {
      const AxisConvention stated = options.UncoupledAxes();
      if (SignsOf(stated) != signs || (Tidy(stated.offset() - offset).array().abs() > kQuarterWithin).any())
        cell_.warnings.push_back(fmt::format(
            "{}: controllers.{}: {} is not what the arm's geometry gives with the maker's zero, which is {}",
            cell_.file, name, Keys(SignsOf(stated), stated.offset()), Keys(signs, offset)));
      return;
    }
    if (any)
      return Refuse(name, options,
                    fmt::format("both are needed where one is given. The arm's geometry gives {}",
                                Keys(signs, offset)));
    if (const std::string doubt = Doubt(offset); !doubt.empty())
      return Refuse(name, options, fmt::format("{}. If the rest is right: {}", doubt, Keys(signs, offset)));
    options.axis_signs = signs;
    options.axis_offsets = offset;
    if (!own_count)
      cell_.notes.push_back(
          fmt::format("controllers.{}: the arm's own zero has its {}; the controller counts from its "
                      "maker's zero, so {}",
                      name, DescribeZero(arm_), Keys(signs, offset)));
  }

  /// Why the geometry does not tell the zero; empty: it does. Base and flange are where programs count from,
  /// so axes 1 and 6 follow from them. Axis 4 looks alike after half a turn.
  static std::string Doubt(const Joints& offset) {
    for (int i = 0; i < 6; ++i)
      if (offset[i] != DegToRad(90 * std::round(RadToDeg(offset[i]) / 90)))
        return fmt::format(
            "axis {} is off the controller's zero by {:.6g}°, which is no quarter turn: a calibrated or "
            "another arm",
            i + 1, RadToDeg(offset[i]));
    if (offset[3] != 0)
      return fmt::format(
          "the geometry does not tell where the controller has the zero of axis 4, which looks alike "
          "after half a turn (the file's is off by {:.6g}°)",
          RadToDeg(offset[3]));
    return "";
  }

  void Refuse(const std::string& name, const PostOptions& options, const std::string& why) {
    const std::string missing = options.axis_signs     ? "axis_offsets_deg is"
                                : options.axis_offsets ? "axis_signs is"
                                                       : "axis_signs and axis_offsets_deg are";
    problems_.push_back({{cell_.file, cell_.controllers_line},
                         fmt::format("controllers.{}: {} missing; needed, since {}", name, missing, why)});
  }

  const bool from_urdf_;
  CellSettings& cell_;
  const Arm arm_;
  std::vector<Problem> problems_;
};

}  // namespace

std::string DescribeZero(const Arm& arm) {
  const Joints q = InnerAngles(arm, Joints::Zero());
  return fmt::format("upper arm {}, forearm {}", Lean(q[1]), Lean(q[1] + q[2]));
}

std::vector<Problem> SettleControllerZeros(bool from_urdf, CellSettings* cell) {
  return Settling(from_urdf, *cell).Settle();
}

}  // namespace millpose
