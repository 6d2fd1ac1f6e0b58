// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/path_section.hpp"

#include <algorithm>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

// Parameters at which a piece passes the plane direction · p = level.
void AddCrossings(const CurvePiece& piece, const Eigen::Vector3d& direction, double level,
                  std::vector<double>& at) {
  if (!piece.arc) {
    const double from = direction.dot(piece.start), to = direction.dot(piece.end);
    if (from != to) at.push_back((level - from) / (to - from));
    return;
  }
  // direction · (centre + cos φ u + sin φ v) = middle + size · cos(φ − turned)
  const double along_u = direction.dot(piece.u), along_v = direction.dot(piece.v);
  const double size = std::sqrt(along_u * along_u + along_v * along_v);
  const double off = level - direction.dot(piece.centre);
  if (size <= std::abs(off)) return;
  const double turned = Atan2(along_v, along_u), half = Atan2(std::sqrt(size * size - off * off), off);
  const double first = std::min(piece.angle0, piece.angle1), last = std::max(piece.angle0, piece.angle1);
  for (double angle : {turned - half, turned + half}) {
    angle += 2 * kPi * std::ceil((first - angle) / (2 * kPi));
    for (; angle <= last; angle += 2 * kPi)
      at.push_back((angle - piece.angle0) / (piece.angle1 - piece.angle0));
  }
}

// The intervals of a piece that lie between the planes, ascending.
std::vector<std::pair<double, double>> Inside(const CurvePiece& piece, const PathSection& share) {
  std::vector<double> at{0, 1};
  for (const double level : {share.Least(), share.Most()})
    if (std::isfinite(level)) AddCrossings(piece, share.direction, level, at);
  std::erase_if(at, [](double t) { return !(t >= 0 && t <= 1); });
  std::ranges::sort(at);
  std::vector<std::pair<double, double>> intervals;
  for (size_t i = 0; i + 1 < at.size(); ++i) {
    if (at[i + 1] <= at[i]) continue;
    const double height = share.direction.dot(piece.At((at[i] + at[i + 1]) / 2));
    if (height < share.Least() || height > share.Most()) continue;
    if (!intervals.empty() && intervals.back().second == at[i])
      intervals.back().second = at[i + 1];
    else
      intervals.emplace_back(at[i], at[i + 1]);
  }
  return intervals;
}

double LengthOf(const Curve& curve) {
  double length = 0;
  for (const CurvePiece& piece : curve.pieces) length += piece.LengthBound(0, 1);
  return length;
}

}  // namespace

std::vector<Curve> ClipToSection(const Curve& curve, const PathSection& share, double least_length) {
  std::vector<Curve> parts;
  bool from_start = false, goes_on = false;  // the first part begins with the curve; the last goes on
  for (size_t i = 0; i < curve.pieces.size(); ++i) {
    const auto intervals = Inside(curve.pieces[i], share);
    if (intervals.empty()) goes_on = false;
    for (const auto& [t0, t1] : intervals) {
      if (i == 0 && t0 == 0) from_start = true;
      if (!goes_on || t0 > 0) parts.emplace_back();
      parts.back().pieces.push_back(curve.pieces[i].Part(t0, t1));
      goes_on = t1 == 1;
    }
  }
  if (curve.closed && from_start && goes_on) {
    if (parts.size() == 1) {
      parts.front().closed = true;
    } else {  // the last part runs over the start into the first
      std::ranges::move(parts.front().pieces, std::back_inserter(parts.back().pieces));
      parts.erase(parts.begin());
    }
  }
  std::erase_if(parts, [&](const Curve& part) { return LengthOf(part) <= least_length; });
  return parts;
}

std::pair<double, double> ExtentOf(const Curve& curve, const Eigen::Vector3d& direction) {
  std::pair<double, double> extent{std::numeric_limits<double>::infinity(),
                                   -std::numeric_limits<double>::infinity()};
  for (const CurvePiece& piece : curve.pieces)
    for (const double t : {0.0, 0.5, 1.0}) {
      const double at = direction.dot(piece.At(t));
      extent = {std::min(extent.first, at), std::max(extent.second, at)};
    }
  return extent;
}

}  // namespace millpose
