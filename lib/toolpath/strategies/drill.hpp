// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/units.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

/// A hole as the job states it.
struct HolePlace {
  Eigen::Vector3d entrance = Eigen::Vector3d::Zero();  ///< P, mm
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();      ///< out of the material; unit vector
  std::optional<double> depth;                         ///< mm; else that of all holes
};

/// Which round holes of the part are drilled.
struct CircleChoice {
  double diameter = 0;                  ///< mm
  double tolerance = 0.05;              ///< mm, of the diameter and of the roundness
  std::optional<Eigen::Vector3d> from;  ///< side that holes with two ends are drilled from; unit vector
};

/// How deep a countersink goes: one of both.
struct Countersink {
  std::optional<double> diameter;  ///< of the sink at the entrance, mm
  std::optional<double> depth;     ///< of the cutter's tip under the entrance, mm
};

/// Holes, each a pass along its axis.
struct Drill final : Strategy {
  std::vector<HolePlace> holes;         ///< given, or
  std::optional<CircleChoice> circles;  ///< found on the part
  std::optional<double> depth;          ///< to the end of the full diameter, mm
  std::optional<double> breakthrough;  ///< of through holes: the full diameter goes on beyond the far end, mm
  double point_angle = kPi;            ///< of the cutter's tip, rad: π is flat
  double clearance = 2;                ///< over the entrance, where the feed begins and ends, mm
  std::optional<double> peck;          ///< largest depth of a stroke, mm
  std::optional<double> chip_retract;  ///< back between strokes, mm; else to the clearance
  double dwell = 0;                    ///< at the bottom, s
  std::optional<Countersink> countersink;

  std::string Name() const override { return "drill"; }
  bool NeedsPart() const override { return circles.has_value(); }
  bool IsPrescribed() const override { return true; }
  bool HasMillingForce() const override { return false; }
  std::optional<double> DrillPoint() const override {
    // What is open already where a countersink cuts nothing says.
    return countersink ? std::nullopt : std::optional(point_angle);
  }
  bool CutsAtPlungeFeed() const override { return true; }
  std::string DefaultObjective() const override { return "drilling"; }
  double Dwell() const override { return dwell; }
  std::vector<std::string> WithoutEffect() const override;
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;
};

}  // namespace millpose
