// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/panel.hpp"

#include "base/rotation.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {

using Eigen::Vector3d;

Vector3d NormalVector(RandomStream& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return {x, y, z};
}

Eigen::Isometry3d SmallMove(RandomStream& random, double mm) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = RotationAbout(NormalVector(random).normalized(), mm / 1000 * random.Normal());
  X.translation() = mm * NormalVector(random);
  return X;
}

ProbedPanel::ProbedPanel() : part(SampleMesh("cabin_panel"), kSharp) {
  for (const PartPlace& place : PlacesToProbe(part.mesh(), 30, 1, kSharp, 20000)) {
    if (place.normal.z() > 0.85) skin.push_back(place);
    if (std::abs(place.normal.z()) < 0.5) sides.push_back(place);
  }
  for (size_t i = 0; i < skin.size(); i += skin.size() / 200) milled.push_back(skin[i]);
}

const ProbedPanel& ThePanel() {
  static const ProbedPanel panel;
  return panel;
}

double Off(const std::vector<PartPlace>& face, const Eigen::Isometry3d& X_true,
           const Eigen::Isometry3d& X_found, const PartBending& bent_true,
           const std::optional<PartBending>& bent_found) {
  const Eigen::Isometry3d between = X_true.inverse(Eigen::Isometry) * X_found;
  double most = 0;
  for (const PartPlace& place : face) {
    const Vector3d found = bent_found ? bent_found->Bent(place.position) : place.position;
    const Vector3d normal = bent_true.BentNormal(place.position, place.normal);
    most = std::max(most, std::abs(normal.dot(between * found - bent_true.Bent(place.position))));
  }
  return most;
}

Drawn Draw(RandomStream& random, size_t on_skin, size_t on_sides, double sd, double radius,
           const PartBending& bending) {
  const ProbedPanel& panel = ThePanel();
  Drawn drawn;
  drawn.start = SmallMove(random, 1000);
  drawn.X_true = drawn.start * SmallMove(random, 2);
  const auto add = [&](const PartPlace& place) {
    ProbedPoint point;
    point.radius = radius;
    point.sd = sd;
    const Vector3d ball =
        bending.Bent(place.position) + radius * bending.BentNormal(place.position, place.normal);
    point.measured = drawn.X_true * ball + sd * NormalVector(random);
    point.normal = drawn.start.linear() * place.normal;
    drawn.points.push_back(point);
  };
  const auto any_of = [&](const std::vector<PartPlace>& places) -> const PartPlace& {
    return places[static_cast<size_t>(random.Below(static_cast<int>(places.size())))];
  };
  for (size_t i = 0; i < on_skin; ++i) add(any_of(panel.skin));
  for (size_t i = 0; i < on_sides; ++i) add(any_of(panel.sides));
  return drawn;
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace millpose
