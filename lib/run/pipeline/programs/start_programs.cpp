// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/start_programs.hpp"

#include <cassert>

#include "base/error.hpp"
#include "job/cell_texts.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/result/station.hpp"
#include "program/program_name.hpp"
#include "run/pipeline/programs/check_program.hpp"
#include "run/pipeline/programs/make_programs.hpp"
#include "run/pipeline/programs/program_motions.hpp"

namespace millpose {
namespace {

/// The move that brings the external axes home again from where a piece leaves them.
std::optional<ExternalMove> HomeFrom(const PlanResult& plan, const ExternalPosition& from, size_t at,
                                     double duration) {
  const ExternalPosition home = Mechanism(plan.external_axes).Home();
  if (from == home) return std::nullopt;
  return ExternalMove{from, home, static_cast<int>(at), duration};
}

/// Where the piece that `in` leads to leaves the external axes.
const ExternalPosition& LeftAt(const PlanResult& plan, const LinkMove& in) {
  const PassResult& pass = plan.passes[static_cast<size_t>(in.to_pass)];
  const auto piece = std::ranges::find(pass.pieces, in.to_piece, &Segment::piece);
  assert(piece != pass.pieces.end());
  return ExternalAt(pass, static_cast<size_t>(piece->closed ? piece->first : piece->last));
}

/// Home from a piece that is reached by `in`: where the way on goes by home, there; else on to the next one's
/// entry, and back along that one's way from home.
LinkMove WayHome(LinkMove out, const LinkMove& next, const LinkMove& in, const PlanResult& plan) {
  if (out.planned && out.external) {
    out.joints.resize(static_cast<size_t>(out.external->at) + 1);
  } else {
    if (!next.planned) out.detail = next.detail;
    out.planned = out.planned && next.planned;
    if (out.planned) out.joints.insert(out.joints.end(), std::next(next.joints.rbegin()), next.joints.rend());
    out.clearance_share = std::min(out.clearance_share, next.clearance_share);
  }
  const double duration = in.external ? in.external->duration : 0;
  out.external =
      out.planned ? HomeFrom(plan, LeftAt(plan, in), out.joints.size() - 1, duration) : std::nullopt;
  out.to_pass = out.to_piece = -1;
  return out;
}

std::vector<Finding> ReadBack(const ProgramFiles& files, const ProgramMotions& motions,
                              const PlanResult& single, Programming with) {
  // The ways of starts lead to the nominal poses: to commanded ones nothing has looked at them yet.
  // Nor at the move of external axes from where a cut along which they move has left them.
  with.options.interference |= HasCommanded(single) || MovesAlong(single);
  try {
    MotionProgram back = with.post.Read(files, with.world.cell().arm, with.settings);
    CompleteFrames(back, motions.planned);
    return CheckProgram(back, motions, single, with).findings;
  } catch (const InputError& error) {
    std::vector<Finding> findings;
    for (const Problem& problem : error.problems())
      findings.push_back({problem.place.file, problem.place.line, problem.message, Cause::kText});
    return findings;
  }
}

}  // namespace

std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> StartEnds(
    const std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>>& gaps) {
  std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> starts;
  for (size_t i = 1; i + 1 < gaps.size(); ++i) starts.emplace_back(gaps.front().first, gaps[i].second);
  return starts;
}

PlanResult SingleStart(const PlanResult& plan, const PlanResult& ways, size_t index) {
  assert(index + 1 < plan.gaps.size() && ways.gaps.size() + 2 == plan.gaps.size());
  const LinkMove& in = index == 0 ? plan.gaps[0] : ways.gaps[index - 1];
  const LinkMove& out = plan.gaps[index + 1];
  PlanResult single;
  single.job = StartName(plan.job, in.to_pass, in.to_piece);
  single.cell = plan.cell;
  single.input_hash = plan.input_hash;
  single.seed = plan.seed;
  single.arm = plan.arm;
  single.external_axes = plan.external_axes;
  single.X_WB = plan.X_WB;
  single.X_FT = plan.X_FT;
  single.X_WP = plan.X_WP;
  single.home = plan.home;
  single.spindle_speed = plan.spindle_speed;
  single.gaps = {in, out.to_pass < 0 ? out : WayHome(out, ways.gaps[index], in, plan)};
  single.passes.resize(plan.passes.size());
  single.passes[in.to_pass] = plan.passes[in.to_pass];
  return single;
}

std::vector<StartProgram> MakeStartPrograms(const PlanResult& plan, const PlanResult& ways,
                                            const std::vector<std::string>& not_machined,
                                            const Programming& with) {
  std::vector<StartProgram> starts;
  if (ways.gaps.empty()) return starts;
  const std::vector<CallTransition> calls =
      PlanCallTransitions(with.world, with.inputs, with.controller, with.execution.stop);
  for (size_t i = 0; i + 1 < plan.gaps.size(); ++i) {
    const PlanResult single = SingleStart(plan, ways, i);
    StartProgram& start = starts.emplace_back();
    start.pass = single.gaps[0].to_pass;
    start.piece = single.gaps[0].to_piece;
    start.name = single.job;
    start.obstacle = WhyNotProgrammable(single);
    if (!start.obstacle.empty()) continue;
    ProgramMotions motions = MakeProgramMotions(single, with.inputs, with.controller, {}, calls);
    NameInputs(with.inputs.hash, motions.written);
    motions.written.header.emplace_back("cycle_time", TimeText(motions.time.all) + " h:min:s, as replayed");
    for (const std::string& hole : not_machined) motions.written.header.emplace_back("NOT MACHINED", hole);
    StateCornerBound(with.world.cell(), motions.written);
    start.files = with.post.Write(motions.written, single.arm, with.settings);
    start.findings = ReadBack(start.files, motions, single, with);
  }
  return starts;
}

}  // namespace millpose
