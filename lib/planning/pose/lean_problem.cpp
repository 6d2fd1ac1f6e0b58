// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/lean_problem.hpp"

#include <cassert>

#include "base/rotation.hpp"

namespace millpose {

bool HasLean(const PoseProblem& problem) {
  return std::any_of(problem.freedoms.begin(), problem.freedoms.end(),
                     [](const auto& freedom) { return freedom->IsLean(); });
}

PoseProblem AtOwnAxis(PoseProblem problem) {
  std::erase_if(problem.freedoms, [](const auto& freedom) { return freedom->IsLean(); });
  problem.lean.reset();
  return problem;
}

FreedomValues NominalFreedoms(const PoseProblem& problem, double rotation) {
  FreedomValues values;
  for (const auto& freedom : problem.freedoms) values.push_back(freedom->Nominal());
  values[0] = rotation;
  return values;
}

bool IsNominalLean(const PoseProblem& problem, const FreedomValues& freedoms) {
  for (size_t d = 1; d < freedoms.size(); ++d)
    if (freedoms[d] != problem.freedoms[d]->Nominal()) return false;
  return true;
}

CutterContact ContactOf(const PoseProblem& problem, const MillingPoint& point) {
  assert(problem.lean);
  const CutterShape& cutter = problem.lean->cutter;
  return {ContactAtTip(cutter, point.position, point.normal, point.tool_axis), point.normal, point.feed,
          cutter};
}

ToolStance StanceAt(const PoseProblem& problem, const CutterContact& contact,
                    std::span<const double> freedoms) {
  const LeanRules& rules = *problem.lean;
  const auto lean = [&](const ToolStance& from, const Eigen::Vector3d& about, double angle) -> ToolStance {
    const Eigen::Vector3d axis = RotationAbout(about, angle) * from.axis;
    return {TipAtContact(contact.cutter, contact.place, contact.normal, axis), axis};
  };
  ToolStance stance{contact.place, contact.normal};
  if (!rules.lead_free && rules.lead != 0)
    stance = lean(stance, contact.normal.cross(contact.feed), rules.lead);
  for (size_t d = 0; d < freedoms.size(); ++d)
    if (problem.freedoms[d]->IsLean()) stance = problem.freedoms[d]->Lean(contact, stance, freedoms[d]);
  if (!rules.tilt_free && rules.tilt != 0) stance = lean(stance, contact.feed, rules.tilt);
  return stance;
}

MillingPoint AtLean(const PoseProblem& problem, const MillingPoint& point, const FreedomValues& freedoms) {
  const ToolStance stance = StanceAt(problem, ContactOf(problem, point), freedoms);
  MillingPoint leaned = point;
  leaned.position = stance.tip;
  leaned.tool_axis = stance.axis;
  return leaned;
}

MillingPoint AtNominalLean(const PoseProblem& problem, const MillingPoint& point) {
  return AtLean(problem, point, NominalFreedoms(problem));
}

MillingPoint Upright(const PoseProblem& problem, const MillingPoint& point) {
  MillingPoint upright = point;
  upright.position = ContactOf(problem, point).place;
  upright.tool_axis = point.normal;
  return upright;
}

}  // namespace millpose
