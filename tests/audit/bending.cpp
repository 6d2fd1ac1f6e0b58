// SPDX-License-Identifier: GPL-3.0-or-later
// A part that its clamps bend, as docs/registration.md says it: read and computed anew.
#include "tests/audit/folder.hpp"
#include "tests/audit/yaml_values.hpp"

namespace millpose::audit {
namespace {

/// Legendre's polynomial of a degree and its derivative, by Bonnet's recursion.
std::pair<Real, Real> Legendre(int degree, Real x) {
  Real before = 0, value = 1, slope_before = 0, slope = 0;
  for (int n = 0; n < degree; ++n) {
    const Real next = ((2 * n + 1) * x * value - n * before) / (n + 1);
    const Real slope_next = slope_before + (2 * n + 1) * value;
    before = value, value = next;
    slope_before = slope, slope = slope_next;
  }
  return {value, slope};
}

/// Halves the longest side until the bent triangle is plane, to some µm.
void Divide(const BentPlate& plate, const std::array<Vector3, 3>& face, int depth, Mesh& mesh) {
  constexpr int kMostHalvings = 20;
  const std::array<Vector3, 3> bent = {plate.Bent(face[0]), plate.Bent(face[1]), plate.Bent(face[2])};
  Real off = 0, longest = -1;
  size_t divided = 0;
  for (size_t k = 0; k < 3; ++k) {
    const Vector3 &a = face[k], &b = face[(k + 1) % 3];
    for (const Real t : {Real{1} / 4, Real{1} / 2, Real{3} / 4})
      off = std::max(off, (plate.Bent(a + t * (b - a)) - bent[k] - t * (bent[(k + 1) % 3] - bent[k])).norm());
    if ((b - a).norm() > longest) longest = (b - a).norm(), divided = k;
  }
  if (off < 1e-3L || depth == kMostHalvings) {
    mesh.push_back(bent);
    return;
  }
  const Vector3 &a = face[divided], &b = face[(divided + 1) % 3], &c = face[(divided + 2) % 3];
  const Vector3 middle = (a + b) / 2;
  Divide(plate, {a, middle, c}, depth + 1, mesh);
  Divide(plate, {middle, b, c}, depth + 1, mesh);
}

}  // namespace

Vector3 BentPlate::Bent(const Vector3& p) const {
  const Vector3 w = u.cross(v).normalized(), from = p - origin;
  Real height = 0;
  Vector3 slope = Vector3::Zero();
  for (const Mode& mode : modes) {
    const auto [a, a_slope] = Legendre(mode.u_degree, from.dot(u) / u.squaredNorm());
    const auto [b, b_slope] = Legendre(mode.v_degree, from.dot(v) / v.squaredNorm());
    height += mode.size * a * b;
    slope += mode.size * (a_slope * b * u / u.squaredNorm() + a * b_slope * v / v.squaredNorm());
  }
  return p + height * w - w.dot(from) * slope;
}

Vector3 BentPlate::Unbent(const Vector3& p) const {
  Vector3 unbent = p;
  for (int i = 0; i < 100; ++i) unbent += p - Bent(unbent);
  return unbent;
}

Vector3 BentPlate::UnbentNormal(const Vector3& p, const Vector3& n) const {
  constexpr Real kStep = 1e-4L;  // mm
  Vector3 normal;
  for (int k = 0; k < 3; ++k)
    normal[k] = n.dot(Bent(p + kStep * Vector3::Unit(k)) - Bent(p - kStep * Vector3::Unit(k))) / (2 * kStep);
  return normal.normalized();
}

Mesh BentPlate::Bent(const Mesh& part) const {
  Mesh bent;
  for (const auto& face : part) Divide(*this, face, 0, bent);
  return bent;
}

std::optional<BentPlate> ReadPlate(const YAML::Node& workpiece) {
  const YAML::Node registered = workpiece["registered"];
  if (!registered || !registered["bending"]) return std::nullopt;
  const YAML::Node bending = registered["bending"];
  BentPlate plate{Triple(bending["origin_mm"]), Triple(bending["u_mm"]), Triple(bending["v_mm"]), {}};
  // By name: how often u and v stand in it.
  const std::map<std::string, std::pair<int, int>> degrees = {
      {"u2", {2, 0}}, {"uv", {1, 1}}, {"v2", {0, 2}}, {"u3", {3, 0}}, {"u2v", {2, 1}}, {"uv2", {1, 2}}};
  for (const auto& mode : bending["modes_mm"]) {
    const auto [u, v] = degrees.at(mode.first.as<std::string>());
    plate.modes.push_back({u, v, mode.second.as<double>()});
  }
  return plate;
}

}  // namespace millpose::audit
