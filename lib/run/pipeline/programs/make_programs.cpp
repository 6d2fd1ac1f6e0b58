// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/make_programs.hpp"

#include <cassert>

#include "base/error.hpp"
#include "job/cell_texts.hpp"
#include "planning/result/skipped.hpp"
#include "program/external_axes.hpp"
#include "program/verify/causes.hpp"
#include "run/pipeline/programs/check_program.hpp"
#include "run/pipeline/programs/program_motions.hpp"
#include "run/pipeline/programs/program_warnings.hpp"

namespace millpose {

void CompleteFrames(MotionProgram& program, const MotionProgram& planned) {
  if (!program.X_BP) program.X_BP = planned.X_BP;
  if (!program.X_FT) program.X_FT = planned.X_FT;
}

void NameInputs(const std::string& hash, MotionProgram& program) {
  for (auto& [key, value] : program.header)
    if (key == "inputs") value = hash;
}

namespace {

/// The places of the characters of `word` from `at` on, where it stands there: in one piece, or broken where
/// a remark ends (LS: " ;\n  12:  !:"); empty where it does not.
std::vector<size_t> PlacesOf(const std::string& word, const std::string& text, size_t at) {
  constexpr size_t kLongestBreak = 16;
  std::vector<size_t> places;
  for (const char c : word) {
    if (text[at] != c && text.compare(at, 3, " ;\n") == 0) {
      const size_t next = text.find("!:", at);
      if (next == std::string::npos || next - at > kLongestBreak) return {};
      at = next + 2;
    }
    if (at >= text.size() || text[at] != c) return {};
    places.push_back(at++);
  }
  return places;
}

}  // namespace

void NameInputs(const std::string& earlier, const std::string& hash, ProgramFiles& files) {
  assert(earlier.size() == hash.size());
  const std::string key = "inputs:", begin = earlier.substr(0, 8);
  for (auto& [name, text] : files)
    for (size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + key.size())) {
      const size_t first = text.find(begin, at);
      if (first == std::string::npos || first - at > 32) continue;
      const std::vector<size_t> places = PlacesOf(earlier, text, first);
      for (size_t i = 0; i < places.size(); ++i) text[places[i]] = hash[i];
    }
}

std::optional<CornerBound> StateCornerBound(const Cell& cell, MotionProgram& program) {
  std::optional<CornerBound> bound = FindCornerBound(program, cell);
  if (bound) program.header.emplace_back("verdict", "confirmed but for a stated gap: " + Describe(*bound));
  return bound;
}

std::string CheckedProgram::WhyWithheld() const {
  if (Confirmed()) return {};
  std::vector<std::string> causes;
  for (const CauseGroup& group : GroupByCause(findings)) causes.push_back(Describe(group));
  return fmt::format("no {} program is written, its read-back does not confirm it: {}", controller,
                     fmt::join(causes, ", "));
}

namespace {

/// How many points no motion cuts, by reason; empty where all are cut.
std::string WhatIsLeftOut(const PlanResult& plan) {
  const std::map<std::string, size_t> skipped = SkippedByReason(plan);
  if (skipped.empty()) return {};
  std::vector<std::string> reasons;
  for (const auto& [reason, count] : skipped) reasons.push_back(fmt::format("{} {}", count, reason));
  return fmt::format("of {} points are not cut: {}", CountPoints(plan), fmt::join(reasons, ", "));
}

}  // namespace

CheckedProgram MakeProgram(const PlanResult& plan, const std::vector<std::string>& not_machined,
                           const std::optional<BaseWindow>& window, const Programming& with) {
  const JobInputs& inputs = with.inputs;
  const std::string& controller = with.controller;
  const Post& post = with.post;
  CheckedProgram program;
  program.controller = controller;
  std::vector<CallTransition> calls;
  try {
    calls = PlanCallTransitions(with.world, inputs, controller, with.execution.stop);
  } catch (const InputError& error) {
    program.findings.push_back({"", 0, error.problems().front().message, Cause::kText});
    return program;
  }
  ProgramMotions motions = MakeProgramMotions(plan, inputs, controller, window, calls);
  NameInputs(inputs.hash, motions.written);
  motions.written.header.emplace_back("cycle_time", TimeText(motions.time.all) + " h:min:s, as replayed");
  for (const std::string& hole : not_machined) motions.written.header.emplace_back("NOT MACHINED", hole);
  if (const std::string left_out = WhatIsLeftOut(plan); !left_out.empty())
    motions.written.header.emplace_back("INCOMPLETE", left_out);
  StateCornerBound(with.world.cell(), motions.written);
  program.saved = motions.saved;
  program.near = motions.near;
  program.warnings = motions.warnings;
  program.time = motions.time;
  if (inputs.trajectory)
    program.trajectory = TrajectoryCsv(motions.written, plan.arm, plan.X_WB, ExternalColumns(with.settings),
                                       post.Times(), *inputs.trajectory);
  program.files = post.Write(motions.written, plan.arm, with.settings);
  // In the air nobody needs more than the feed of the cut.
  const double wanted = inputs.cell.air_feed && inputs.job.workpiece.HasStock() ? inputs.job.feed : 0;
  program.speed = EstimatePathSpeed(motions.written, controller, post.Dynamics(with.settings), wanted);
  for (const std::string& warning :
       {SpeedWarning(*program.speed), MemoryWarning(program.files, post.Memory())})
    if (!warning.empty()) program.warnings.push_back(warning);
  for (const Motion& motion : motions.written.motions) program.pass_of_motion.push_back(motion.pass);
  motions.written = {};  // of a large plan as large as what is read back
  try {
    MotionProgram back = post.Read(program.files, plan.arm, with.settings);
    CompleteFrames(back, motions.planned);
    ProgramCheck check = CheckProgram(back, motions, plan, with);
    program.findings = std::move(check.findings);
    program.under_load = check.under_load;
    program.but_for = check.but_for;
  } catch (const InputError& error) {  // our own program must be readable: a finding, not the user's mistake
    for (const Problem& problem : error.problems())
      program.findings.push_back({problem.place.file, problem.place.line, problem.message, Cause::kText});
  }
  return program;
}

}  // namespace millpose
