// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/registration/face_error.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "base/student.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A root of a covariance, for draws.
ProbeMatrix RootOf(const ProbeMatrix& covariance) {
  const EigenPairs eigen = EigenOfSymmetric(covariance);
  ProbeMatrix root = eigen.vectors;
  for (Eigen::Index k = 0; k < covariance.rows(); ++k)
    root.col(k) *= std::sqrt(std::max(0.0, eigen.values[k]));
  return root;
}

/// Largest standard deviation of any direction across the normal.
double SidewaysDeviation(const ProbeMatrix& covariance, const Vector3d& centre, const PartPlace& place,
                         const PartBending* bending) {
  int least = 0;
  place.normal.cwiseAbs().minCoeff(&least);
  const Vector3d u = place.normal.cross(Vector3d::Unit(least)).normalized(), v = place.normal.cross(u);
  const ProbeVector a = ProbeRow(u, place.position, centre, bending),
                    b = ProbeRow(v, place.position, centre, bending);
  const double uu = a.dot(covariance * a), vv = b.dot(covariance * b), uv = a.dot(covariance * b);
  const double half = 0.5 * (uu - vv);
  return std::sqrt(std::max(0.0, 0.5 * (uu + vv) + std::sqrt(half * half + uv * uv)));
}

/// |row·ξ| of the row where it is largest, and which that is.
std::pair<double, size_t> Farthest(const std::vector<ProbeVector>& rows, const ProbeVector& xi) {
  std::pair<double, size_t> farthest{-1, 0};
  for (size_t i = 0; i < rows.size(); ++i)
    if (const double off = std::abs(rows[i].dot(xi)); off > farthest.first) farthest = {off, i};
  return farthest;
}

}  // namespace

FaceError ErrorOfFace(const ProbeMatrix& covariance, const Vector3d& centre,
                      const std::vector<PartPlace>& face, const PartBending* bending) {
  constexpr int kSeeking = 400, kDraws = 4000;
  FaceError error;
  if (face.empty()) return error;
  std::vector<ProbeVector> rows;
  double beside = 0;
  for (const PartPlace& place : face) {
    rows.push_back(ProbeRow(place.normal, place.position, centre, bending));
    error.sd.push_back(std::sqrt(std::max(0.0, rows.back().dot(covariance * rows.back()))));
    beside = std::max(beside, SidewaysDeviation(covariance, centre, place, bending));
  }
  error.worst = static_cast<size_t>(std::ranges::max_element(error.sd) - error.sd.begin());
  error.beside_95 = kNormal95 * beside;
  // Few places are ever the farthest off: those that some draws find stand for all in the rest.
  const ProbeMatrix root = RootOf(covariance);
  RandomStream random(1, 0);
  std::set<size_t> extreme;
  std::vector<double> largest;
  std::vector<ProbeVector> few;
  for (int draw = 0; draw < kDraws; ++draw) {
    ProbeVector z(covariance.rows());
    for (Eigen::Index k = 0; k < z.size(); ++k) z[k] = random.Normal();
    const auto [off, place] = Farthest(draw < kSeeking ? rows : few, root * z);
    largest.push_back(off);
    if (draw < kSeeking) extreme.insert(place);
    if (draw + 1 == kSeeking)
      for (const size_t i : extreme) few.push_back(rows[i]);
  }
  std::ranges::sort(largest);
  error.off_95 = largest[largest.size() * 95 / 100];
  error.median_off = largest[largest.size() / 2];
  return error;
}

}  // namespace millpose
