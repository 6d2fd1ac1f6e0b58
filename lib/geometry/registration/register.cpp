// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/registration/register.hpp"

#include <algorithm>
#include <cmath>

#include "base/fisher.hpp"
#include "base/student.hpp"
#include "geometry/registration/place_fit.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kLevel = 0.01;          // of the F tests
constexpr int kPerUnknown = 3;           // equations
constexpr double kUnsureHeight = 2;      // deviations of one point
constexpr double kLeastVariance = 1e-4;  // of what is stated: less than a hundredth of it is rounding

bool Determined(const ProbedPart& part, const std::vector<ProbedPoint>& points, const Registration& found) {
  const int unknowns = 6 + static_cast<int>(found.bending->modes.size());
  if (!found.determined() || found.used < kPerUnknown * unknowns) return false;
  const double most = kUnsureHeight * std::ranges::max(points, {}, &ProbedPoint::sd).sd;
  return std::ranges::all_of(part.mesh().triangles().vertices,
                             [&](const Vector3d& p) { return found.HeightDeviation(p) <= most; });
}

/// A fit with the first `modes`.
FittedPlace FitBent(const ProbedPart& part, const std::vector<ProbedPoint>& points, const Registration& rigid,
                    size_t modes, int threads, const std::stop_token& stop) {
  PartBending frame = PlateFrame(part.mesh());
  frame.modes.assign(modes, 0);
  return FitPlace(part, points, rigid.X, &frame, threads, stop);
}

/// Probability that chance lowers the squares by as much when modes are added that are none.
double ByChance(const FittedPlace& fit, size_t fewer, size_t more) {
  const double n = static_cast<double>(more - fewer);
  const double freedom = fit.found.used - 6 - static_cast<double>(more);
  const double variance = std::max(fit.squares[more] / freedom, kLeastVariance);
  return FisherTail((fit.squares[fewer] - fit.squares[more]) / (n * variance), n, freedom);
}

/// How many of the fit's modes are asked for, and how likely the first of these are by chance.
std::pair<size_t, double> AskedFor(const FittedPlace& fit) {
  const size_t most = fit.squares.size() - 1;
  size_t taken = 0;
  double first = 1;
  for (bool more = true; more;) {
    more = false;
    const size_t least = std::max<size_t>(taken + 1, kLeastModes);
    for (size_t modes = least; modes <= most && !more; ++modes) {
      const double p = std::min(1.0, ByChance(fit, taken, modes) * static_cast<double>(most - least + 1));
      if (p >= kLevel) continue;
      if (taken == 0) first = p;
      taken = modes;
      more = true;
    }
  }
  return {taken, first};
}

}  // namespace

double Registration::HeightDeviation(const Vector3d& p) const {
  if (!bending) return 0;
  const auto count = static_cast<Eigen::Index>(bending->modes.size());
  const ProbeVector heights = bending->ModeShifts(p).transpose() * bending->Across();
  return std::sqrt(std::max(0.0, heights.dot(covariance.bottomRightCorner(count, count) * heights)));
}

ProbeVector ProbeRow(const Vector3d& d, const Vector3d& p, const Vector3d& centre,
                     const PartBending* bending) {
  const auto modes = bending ? static_cast<Eigen::Index>(bending->modes.size()) : 0;
  ProbeVector row(6 + modes);
  row.head<3>() = d;
  row.segment<3>(3) = (p - centre).cross(d);
  if (bending) row.tail(modes) = bending->ModeShifts(p).transpose() * d;
  return row;
}

Registration Register(const ProbedPart& part, const std::vector<ProbedPoint>& points,
                      const Eigen::Isometry3d& start, int threads, std::stop_token stop) {
  if (points.empty()) return {};
  return FitPlace(part, points, start, nullptr, threads, std::move(stop)).found;
}

std::optional<BentRegistration> RegisterBent(const ProbedPart& part, const std::vector<ProbedPoint>& points,
                                             const Registration& rigid, int threads,
                                             const std::stop_token& stop) {
  if (rigid.residuals.empty() || !rigid.undetermined.empty()) return std::nullopt;
  for (size_t modes = kMostModes; modes >= kLeastModes; --modes) {
    if (3 * points.size() < kPerUnknown * (6 + modes)) continue;
    FittedPlace fit = FitBent(part, points, rigid, modes, threads, stop);
    if (!Determined(part, points, fit.found)) continue;
    const auto [taken, p] = AskedFor(fit);
    if (taken == 0) return std::nullopt;
    if (taken < modes) fit = FitBent(part, points, rigid, taken, threads, stop);
    if (!Determined(part, points, fit.found)) return std::nullopt;
    BentRegistration bent{std::move(fit.found), p};
    const Triangles& triangles = part.mesh().triangles();
    const auto [largest, where] = LargestBending(triangles, *bent.found.bending);
    bent.largest = largest;
    bent.largest_95 = kNormal95 * bent.found.HeightDeviation(where);
    bent.slope = SteepestBending(triangles, *bent.found.bending);
    return bent;
  }
  return std::nullopt;
}

}  // namespace millpose
