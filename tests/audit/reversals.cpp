// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/reversals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "tests/audit/kinematics.hpp"

namespace millpose::audit {
namespace {

constexpr Real kArcminute = kDegree / 60;
constexpr Real kStep = 1e-5L;  // rad or mm, of central differences

Real DeadZone(const Folder& folder, size_t gear) {
  return gear >= 6 && !folder.setup.axes[gear - 6].rotary ? 0.01L : 0.005L * kDegree;
}

/// Indices of the ends of a way and of all places between at which it turns, plateaus by their first place.
std::vector<size_t> Extremes(const std::vector<Real>& way) {
  std::vector<size_t> extremes;
  for (size_t i = 0; i < way.size(); ++i) {
    if (!extremes.empty() && way[i] == way[extremes.back()]) continue;
    const size_t n = extremes.size();
    if (n >= 2 && (way[i] > way[extremes[n - 1]]) == (way[extremes[n - 1]] > way[extremes[n - 2]]))
      extremes.back() = i;
    else
      extremes.push_back(i);
  }
  return extremes;
}

/// The extremes that are left when every swing within the dead zone is struck out, the least first.
std::vector<size_t> Swings(const std::vector<Real>& way, Real dead_zone) {
  std::vector<size_t> left = Extremes(way);
  while (left.size() > 1) {
    size_t least = 0;
    const auto swing = [&](size_t i) { return std::abs(way[left[i + 1]] - way[left[i]]); };
    for (size_t i = 1; i + 1 < left.size(); ++i)
      if (swing(i) < swing(least)) least = i;
    if (swing(least) > dead_zone) break;
    const auto at = [&](size_t i) { return left.begin() + static_cast<std::ptrdiff_t>(i); };
    if (least == 0)
      left.erase(left.begin());
    else if (least + 2 == left.size())
      left.pop_back();
    else
      left.erase(at(least), at(least + 2));
  }
  return left;
}

/// The rows of one piece in their order; a closed one ends with its first again.
using CutPiece = std::vector<const Row*>;

std::vector<CutPiece> CutPieces(const Folder& folder) {
  std::vector<CutPiece> pieces;
  const Row* before = nullptr;
  for (const Row& row : folder.rows) {
    if (!row.planned) continue;
    if (!before || before->pass != row.pass || before->piece != row.piece) pieces.emplace_back();
    pieces.back().push_back(&row);
    before = &row;
  }
  for (CutPiece& piece : pieces)
    if (piece.front()->closed) piece.push_back(piece.front());
  return pieces;
}

/// Angles at the gears, and external axes, along a piece.
std::vector<std::vector<Real>> GearWays(const Folder& folder, const CutPiece& piece) {
  std::vector<std::vector<Real>> ways(6 + folder.setup.axes.size());
  Angles near = piece.front()->angles;
  for (const Row* row : piece) {
    near = TurnedNear(row->angles, near);
    for (size_t gear = 0; gear < 6; ++gear) {
      Real angle = 0;
      for (size_t axis = 0; axis < 6; ++axis) angle += folder.gears.couplings[gear][axis] * near[axis];
      ways[gear].push_back(angle);
    }
    for (size_t i = 0; i < folder.setup.axes.size(); ++i) ways[6 + i].push_back(row->external[i]);
  }
  return ways;
}

/// How far the tip goes on the part along the normal when a gear alone turns, mm per rad or mm.
Real Lever(const Folder& folder, const Row& row, size_t gear) {
  const auto tip = [&](Real by) -> Vector3 {
    Angles angles = row.angles;
    std::vector<Real> external = row.external;
    if (gear >= 6)
      external[gear - 6] += by;
    else  // the other gears stand: their axes follow
      for (size_t axis = 0; axis < 6; ++axis) angles[axis] += by * folder.gears.axes_by_gear[axis][gear];
    return ToolOnPart(folder.setup, angles, external).block<3, 1>(0, 3);
  };
  const Matrix3 R_WP = folder.At(row.external).X_WP.block<3, 3>(0, 0);
  return (R_WP.transpose() * row.normal).dot(tip(kStep) - tip(-kStep)) / (2 * kStep);
}

/// Whether all of a row's pass stands on one line along the tool.
bool IsDrilled(const Folder& folder, const Row& row) {
  Real longest = 0;
  for (const Row& other : folder.rows) {
    if (other.pass != row.pass) continue;
    const Vector3 way = other.position - row.position;
    if (way.cross(row.axis).norm() > 1e-3L) return false;
    longest = std::max(longest, way.norm());
  }
  return longest > 0.1L;
}

bool OfFace(const Folder& folder, const Row& row) {
  const int passes = folder.rows.back().pass + 1;
  const int from = passes - passes / static_cast<int>(folder.goal.layers.size());
  if (!row.cut || row.pass < from || IsDrilled(folder, row)) return false;
  const auto deflected = folder.deflected.find(row.point);
  return deflected == folder.deflected.end() || !deflected->second.air || folder.all_air;
}

void AuditPiece(const Folder& folder, const CutPiece& piece, const ReversalFindings& findings,
                std::set<std::pair<int, size_t>>& found) {
  const Gears& gears = folder.gears;
  const std::vector<std::vector<Real>> ways = GearWays(folder, piece);
  std::vector<Real> errors(piece.size(), 0);
  std::vector<std::vector<Real>> levers(piece.size(), std::vector<Real>(ways.size()));
  for (size_t t = 0; t < piece.size(); ++t)
    for (size_t gear = 0; gear < ways.size(); ++gear) levers[t][gear] = Lever(folder, *piece[t], gear);
  for (size_t gear = 0; gear < ways.size(); ++gear) {
    const Real dead_zone = DeadZone(folder, gear);
    const bool linear = gear >= 6 && !folder.setup.axes[gear - 6].rotary;
    const Real unit = gears.width[gear].value_or(linear ? 1e-3L : kArcminute);
    for (const size_t place : TurningPlaces(ways[gear], dead_zone)) {
      const Row& row = *piece[place];
      if (!OfFace(folder, row)) continue;
      found.emplace(row.point, gear);
      const std::string where = fmt::format("gear {} at point {}", gear + 1, row.point);
      if (gear >= row.marks.size() || !row.marks[gear])
        findings.count(where);
      else if (!gears.loaded)
        findings.mark(std::abs(*row.marks[gear] - unit * std::abs(levers[place][gear])), where);
    }
    const std::vector<Real> lag = Lag(ways[gear], gears.width[gear].value_or(0), dead_zone);
    for (size_t t = 0; t < piece.size(); ++t) errors[t] += levers[t][gear] * lag[t];
  }
  const bool known = std::ranges::any_of(gears.width, [](const auto& width) { return width.has_value(); });
  for (size_t t = 0; t < piece.size() && known && !gears.loaded; ++t) {
    const Row& row = *piece[t];
    if (t > 0 && &row == piece.front()) continue;
    const std::string where = fmt::format("lost motion at point {}", row.point);
    if (OfFace(folder, row) != row.lost_motion.has_value())
      findings.count(where);
    else if (row.lost_motion)
      findings.mark(std::abs(*row.lost_motion - errors[t]), where);
  }
}

}  // namespace

std::vector<size_t> TurningPlaces(const std::vector<Real>& way, Real dead_zone) {
  std::vector<size_t> places = Swings(way, dead_zone);
  if (places.size() < 3) return {};
  return {places.begin() + 1, places.end() - 1};
}

std::vector<Real> Lag(const std::vector<Real>& way, Real width, Real dead_zone) {
  if (way.empty()) return {};
  const std::vector<size_t> swings = Swings(way, dead_zone);
  const bool down = swings.size() > 1 && way[swings[1]] < way[swings[0]];
  std::vector<Real> lag;
  Real output = way.front() + (down ? width / 2 : -width / 2);
  for (const Real input : way) {
    output = std::max(input - width / 2, std::min(output, input + width / 2));
    lag.push_back(output - input);
  }
  return lag;
}

void AuditReversals(const Folder& folder, const ReversalFindings& findings) {
  if (!folder.reversals) return;
  std::set<std::pair<int, size_t>> found;
  for (const CutPiece& piece : CutPieces(folder)) AuditPiece(folder, piece, findings, found);
  std::map<std::pair<int, size_t>, int> counts;  // by pass
  for (const Row& row : folder.rows)
    for (size_t gear = 0; gear < row.marks.size(); ++gear) {
      const bool turns = found.contains({row.point, gear});
      if (row.marks[gear] && !turns && !folder.gears.loaded)
        findings.count(fmt::format("gear {} at point {}, stated", gear + 1, row.point));
      if (turns) ++counts[{row.pass, gear}];
    }
  if (counts != *folder.reversals) findings.count("counts of summary.json");
}

}  // namespace millpose::audit
