// SPDX-License-Identifier: GPL-3.0-or-later
// A job's plan as a value: no text, no exit status, nothing written.
#pragma once

#include "base/execution.hpp"
#include "job/inputs.hpp"
#include "job/workpiece.hpp"
#include "machine/collision/world.hpp"
#include "planning/external/stations.hpp"
#include "planning/pass/face_planner.hpp"
#include "planning/pass/fixed_rotation.hpp"
#include "planning/pose/scorer.hpp"
#include "planning/result/plan_result.hpp"
#include "planning/standing/leave_in_stock.hpp"
#include "run/pipeline/programs/make_programs.hpp"
#include "run/pipeline/programs/start_programs.hpp"
#include "run/pipeline/stages/choose_stations.hpp"
#include "run/pipeline/stages/lay_path.hpp"
#include "store/checkpoints.hpp"
#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// What a job comes to before anything is planned.
struct PreparedJob {
  Cell cell;  ///< with the workpiece in its place; the external axes at 0, as in `world` and `problem`
  World world;
  ImportResult surface;      ///< the workpiece's mesh, in P
  LayingInputs laying;       ///< what the tool path was laid from
  JobToolpath made;          ///< in P, without points inserted later
  Toolpath toolpath;         ///< in W, each pass at its station
  std::vector<char> turned;  ///< passes that run from their other end than they were laid, in `made` too
  PoseProblem problem;
  Stations stations;
  std::vector<ExternalCourse> external;                ///< of each pass, where the external axes are
  std::vector<std::vector<ExternalCourse>> elsewhere;  ///< of each pass: as StationChoices::elsewhere
  std::optional<CuttingForce> heaviest;  ///< of all cuts, where the job says what the cutter takes off
  std::vector<std::string> warnings;     ///< what the user should know, one sentence each
};

/// Throws InputError for bad input; Interrupted.
PreparedJob PrepareJob(const JobInputs& inputs, const CheckpointStore& checkpoints,
                       const Execution& execution);

/// A planned job. Points, passes or gaps that could not be planned stand in the plan with their reason;
/// programs that their read-back does not confirm stand here with its findings.
struct PlannedJob {
  PreparedJob prepared;
  PlanResult plan;
  FixedComparison fixed;          ///< with the best fixed rotations
  std::vector<FaceChoice> faces;  ///< by pass, where whole ways are judged by the face; else empty
  FeedReduction reduction;
  std::optional<StockFigures> stock;           ///< where the job has a raw part
  std::optional<double> compensation_remains;  ///< median share of the deflection, where some is taken out
  JobPrograms programs;
  JobStarts starts;
  size_t resumed_passes = 0, resumed_gaps = 0;  ///< that came from checkpoints
};

/// Whether the milling points that a job was planned from stay in PlannedJob::prepared (`made`, `toolpath`)
/// once it is planned. Neither programs nor reports ask for them, and of 10^6 points they are 0.4 GB.
enum class LaidPoints : uint8_t { kStay, kGo };

/// Plans a job, whose STEP files are triangles by now (CutStepFiles). Throws InputError for bad input,
/// Interrupted when the execution's stop was requested: what was planned until then stays in `checkpoints`.
PlannedJob PlanJob(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
                   LaidPoints laid = LaidPoints::kStay);

/// Part `index` (from 0) of `count`: every count-th pass of a job, so that several machines can plan one job.
struct Share {
  size_t index = 0, count = 1;
  bool Has(size_t pass) const { return pass % count == index; }
};

/// Plans the passes of a share alone and leaves them in `checkpoints`.
void PlanShare(const JobInputs& inputs, const Share& share, const CheckpointStore& checkpoints,
               const Execution& execution);

/// How a job fares on a sample of its passes.
struct TriedJob {
  size_t passes = 0, of_passes = 0;  ///< tried; of the job
  size_t points = 0, of_points = 0;  ///< likewise
  std::string problem;               ///< the first of what would be a finding of its plan; empty: none
};

/// Plans every n-th pass of a job and the ways between these, with about `most_points` points: one pass at
/// least, of which every n-th point is planned where it has more than twice as many; rotations in steps of 2°
/// and motions checked to 2 mm where the job asks for finer ones; no other passes, fixed rotations, programs
/// or reports. What it leaves out may still have findings. Throws InputError for bad input; Interrupted.
TriedJob TryJob(const JobInputs& inputs, size_t most_points, const CheckpointStore& checkpoints,
                const Execution& execution);

/// That no way leads from or to a home that interferes.
std::string HomeWarning(const std::string& cell_file, const Interference& found);

/// Refuses a job whose cell no programs may be written for, or which lacks what they need. Throws InputError.
void CheckPrograms(const JobInputs& inputs);

}  // namespace millpose
