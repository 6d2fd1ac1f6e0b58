// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/motions.hpp"

#include <fmt/format.h>

#include "tests/audit/kinematics.hpp"

namespace millpose::audit {
namespace {

/// Whether the tool stands above the end of a cut on its own axis: on the way out of the material or into it.
bool IsAbove(const Matrix4& X, const Matrix4& end) {
  const Vector3 p = end.block<3, 3>(0, 0).transpose() * Vector3((X - end).block<3, 1>(0, 3));
  return p.head<2>().norm() < 0.05L && p.z() > -0.05L &&
         AngleBetween(Matrix3(X.block<3, 3>(0, 0)), Matrix3(end.block<3, 3>(0, 0))) < 0.05L * kDegree;
}

/// The straight way of the tool between two poses of the arm that are near each other, as short joint
/// motions.
void AddStraight(const Setup& setup, const Angles& from, const Angles& to, const std::string& name,
                 std::vector<JointMotion>& motions) {
  constexpr Real kStep = 2;  // mm
  const Matrix4 X0 = Tool(setup, from), X1 = Tool(setup, to);
  const int steps = std::max(1, static_cast<int>(std::ceil((X1 - X0).block<3, 1>(0, 3).norm() / kStep)));
  Angles last = from;
  for (int k = 1; k <= steps; ++k) {
    Matrix4 X = X0;
    X.block<3, 1>(0, 3) += (X1 - X0).block<3, 1>(0, 3) * k / steps;
    const Angles next = k == steps ? to : Solve(setup, X, last);
    motions.push_back({last, next, true, name});
    last = next;
  }
}

}  // namespace

std::vector<JointMotion> CutMotions(const std::vector<Cut>& cuts) {
  std::vector<JointMotion> motions;
  for (const Cut& cut : cuts)
    for (size_t k = 1; k < cut.rows.size() + (cut.closed ? 1 : 0); ++k) {
      const Row &from = *cut.rows[k - 1], &to = *cut.rows[k % cut.rows.size()];
      motions.push_back(
          {from.angles, to.angles, true, fmt::format("point {} to {}", from.point, to.point), from.external});
      if (to.external != from.external) motions.back().move_to = to.external;
    }
  return motions;
}

std::vector<JointMotion> LinkMotions(const std::vector<Target>& targets, const std::vector<Cut>& cuts) {
  std::vector<JointMotion> motions;
  size_t begin = 0;
  for (size_t c = 0; c <= cuts.size(); ++c) {
    const size_t end = c < cuts.size() ? cuts[c].first : targets.size() - 1;
    size_t retracted = begin, approach = end;
    if (c > 0)
      while (retracted < end && IsAbove(targets[retracted + 1].X_PT, targets[begin].X_PT)) ++retracted;
    if (c < cuts.size())
      while (approach > retracted && IsAbove(targets[approach - 1].X_PT, targets[end].X_PT)) --approach;
    for (size_t j = begin; j < end; ++j) {
      motions.push_back({*targets[j].angles, *targets[j + 1].angles, j < retracted || j >= approach,
                         targets[j + 1].file + ":" + std::to_string(targets[j + 1].line),
                         targets[j].external});
      if (targets[j + 1].external != targets[j].external) motions.back().move_to = targets[j + 1].external;
    }
    if (c < cuts.size()) begin = cuts[c].last;
  }
  return motions;
}

std::vector<JointMotion> PlannedLinkMotions(const Folder& folder, const std::vector<Cut>& cuts) {
  const auto find = [&](int pass, int piece) -> const Cut* {
    for (const Cut& cut : cuts)
      if (cut.rows[0]->pass == pass && cut.rows[0]->piece == piece) return &cut;
    return nullptr;
  };
  std::vector<JointMotion> motions;
  for (const PlannedLinkMove& gap : folder.gaps) {
    if (gap.joints.empty()) continue;
    const Cut *leaves = find(gap.from_pass, gap.from_piece), *enters = find(gap.to_pass, gap.to_piece);
    std::vector<Real> here;
    // Cuts have the positions of points.csv, which folder.At() knows.
    if (leaves)
      here = leaves->rows.back()->external;
    else if (gap.move)
      here = gap.move->from;
    else if (enters)
      here = enters->rows.front()->external;
    const std::string name = fmt::format("gap from pass {} piece {} to pass {} piece {}", gap.from_pass,
                                         gap.from_piece, gap.to_pass, gap.to_piece);
    const auto straight = [&](const Angles& from, const Angles& to) {
      const size_t before = motions.size();
      AddStraight(folder.At(here), from, to, name, motions);
      for (size_t k = before; k < motions.size(); ++k) motions[k].external = here;
    };
    const auto move = [&](size_t at) {
      if (!gap.move || gap.move->at != at) return;
      motions.push_back({gap.joints[at], gap.joints[at], false, name, here, gap.move->to});
      here = gap.move->to;
    };
    if (leaves) {
      const Angles& last = leaves->rows.back()->angles;
      straight(leaves->closed ? TurnedNear(leaves->rows.front()->angles, last) : last, gap.joints.front());
    }
    move(0);
    for (size_t k = 1; k < gap.joints.size(); ++k) {
      motions.push_back({gap.joints[k - 1], gap.joints[k], false, name, here});
      move(k);
    }
    if (!enters) continue;
    here = enters->rows.front()->external;
    straight(gap.joints.back(), enters->rows.front()->angles);
  }
  return motions;
}

}  // namespace millpose::audit
