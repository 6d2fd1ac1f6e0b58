// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/skins.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

// The window's border in the development, anticlockwise.
std::vector<Eigen::Vector2d> Border(const Skin& skin) {
  std::vector<Eigen::Vector2d> border;
  const Eigen::Vector2d half(skin.width / 2, skin.height / 2);
  const Eigen::Vector2d signs[] = {{1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d middle = signs[k].cwiseProduct(half - Eigen::Vector2d::Constant(skin.corner));
    const int turns = skin.corner > 0 ? std::max(1, static_cast<int>(std::lround(kPi / 2 / skin.facet))) : 0;
    for (int i = 0; i <= turns; ++i) {
      const double at = (k - 1) * kPi / 2 + (turns > 0 ? kPi / 2 * i / turns : 0);
      border.push_back(middle + skin.corner * Eigen::Vector2d(std::cos(at), std::sin(at)));
    }
    const Eigen::Vector2d from = border.back();
    const Eigen::Vector2d next =
        signs[(k + 1) % 4].cwiseProduct(half - Eigen::Vector2d::Constant(skin.corner));
    const Eigen::Vector2d to =
        next + skin.corner * Eigen::Vector2d(std::cos(k * kPi / 2), std::sin(k * kPi / 2));
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / skin.edge)));
    for (int i = 1; i < steps; ++i) border.push_back(from + (to - from) * i / steps);
  }
  return border;
}

}  // namespace

Eigen::Vector3d OnSkin(const Skin& skin, const Eigen::Vector2d& p) {
  const double r = skin.radius;
  if (skin.form == SkinForm::kCylinder)
    return {p.x(), r * std::sin(p.y() / r), r * (std::cos(p.y() / r) - 1)};
  if (skin.form == SkinForm::kSphere) return {p.x(), p.y(), std::sqrt(r * r - p.squaredNorm()) - r};
  return {p.x(), p.y(), 0};
}

Triangles SkinShape(const Skin& skin) {
  constexpr int kRings = 6;
  const std::vector<Eigen::Vector2d> border = Border(skin);
  const int count = static_cast<int>(border.size());
  Triangles triangles;
  for (int ring = 0; ring <= kRings; ++ring)
    for (const Eigen::Vector2d& p : border)
      triangles.vertices.push_back(OnSkin(skin, p * (1 + 0.6 * ring / kRings)));
  for (int ring = 0; ring < kRings; ++ring)
    for (int i = 0; i < count; ++i) {
      const int a = ring * count + i, b = ring * count + (i + 1) % count;
      triangles.faces.push_back({a, a + count, b + count});
      triangles.faces.push_back({a, b + count, b});
    }
  return triangles;
}

Eigen::Vector3d SkinNormal(const Skin& skin, const Eigen::Vector3d& p) {
  if (skin.form == SkinForm::kFlat) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d middle(skin.form == SkinForm::kCylinder ? p.x() : 0, 0, -skin.radius);
  return (p - middle).normalized();
}

}  // namespace millpose
