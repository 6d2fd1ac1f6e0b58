// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pose/freedom.hpp"

namespace millpose {

/// By how much the tool axis may lean one way, rad.
struct LeanRange {
  double from = 0, to = 0;
  double step = 0;     ///< grid of searches
  double nominal = 0;  ///< how the tool path is laid
};

/// Leans the tool about the contact, which stays where it is; the tip follows from cutter and axis.
class LeanOfTool : public Freedom {
 public:
  using Options = LeanRange;
  explicit LeanOfTool(const LeanRange& range) : range_(range) {}
  const LeanRange& options() const { return range_; }
  double Lower() const override { return range_.from; }
  double Upper() const override { return range_.to; }
  bool Periodic() const override { return false; }
  double Step() const override { return range_.step; }
  double Nominal() const override { return range_.nominal; }
  bool IsLean() const override { return true; }
  ToolStance Lean(const CutterContact& contact, const ToolStance& from, double value) const override;

 private:
  virtual Eigen::Vector3d About(const CutterContact& contact) const = 0;
  LeanRange range_;
};

/// Towards the feed.
class Lead final : public LeanOfTool {
 public:
  using LeanOfTool::LeanOfTool;
  std::string Name() const override { return "lead"; }
  void Open(LeanRules& rules) const override;

 private:
  Eigen::Vector3d About(const CutterContact& contact) const override;
};

/// To the right of the feed, seen against the normal.
class Tilt final : public LeanOfTool {
 public:
  using LeanOfTool::LeanOfTool;
  std::string Name() const override { return "tilt"; }
  void Open(LeanRules& rules) const override;

 private:
  Eigen::Vector3d About(const CutterContact& contact) const override;
};

}  // namespace millpose
