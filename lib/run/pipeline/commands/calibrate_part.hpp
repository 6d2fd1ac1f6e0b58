// SPDX-License-Identifier: GPL-3.0-or-later
// A milled part's measured face against the plan that it was milled by (docs/compensation.md).
#pragma once

#include <filesystem>
#include <optional>

#include "base/file_root.hpp"
#include "job/config/job_settings.hpp"
#include "job/inputs.hpp"
#include "planning/compensation/calibrate.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

struct CalibrateArguments {
  std::filesystem::path
      measured;                ///< CSV: x_mm,y_mm,z_mm in the workpiece's frame, error_um along the normal
  std::filesystem::path plan;  ///< output folder of the plan
  std::optional<std::filesystem::path> job;  ///< of it, where it does not stand beside the folder
  FileRoot root{};
};

struct CalibratedPart {
  Calibration found;
  ForceFactors factors;  ///< for the next plan: those of this one times what was found
  double farthest = 0;   ///< mm, of a reading from the planned point that it is compared with
};

/// Compares every reading with the nearest cut point of the finished face. Throws InputError for what cannot
/// be read and for readings that lie more than a cutter's diameter from every point.
CalibratedPart CalibratePart(const CalibrateArguments& arguments);

}  // namespace millpose
