// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/interference.hpp"

#include <fcl/narrowphase/collision.h>

#include <cmath>

#include "tests/audit/distance.hpp"
#include "tests/audit/kinematics.hpp"

namespace millpose::audit {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

namespace {

Eigen::Vector3d ToDouble(const Vector3& v) { return v.cast<double>(); }

std::shared_ptr<Model> MakeModel(const Mesh& mesh) {
  auto model = std::make_shared<Model>();
  model->beginModel();
  for (const auto& t : mesh) model->addTriangle(ToDouble(t[0]), ToDouble(t[1]), ToDouble(t[2]));
  model->endModel();
  return model;
}

Vector3 Apply(const Matrix4& X, const Vector3& p) { return X.block<3, 3>(0, 0) * p + X.block<3, 1>(0, 3); }

}  // namespace

struct Judge::Impl {
  struct Item {
    Body body;
    std::shared_ptr<Model> model;
    bool closed;
    Vector3 centre;  ///< of a sphere around the mesh, in the shape's frame
    Real radius;
    Matrix4 X_WG;  ///< at the pose that is looked at
  };
  Setup setup;
  std::vector<Item> items;
  std::vector<std::pair<size_t, size_t>> pairs;

  explicit Impl(const Setup& given) : setup(given) {
    for (const Body& body : setup.bodies) {
      Item item{body, MakeModel(body.mesh), IsClosed(body.mesh), Vector3::Zero(), 0, body.X_LG};
      Vector3 lower = body.mesh[0][0], upper = lower;
      for (const auto& t : body.mesh)
        for (const Vector3& p : t) {
          lower = lower.cwiseMin(p);
          upper = upper.cwiseMax(p);
        }
      item.centre = (lower + upper) / 2;
      for (const auto& t : body.mesh)
        for (const Vector3& p : t) item.radius = std::max(item.radius, (p - item.centre).norm());
      items.push_back(std::move(item));
    }
    for (size_t i = 0; i < items.size(); ++i)
      for (size_t j = i + 1; j < items.size(); ++j)
        if (Counts(items[i].body, items[j].body)) pairs.emplace_back(i, j);
  }

  /// Whether a pair is to be looked at: the two move against each other, are not links joined by a joint, and
  /// are not excluded by the cell.
  bool Counts(const Body& a, const Body& b) const {
    if (std::max(a.link, 0) == std::max(b.link, 0)) return false;
    if (a.kind == "link" && b.kind == "link" && std::abs(a.link - b.link) == 1) return false;
    for (const auto& [first, second] : setup.excluded_pairs)
      if ((first == a.name && second == b.name) || (first == b.name && second == a.name)) return false;
    return true;
  }

  void Place(const Angles& angles) {
    const std::array<Matrix4, 7> frames = Frames(setup, angles);
    for (Item& item : items)
      if (item.body.link >= 0) item.X_WG = frames[static_cast<size_t>(item.body.link)] * item.body.X_LG;
  }

  static bool Touch(const Item& a, const Item& b) {
    if ((Apply(a.X_WG, a.centre) - Apply(b.X_WG, b.centre)).norm() > a.radius + b.radius) return false;
    fcl::Transform3d X_a, X_b;
    X_a.matrix() = a.X_WG.cast<double>();
    X_b.matrix() = b.X_WG.cast<double>();
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(a.model.get(), X_a, b.model.get(), X_b, request, result) > 0;
  }

  /// Whether a corner of `a` lies inside `b`; for bodies that do not touch, all corners are alike.
  static bool Inside(const Item& a, const Item& b) {
    if (!b.closed) return false;
    const Vector3 p_W = Apply(a.X_WG, a.body.mesh[0][0]);
    if ((p_W - Apply(b.X_WG, b.centre)).norm() > b.radius) return false;
    const Vector3 p_G = b.X_WG.block<3, 3>(0, 0).transpose() * (p_W - Vector3(b.X_WG.block<3, 1>(0, 3)));
    return IsInside(p_G, b.body.mesh);
  }

  static Mesh Placed(const Item& item) {
    Mesh mesh = item.body.mesh;
    for (auto& t : mesh)
      for (Vector3& p : t) p = Apply(item.X_WG, p);
    return mesh;
  }

  /// Whether the cut allows the two to touch.
  static bool MayTouch(const Item& a, const Item& b, bool cutting) {
    return cutting && (a.body.in_cut || b.body.in_cut) &&
           (a.body.kind == "workpiece" || b.body.kind == "workpiece");
  }

  /// Bound of how far any point of a moving body travels on a straight joint motion, mm.
  Real Travel(const Angles& from, const Angles& to) {
    Angles middle;
    for (size_t i = 0; i < 6; ++i) middle[i] = (from[i] + to[i]) / 2;
    const std::array<Matrix4, 7> frames = Frames(setup, middle);
    Place(middle);
    Real farthest = 0;
    for (const Item& item : items) {
      if (item.body.link < 0) continue;
      Real travel = 0;
      for (size_t joint = 0; joint < static_cast<size_t>(item.body.link); ++joint) {
        const Vector3 on_axis = frames[joint + 1].block<3, 1>(0, 3);
        const Real reach = (Apply(item.X_WG, item.centre) - on_axis).norm() + item.radius;
        travel += std::abs(to[joint] - from[joint]) * reach;
      }
      farthest = std::max(farthest, travel);
    }
    return farthest;
  }
};

Judge::Judge(const Setup& setup) : impl_(std::make_unique<Impl>(setup)) {}
Judge::~Judge() = default;

std::optional<Contact> Judge::At(const Angles& angles, bool cutting, bool inside) {
  ++poses;
  impl_->Place(angles);
  for (const auto& [i, j] : impl_->pairs) {
    const Impl::Item &a = impl_->items[i], &b = impl_->items[j];
    if (Impl::MayTouch(a, b, cutting)) continue;
    if (Impl::Touch(a, b) || (inside && (Impl::Inside(a, b) || Impl::Inside(b, a))))
      return Contact{a.body.name, b.body.name, angles};
  }
  return std::nullopt;
}

std::optional<Contact> Judge::Between(const Angles& from, const Angles& to, bool cutting, double travel) {
  // Pieces of at most 2° keep the reach taken at a piece's middle within 4 % of the reach anywhere on it.
  Real widest = 0;
  for (size_t i = 0; i < 6; ++i) widest = std::max(widest, std::abs(to[i] - from[i]));
  const int pieces = std::max(1, static_cast<int>(std::ceil(widest / (2 * kDegree))));
  const auto point = [&](Real share) {
    Angles angles;
    for (size_t i = 0; i < 6; ++i) angles[i] = from[i] + (to[i] - from[i]) * share;
    return angles;
  };
  for (int piece = 0; piece < pieces; ++piece) {
    const Angles start = point(static_cast<Real>(piece) / pieces),
                 end = point(static_cast<Real>(piece + 1) / pieces);
    const int steps = std::max(1, static_cast<int>(std::ceil(impl_->Travel(start, end) * 1.04L / travel)));
    for (int step = 0; step <= steps; ++step) {
      if (step == 0 && piece > 0) continue;
      const Angles angles = point((piece + static_cast<Real>(step) / steps) / pieces);
      if (const auto contact = At(angles, cutting, step == 0 || step == steps)) return contact;
    }
  }
  return std::nullopt;
}

Real Judge::Distance(const std::string& first, const std::string& second, const Angles& angles, bool cutting,
                     Real bound) {
  impl_->Place(angles);
  Real nearest = bound;
  for (const auto& [i, j] : impl_->pairs) {
    const Impl::Item &a = impl_->items[i], &b = impl_->items[j];
    const bool named =
        (a.body.name == first && b.body.name == second) || (a.body.name == second && b.body.name == first);
    if (!named || Impl::MayTouch(a, b, cutting)) continue;
    if (Impl::Inside(a, b) || Impl::Inside(b, a)) return 0;
    nearest = std::min(nearest, audit::Distance(Impl::Placed(a), Impl::Placed(b), nearest));
  }
  return nearest;
}

Real Judge::Radius(const std::string& name) const {
  Real radius = 0;
  for (const Impl::Item& item : impl_->items)
    if (item.body.name == name) radius = std::max(radius, item.radius);
  return radius;
}

}  // namespace millpose::audit
