// SPDX-License-Identifier: GPL-3.0-or-later
// The text of a first job.
#pragma once

#include <string>
#include <vector>

#include "job/config/cell_settings.hpp"
#include "run/init/place_part.hpp"
#include "toolpath/cam/cam_source.hpp"

namespace millpose {

/// How a group is milled.
enum class FirstStrategy : uint8_t {
  kPad,         ///< a plane face, kept off its borders
  kPlanesFree,  ///< parallel planes, kept off the borders by the cutter's radius
  kPlanes,      ///< parallel planes up to the borders
  kBall,        ///< the same with a ball cutter, lifted where it would go into the part: scans, coarse facets
};

struct FirstJob {
  std::string name, part;          ///< the part's file as YAML
  std::string cell = "cell.yaml";  ///< likewise
  std::string tool = {};           ///< of a cell with several
  double unit = 1;                 ///< mm per unit of the file
  FacingGroup group;
  double patch_half = 0;  ///< how far from its seed at most it is milled, mm
  FirstStrategy strategy = FirstStrategy::kPad;
  Placement placement;
};

/// A patch (half its side, mm) that an arm of this reach mills with ease.
double PatchHalf(double reach);

std::string JobText(const FirstJob& job, const CellSettings& cell);

/// The job of a CAM file, `job.part`, at `job.placement`; group and strategy do not count. `section`: of its
/// cuts, for the speed of the spindle.
std::string PathJobText(const FirstJob& job, const CamSection& section, const CellSettings& cell);

}  // namespace millpose
