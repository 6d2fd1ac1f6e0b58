// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/minimum_zone.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Width_3.h>
#include <CGAL/Width_default_traits_3.h>
#include <CGAL/convex_hull_3.h>

#include <cmath>

namespace millpose {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactKernel = CGAL::Simple_cartesian<CGAL::Gmpq>;
using Rational = CGAL::Gmpq;

std::vector<Kernel::Point_3> ToCgal(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Kernel::Point_3> converted;
  for (const Eigen::Vector3d& point : points) converted.emplace_back(point.x(), point.y(), point.z());
  return converted;
}

Eigen::Vector3d Positive(Eigen::Vector3d normal) {
  normal.normalize();
  int largest = 0;
  normal.cwiseAbs().maxCoeff(&largest);
  return normal[largest] < 0 ? Eigen::Vector3d(-normal) : normal;
}

}  // namespace

MinimumZone FindMinimumZone(const std::vector<Eigen::Vector3d>& points) {
  // The hull with exact predicates first: the rationals then meet few points.
  const std::vector<Kernel::Point_3> all = ToCgal(points);
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(all.begin(), all.end(), hull);
  std::vector<ExactKernel::Point_3> corners;
  for (const auto vertex : hull.vertices()) {
    const Kernel::Point_3& point = hull.point(vertex);
    corners.emplace_back(Rational(point.x()), Rational(point.y()), Rational(point.z()));
  }
  CGAL::Width_3<CGAL::Width_default_traits_3<ExactKernel>> width(corners.begin(), corners.end());
  Rational numerator, denominator;
  width.get_squared_width(numerator, denominator);
  const Rational square = numerator / denominator;
  const ExactKernel::Vector_3 normal = width.get_build_direction();
  return {std::sqrt(CGAL::to_double(square)),
          Positive({CGAL::to_double(normal.x()), CGAL::to_double(normal.y()), CGAL::to_double(normal.z())})};
}

bool AreCoplanar(const std::vector<Eigen::Vector3d>& points) {
  const std::vector<Kernel::Point_3> all = ToCgal(points);
  // Three of them that span a plane, then all against it.
  size_t second = 1, third = 2;
  while (second < all.size() && all[second] == all[0]) ++second;
  while (third < all.size() && CGAL::collinear(all[0], all[second], all[third])) ++third;
  for (size_t i = third + 1; i < all.size(); ++i)
    if (!CGAL::coplanar(all[0], all[second], all[third], all[i])) return false;
  return true;
}

}  // namespace millpose
