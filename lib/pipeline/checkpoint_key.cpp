// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/checkpoint_key.hpp"

#include "base/hash.hpp"
#include "base/process.hpp"
#include "pipeline/value_bytes.hpp"

namespace millpose {
namespace {

bool IsSamePlace(const MillingPoint& a, const MillingPoint& b) {
  return a.position == b.position && a.normal == b.normal && a.tool_axis == b.tool_axis;
}

}  // namespace

void AppendTo(ValueBytes& bytes, const Freedom& freedom) {
  bytes.Add(freedom.Name(), freedom.Lower(), freedom.Upper(), freedom.Periodic());
}

void AppendTo(ValueBytes& bytes, const Objective& objective) {
  bytes.Add(objective.Name(), objective.parameters());
}

std::string PassContext(const PoseProblem& problem, const World& world, const PathOptions& options) {
  return Hash(ValueBytes().Add(ProgramId(), problem, world.cell(), options).bytes());
}

std::string GapContext(const World& world, const GapOptions& options) {
  return Hash(ValueBytes().Add(ProgramId(), world.cell(), options).bytes());
}

std::string PassKey(const std::string& context, const Pass& pass, size_t number, size_t first_point) {
  return Hash(ValueBytes().Add(std::string("pass"), context, pass, number, first_point).bytes());
}

std::string GapKey(const std::string& context, const GapEnd& from, const GapEnd& to) {
  return Hash(ValueBytes().Add(std::string("gap"), context, from, to).bytes());
}

bool IsPlanOf(const PassResult& plan, const Pass& pass, size_t number) {
  const size_t count = pass.points.size();
  if (plan.opened_at >= static_cast<int>(count)) return false;
  const auto first = static_cast<size_t>(std::max(0, plan.opened_at));  // of a ring left open
  size_t found = 0;
  for (const PlannedPoint& planned : plan.points)
    if (found < count && IsSamePlace(planned.point, pass.points[(first + found) % count])) ++found;
  return plan.pass == static_cast<int>(number) && found == count &&
         plan.rotation_reference == pass.rotation_reference;
}

bool IsGapOf(const Gap& gap, const GapEnd& from, const GapEnd& to) {
  return gap.from_pass == from.pass && gap.from_piece == from.piece && gap.to_pass == to.pass &&
         gap.to_piece == to.piece;
}

}  // namespace millpose
