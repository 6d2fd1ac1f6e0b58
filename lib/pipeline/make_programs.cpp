// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/make_programs.hpp"

#include "base/error.hpp"
#include "pipeline/assemble.hpp"

namespace millpose {

std::vector<CheckedProgram> MakePrograms(const PlanResult& plan, const JobInputs& inputs, const World& world,
                                         int threads, std::stop_token stop) {
  if (!WhyNotProgrammable(plan).empty()) return {};
  const MotionProgram motions = MakeMotionProgram(plan);
  const VerifyOptions options = MakeVerifyOptions(inputs.job, plan.arm);
  std::vector<CheckedProgram> programs;
  for (const std::string& controller : inputs.job.programs) {
    const std::unique_ptr<Post> post = MakePost(controller);
    const PostSettings settings = MakePostSettings(inputs.job, inputs.cell, controller);
    CheckedProgram program;
    program.controller = controller;
    program.files = post->Write(motions, plan.arm, settings);
    for (const Motion& motion : motions.motions) program.pass_of_motion.push_back(motion.pass);
    try {
      const MotionProgram back = post->Read(program.files, plan.arm, settings);
      program.findings = Verify(back, world, &motions, options, threads, stop);
    } catch (
        const InputError& error) {  // our own program must be readable: a finding, not the user's mistake
      for (const Problem& problem : error.problems())
        program.findings.push_back({problem.place.file, problem.place.line, problem.message});
    }
    programs.push_back(std::move(program));
  }
  return programs;
}

}  // namespace millpose
