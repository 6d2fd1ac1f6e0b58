// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/trig.hpp"
#include "base/units.hpp"
#include "planning/pose/freedom_entry.hpp"

namespace millpose {
namespace {

/// Turns the tool about its own axis: the freedom that every round cutter has.
class ToolRotation final : public Freedom {
 public:
  std::string Name() const override { return "rotation"; }
  double Lower() const override { return -kPi; }
  double Upper() const override { return kPi; }
  bool Periodic() const override { return true; }
  bool IsToolRotation() const override { return true; }
  Pose Apply(const Pose& X_WT, double value) const override {
    // R·Rz(value) written out: this runs once per candidate.
    const auto [sine, cosine] = SinCos(value);
    Pose turned = X_WT;
    turned.linear().col(0) = cosine * X_WT.linear().col(0) + sine * X_WT.linear().col(1);
    turned.linear().col(1) = cosine * X_WT.linear().col(1) - sine * X_WT.linear().col(0);
    return turned;
  }
};

}  // namespace

FreedomPointer RotationAboutTool() { return std::make_shared<const ToolRotation>(); }

FreedomEntry RotationEntry() { return {.name = "rotation", .always = RotationAboutTool()}; }

}  // namespace millpose
