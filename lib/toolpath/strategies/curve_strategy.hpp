// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/strategy.hpp"

namespace millpose {

/// A drawing that the lines come from.
struct CurveDxf {
  std::string file;                 ///< relative to the job
  std::optional<double> unit;       ///< mm, where the file states none
  std::vector<std::string> layers;  ///< only these; empty: all
};

/// A polyline, or the lines of a drawing, projected along a direction onto the first faces that they meet.
struct CurveStrategy final : SurfaceStrategy {
  std::vector<Eigen::Vector3d> points;  ///< two or more; or
  std::optional<CurveDxf> dxf;
  Eigen::Vector3d project_along = -Eigen::Vector3d::UnitZ();  ///< the direction of looking; unit vector

  std::string Name() const override { return "curve"; }
  std::string File() const override { return dxf ? dxf->file : ""; }
  bool NeedsPart() const override { return true; }
  bool IsPrescribed() const override { return true; }
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override;
  /// Lays the lines of the drawing one after the other, where there is one.
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;

 private:
  std::vector<std::vector<Eigen::Vector3d>> lines_;  // of the drawing, once it is read
};

}  // namespace millpose
