// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/program_stage.hpp"

#include "base/parallel.hpp"
#include "pipeline/base_window.hpp"
#include "pipeline/kept_stage.hpp"
#include "pipeline/narrow_inputs.hpp"
#include "pipeline/plan_job.hpp"
#include "pipeline/plan_key.hpp"

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
        handed_(StageKey(KeyOf(job.plan, execution.Threads()), job.starts.ways.gaps, job.prepared.cell,
                         job.prepared.made.holes_left_out, inputs.trajectory)) {}

  void Make() {
    if (inputs_.job.programs.empty() || !WhyNotProgrammable(job_.plan).empty()) return;
    const std::vector<std::string>& controllers = inputs_.job.programs;
    job_.programs.base_window = Window();
    std::vector<ControllerPrograms> made(controllers.size());
    ParallelFor(made.size(), execution_.Threads(), execution_.stop,
                [&](size_t i) { made[i] = Of(controllers[i]); });
    for (size_t i = 0; i < made.size(); ++i) {
      if (made[i].whole.Confirmed()) job_.starts.programs[controllers[i]] = std::move(made[i].starts);
      job_.programs.programs.push_back(std::move(made[i].whole));
    }
  }

 private:
  std::optional<BaseWindow> Window() const {
    const JobInputs own = InputsOfProgram(inputs_, inputs_.job.programs.front());
    return Kept<std::optional<BaseWindow>>(checkpoints_, "base-window", StageKey(handed_, own.hash), [&] {
      return FindBaseWindow(job_.plan, own, job_.prepared.cell, execution_.Threads(), execution_.stop);
    });
  }

  ControllerPrograms Of(const std::string& controller) const {
    const JobInputs own = InputsOfProgram(inputs_, controller);
    const std::optional<BaseWindow>& window = job_.programs.base_window;
    // What reading the cell's URDF said stands in the program's head and not in the resolved cell.
    const std::string key = StageKey(handed_, own.hash, window, CellWarnings(own.cell));
    return Kept<ControllerPrograms>(checkpoints_, "programs-" + controller, key, [&] {
      const std::vector<std::string>& not_machined = job_.prepared.made.holes_left_out;
      ControllerPrograms made;
      made.whole = MakeProgram(job_.plan, own, not_machined, job_.prepared.world, window,
                               execution_.Threads(), execution_.stop);
      if (made.whole.Confirmed())
        made.starts = MakeStartPrograms(job_.plan, job_.starts.ways, own, not_machined, controller,
                                        job_.prepared.world, execution_.Threads(), execution_.stop);
      return made;
    });
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
