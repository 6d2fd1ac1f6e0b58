// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "job/workpiece.hpp"
#include "store/checkpoints.hpp"
#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// What laying the tool path is handed: the part's mesh, and the inputs that it may read (InputsOfToolpath).
struct LayingInputs {
  JobInputs inputs;
  Mesh mesh;        ///< in P
  std::string key;  ///< the hash of both
};
LayingInputs MakeLayingInputs(const JobInputs& inputs, const Mesh& mesh);

/// A tool path in P with its gouges and what every point takes off.
struct LaidPathOfJob {
  JobToolpath made;
  std::optional<CuttingForce> heaviest;  ///< of all cuts, where the job says what the cutter takes off
};

/// Lays it, or takes what the same inputs came to before. Throws InputError, Interrupted.
LaidPathOfJob LayPath(const LayingInputs& laying, const CheckpointStore& checkpoints,
                      const Execution& execution);

}  // namespace millpose
