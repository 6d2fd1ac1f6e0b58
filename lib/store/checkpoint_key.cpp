// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/checkpoint_key.hpp"

#include "base/process.hpp"
#include "base/value_bytes.hpp"
#include "planning/result/pass_value.hpp"
#include "store/cached_pass.hpp"

namespace millpose {
void AppendTo(ValueBytes& bytes, const Freedom& freedom) {
  bytes.Add(freedom.Name(), freedom.Lower(), freedom.Upper(), freedom.Periodic(), freedom.Step(),
            freedom.Nominal(), freedom.Parameters());
}

void AppendTo(ValueBytes& bytes, const Objective& objective) {
  bytes.Add(objective.Name(), objective.parameters());
}

/// Its mesh and place are the cell's workpiece, which is part of every key.
void AppendTo(ValueBytes& bytes, const LeanSurface& surface) { bytes.Add(surface.tolerance()); }

std::string PassContext(const PoseProblem& problem, const World& world, const PathOptions& options) {
  return HashOfValues(ProgramId(), problem, WithoutPlaces(world.cell()), options);
}

std::string CoordinatedContext(const PoseProblem& problem, const World& at_zero, const PathOptions& options) {
  return HashOfValues(ProgramId(), problem, at_zero.cell(), options);
}

std::string CoordinatedKey(const std::string& context, const ExternalCourse& course) {
  return HashOfValues(std::string("riding"), context, course.from, course.to);
}

std::string LinkMoveContext(const World& world, const LinkMoveOptions& options) {
  const Cell& cell = world.cell();
  return HashOfValues(ProgramId(), cell.external_axes.empty() ? WithoutPlaces(cell) : cell, options);
}

std::string PassKey(const std::string& context, const Pass& pass, size_t number, size_t first_point) {
  return HashOfValues(std::string("pass"), context, pass, number, first_point);
}

std::string LinkMoveKey(const std::string& context, const LinkMoveEnd& from, const LinkMoveEnd& to) {
  return HashOfValues(std::string("gap"), context, from, to);
}

bool IsPlanOf(const PassResult& plan, const Pass& pass, size_t number) {
  return plan.pass == static_cast<int>(number) && PlacesOf(plan, pass).size() == pass.points.size() &&
         plan.rotation_reference == pass.rotation_reference;
}

bool IsLinkMoveOf(const LinkMove& gap, const LinkMoveEnd& from, const LinkMoveEnd& to) {
  return gap.from_pass == from.pass && gap.from_piece == from.piece && gap.to_pass == to.pass &&
         gap.to_piece == to.piece;
}

}  // namespace millpose
