// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/registration/next_places.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/mesh/corner_normals.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Every so many of them, at most `most`.
template <class T>
std::vector<T> Thinned(const std::vector<T>& all, size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

/// Sharp sides of a mesh as segments.
std::vector<std::array<Vector3d, 2>> SharpSides(const Mesh& mesh, double crease) {
  std::vector<std::array<Vector3d, 2>> sides;
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k)
      if (mesh.Neighbour(face, k) < 0 || BendAngle(mesh, face, k) > crease)
        sides.push_back({mesh.Corner(face, k), mesh.Corner(face, (k + 1) % 3)});
  return sides;
}

}  // namespace

std::vector<PartPlace> PlacesToProbe(const Mesh& mesh, double spacing, double edge, double crease,
                                     size_t most) {
  std::vector<PartPlace> places;
  for (int face = 0; face < mesh.face_count(); ++face) {
    const Vector3d &a = mesh.Corner(face, 0), &b = mesh.Corner(face, 1), &c = mesh.Corner(face, 2);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, 40);
    // Centres of the n² small triangles.
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        const double u = (i + 1.0 / 3) / n, v = (j + 1.0 / 3) / n;
        places.push_back({a + u * (b - a) + v * (c - a), mesh.FaceNormal(face)});
      }
  }
  places = Thinned(places, 4 * most);
  const auto sides = SharpSides(mesh, crease);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& [from, to] : sides) {
    boxes.emplace_back(from);
    boxes.back().extend(to);
  }
  const Bvh tree(boxes);
  std::erase_if(places, [&](const PartPlace& place) {
    const auto distance = [&](int k) {
      const Vector3d along = sides[k][1] - sides[k][0], p = place.position - sides[k][0];
      const double t = std::clamp(p.dot(along) / along.squaredNorm(), 0.0, 1.0);
      return (p - t * along).squaredNorm();
    };
    return tree.Nearest(place.position, edge * edge, distance).first >= 0;
  });
  return Thinned(places, most);
}

std::vector<NextPlace> ProposePlaces(ProbeMatrix covariance, const Vector3d& centre,
                                     const std::vector<PartPlace>& face,
                                     const std::vector<PartPlace>& candidates, double sd, int count,
                                     const std::function<bool(size_t candidate)>& reachable,
                                     const PartBending* bending) {
  constexpr size_t kPlaces = 500;  // of the face that are looked at
  std::vector<ProbeVector> rows;
  for (const PartPlace& place : Thinned(face, kPlaces))
    rows.push_back(ProbeRow(place.normal, place.position, centre, bending));
  // What one point more takes off the root of the covariance (Sherman and Morrison).
  const auto gain_of = [&](size_t candidate) -> ProbeVector {
    const ProbeVector a =
        ProbeRow(candidates[candidate].normal, candidates[candidate].position, centre, bending);
    return covariance * a / std::sqrt(sd * sd + a.dot(covariance * a));
  };
  std::vector<NextPlace> chosen;
  std::vector<char> barred(candidates.size(), 0);
  while (static_cast<int>(chosen.size()) < count) {
    std::vector<std::pair<double, size_t>> by_worst;
    for (size_t c = 0; c < candidates.size(); ++c) {
      if (barred[c]) continue;
      const ProbeVector gain = gain_of(c);
      double worst = 0;
      for (const ProbeVector& row : rows) {
        const double fall = row.dot(gain);
        worst = std::max(worst, row.dot(covariance * row) - fall * fall);
      }
      by_worst.emplace_back(worst, c);
    }
    std::ranges::sort(by_worst);
    const auto best = std::ranges::find_if(by_worst, [&](const auto& candidate) {
      barred[candidate.second] = !reachable(candidate.second);
      return !barred[candidate.second];
    });
    if (best == by_worst.end()) break;
    const ProbeVector gain = gain_of(best->second);
    covariance -= gain * gain.transpose();
    chosen.push_back({best->second, std::sqrt(std::max(0.0, best->first))});
  }
  return chosen;
}

}  // namespace millpose
