// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/error.hpp"
#include "job/inputs.hpp"

namespace millpose {

/// The same error with places: a problem that names a key of the job ("toolpath.drill.depth_mm: …") and no
/// place, or the job file alone, gets the line and column of that key, or of the nearest section above it
/// that the file has. What an override gave keeps the file alone. Likewise one that names the cell file and a
/// key of it.
InputError Located(const InputError& error, const JobInputs& inputs);
/// The same of problems that name the cell file alone.
InputError LocatedInCell(const InputError& error, const CellSettings& cell);

/// Runs `step`, whose errors are located in the job.
template <class Step>
auto WithPlaces(const JobInputs& inputs, Step step) {
  try {
    return step();
  } catch (const InputError& error) {
    throw Located(error, inputs);
  }
}

}  // namespace millpose
