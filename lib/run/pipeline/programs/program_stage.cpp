// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/program_stage.hpp"

#include "base/parallel.hpp"
#include "job/narrow_inputs.hpp"
#include "planning/result/skipped.hpp"
#include "run/pipeline/programs/base_window.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "store/cached_stage.hpp"
#include "store/plan_key.hpp"

namespace millpose {
namespace {

/// Of one controller.
struct ControllerPrograms {
  CheckedProgram whole;
  std::vector<StartProgram> starts;  ///< none where the whole program is not confirmed
};

class ProgramStage {
 public:
  ProgramStage(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
               PlannedJob& job)
      : inputs_(inputs),
        checkpoints_(checkpoints),
        execution_(execution),
        job_(job),
        handed_(StageKey(KeyOf(job.plan, execution.Threads()), KeyOf(job.starts.ways.gaps),
                         job.prepared.made.holes_left_out, inputs.trajectory)) {}

  void Make() {
    if (inputs_.job.programs.empty() || !WhyNotProgrammable(job_.plan).empty()) return;
    const std::vector<std::string>& controllers = inputs_.job.programs;
    job_.programs.base_window = Window();
    std::vector<ControllerPrograms> made(controllers.size());
    // What a program is checked by takes as much memory as the plan.
    constexpr size_t kMany = 200000;  // points
    const int at_once = CountPoints(job_.plan) > kMany ? 1 : execution_.Threads();
    ParallelFor(made.size(), at_once, execution_.stop, [&](size_t i) { made[i] = Of(controllers[i]); });
    for (size_t i = 0; i < made.size(); ++i) {
      if (made[i].whole.Confirmed()) job_.starts.programs[controllers[i]] = std::move(made[i].starts);
      job_.programs.programs.push_back(std::move(made[i].whole));
    }
  }

 private:
  std::optional<BaseWindow> Window() const {
    const JobInputs own = InputsOfProgram(inputs_, inputs_.job.programs.front());
    const std::string key = StageKey(handed_, job_.prepared.cell, own.hash);
    return Cached<std::optional<BaseWindow>>(checkpoints_, "base-window", key, [&] {
      return FindBaseWindow(job_.plan, own, job_.prepared.cell, execution_);
    });
  }

  /// The head names all that a program is made from, also what stands in the cell and makes no difference.
  ControllerPrograms Of(const std::string& controller) const {
    const JobInputs own = InputsOfProgram(inputs_, controller), handed = WithoutPlaces(own);
    ControllerPrograms programs = CachedInWorld<ControllerPrograms>(
        checkpoints_, "programs-" + controller, KeyOfPrograms(handed), job_.prepared.stations,
        [&](const Stations& stations) { return MakeIn(stations.world(), handed, controller); });
    NameInputs(handed.hash, own.hash, programs.whole.files);
    for (StartProgram& start : programs.starts) NameInputs(handed.hash, own.hash, start.files);
    return programs;
  }

  std::string KeyOfPrograms(const JobInputs& handed) const {
    // Ways to the change of one tool for another are planned in a world that nobody watches.
    const bool unwatched = handed.cell.tools.size() > 1;
    // What reading the cell's URDF said stands in the program's head and not in the resolved cell.
    return StageKey(handed_, handed.hash, job_.programs.base_window, CellWarnings(handed.cell),
                    unwatched ? ObstaclesOf(job_.prepared.cell) : Obstacles{});
  }

  ControllerPrograms MakeIn(const World& world, const JobInputs& handed,
                            const std::string& controller) const {
    const std::vector<std::string>& not_machined = job_.prepared.made.holes_left_out;
    ControllerPrograms made;
    const Programming with(handed, controller, world, execution_);
    const std::string stage = "runs-" + controller;
    // Where obstacles stand is no part of it: a comparison with the plan asks for the arm alone.
    const std::string key =
        StageKey(std::string("runs"), WithoutPlaces(world.cell()), ConfirmedRuns::ContextOf(with.options));
    checkpoints_.ReadStage(stage, key, [&](const std::string& bytes) {
      ConfirmedRuns::Proofs known;
      if (!ValueReader(bytes).Read(known)) return false;
      with.confirmed->Know(std::move(known));
      return true;
    });
    made.whole = MakeProgram(job_.plan, not_machined, job_.programs.base_window, with);
    if (made.whole.Confirmed())
      made.starts = MakeStartPrograms(job_.plan, job_.starts.ways, not_machined, with);
    if (with.confirmed->added() > 0)
      checkpoints_.WriteStage(stage, key, ValueBytes().Add(with.confirmed->Used()).bytes());
    return made;
  }

  const JobInputs& inputs_;
  const CheckpointStore& checkpoints_;
  const Execution& execution_;
  PlannedJob& job_;
  const std::string handed_;  ///< hash of what all controllers are handed
};

}  // namespace

void MakeJobPrograms(const JobInputs& inputs, const CheckpointStore& checkpoints, const Execution& execution,
                     PlannedJob& job) {
  execution.progress.Begin("programs", 0);
  ProgramStage(inputs, checkpoints, execution, job).Make();
  execution.progress.End(fmt::format("{} programs", job.programs.programs.size()));
}

}  // namespace millpose
