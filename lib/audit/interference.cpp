// SPDX-License-Identifier: GPL-3.0-or-later
#include "audit/interference.hpp"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "audit/distance.hpp"

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
    Vector3 centre;  ///< of a box and of a sphere around the mesh, in the shape's frame
    Vector3 half;    ///< sizes of the box
    Real radius;
    Matrix4 X_WG;  ///< at the pose that is looked at
  };
  Setup zero, setup;  ///< with the external axes at 0, and where they stand; their bodies are the items
  std::vector<Item> items;
  std::vector<std::pair<size_t, size_t>> pairs;
  std::vector<std::pair<size_t, size_t>> standing;  ///< that external axes alone move against each other
  long long poses = 0;                              ///< looked at so far

  explicit Impl(const Setup& given) : zero(given), setup(given) {
    zero.bodies.clear();
    for (const Body& body : setup.bodies) {
      Item item{body,     MakeModel(body.mesh), IsClosed(body.mesh), Vector3::Zero(), Vector3::Zero(), 0,
                body.X_LG};
      Vector3 lower = body.mesh[0][0], upper = lower;
      for (const auto& t : body.mesh)
        for (const Vector3& p : t) {
          lower = lower.cwiseMin(p);
          upper = upper.cwiseMax(p);
        }
      item.centre = (lower + upper) / 2;
      item.half = (upper - lower) / 2;
      for (const auto& t : body.mesh)
        for (const Vector3& p : t) item.radius = std::max(item.radius, (p - item.centre).norm());
      items.push_back(std::move(item));
    }
    for (size_t i = 0; i < items.size(); ++i)
      for (size_t j = i + 1; j < items.size(); ++j)
        if (Counts(items[i].body, items[j].body))
          pairs.emplace_back(i, j);
        else if (CountsStanding(items[i].body, items[j].body))
          standing.emplace_back(i, j);
    setup.bodies.clear();
  }

  int CarrierOf(const Body& body) const { return body.link >= 0 ? LastCarrier(zero, true) : body.carrier; }

  /// The axis that carries an axis.
  int ParentOf(int axis) const {
    int parent = -1;
    for (int i = 0; i < axis; ++i)
      if (zero.axes[static_cast<size_t>(i)].carries_robot ==
          zero.axes[static_cast<size_t>(axis)].carries_robot)
        parent = i;
    return parent;
  }

  bool Excluded(const Body& a, const Body& b) const {
    for (const auto& [first, second] : zero.excluded_pairs)
      if ((first == a.name && second == b.name) || (first == b.name && second == a.name)) return true;
    return false;
  }

  /// Two that stand still in cuts and move against each other with the external axes, but for carriages, and
  /// the base on one, that are joined.
  bool CountsStanding(const Body& a, const Body& b) const {
    if (a.link > 0 || b.link > 0 || Excluded(a, b)) return false;
    const int on_a = CarrierOf(a), on_b = CarrierOf(b);
    if (on_a == on_b) return false;
    const bool guided = (a.guided || a.link == 0) && (b.guided || b.link == 0);
    const auto carries = [&](int lower, int upper) {
      return lower >= 0 && upper >= 0 && ParentOf(upper) == lower;
    };
    return !guided || !(carries(on_a, on_b) || carries(on_b, on_a));
  }

  void Stand(const Position& position) {
    setup = millpose::audit::At(zero, position);
    for (Item& item : items)
      if (item.body.link < 0)
        item.X_WG = position.empty() ? item.body.X_LG
                                     : Matrix4(Carried(zero, item.body.carrier, position) * item.body.X_LG);
  }

  /// Bound of how far any point travels on a move of the external axes, mm: each turns what it carries, which
  /// the others have moved by at most all their ways, and the arm by `arm` mm. The bodies stand as with the
  /// axes at `here`, a position on the move.
  Real MoveTravel(const Position& from, const Position& to, const Position& here, Real arm) const {
    Real travel = 0;
    for (size_t i = zero.axes.size(); i-- > 0;) {
      const Real way = std::abs(to[i] - from[i]);
      const Matrix4 X = Carried(zero, static_cast<int>(i), here);
      const Vector3 place = X.block<3, 3>(0, 0) * zero.axes[i].origin + X.block<3, 1>(0, 3);
      Real reach = 1;
      if (zero.axes[i].rotary)
        for (const Item& item : items)
          if (CarrierOf(item.body) >= 0)
            reach =
                std::max(reach, (Apply(item.X_WG, item.centre) - place).norm() + item.radius + travel + arm);
      travel += way * reach;
    }
    return travel;
  }

  /// Whether a pair is to be looked at: the two move against each other, are not links joined by a joint, and
  /// are not excluded by the cell.
  bool Counts(const Body& a, const Body& b) const {
    if (std::max(a.link, 0) == std::max(b.link, 0)) return false;
    if (a.kind == "link" && b.kind == "link" && std::abs(a.link - b.link) == 1) return false;
    return !Excluded(a, b);
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
    const Vector3 p_G = b.X_WG.block<3, 3>(0, 0).transpose() * (p_W - Vector3(b.X_WG.block<3, 1>(0, 3)));
    if (((p_G - b.centre).cwiseAbs() - b.half).maxCoeff() > 0) return false;  // outside the box around it
    return IsInside(p_G, b.body.mesh);
  }

  static Mesh Placed(const Item& item) {
    Mesh mesh = item.body.mesh;
    for (auto& t : mesh)
      for (Vector3& p : t) p = Apply(item.X_WG, p);
    return mesh;
  }

  static bool OnTool(const Body& body) {
    return body.kind == "cutter" || body.kind == "holder" || body.kind == "spindle";
  }

  /// Whether the cut allows the two to touch: cutter and part, the tool and the raw part around it.
  static bool MayTouch(const Item& a, const Item& b, bool cutting) {
    const auto allowed = [](const Body& x, const Body& y) {
      return (x.in_cut && y.kind == "workpiece") || (OnTool(x) && y.kind == "stock");
    };
    return cutting && (allowed(a.body, b.body) || allowed(b.body, a.body));
  }

  /// The clearance that the cell asks for (docs/interference.md), mm.
  Real Clearance(const Body& a, const Body& b, bool cutting) const {
    if (a.kind != "workpiece" && b.kind != "workpiece") return setup.clearance_free;
    const bool tool = OnTool(a) || OnTool(b);
    return (cutting && tool ? setup.clearance_cutting : setup.clearance_free) + setup.allowance;
  }

  /// Distance of the boxes around two bodies along the axes of either: never more than the bodies'.
  static Real BoxGap(const Item& a, const Item& b) {
    const Vector3 between = Apply(b.X_WG, b.centre) - Apply(a.X_WG, a.centre);
    Real gap = 0;
    for (const auto& [x, y] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      const Matrix3 axes = x->X_WG.block<3, 3>(0, 0);
      const Matrix3 other = (axes.transpose() * y->X_WG.block<3, 3>(0, 0)).cwiseAbs();
      const Vector3 apart = (axes.transpose() * between).cwiseAbs() - x->half - other * y->half;
      gap = std::max(gap, apart.cwiseMax(Real{0}).norm());
    }
    return gap;
  }

  /// Distance of two surfaces up to `bound`, mm.
  static double Apart(const Item& a, const Item& b, double bound) {
    fcl::Transform3d X_a, X_b;
    X_a.matrix() = a.X_WG.cast<double>();
    X_b.matrix() = b.X_WG.cast<double>();
    const fcl::DistanceRequestd request;
    fcl::DistanceResultd result(bound);
    fcl::distance(a.model.get(), X_a, b.model.get(), X_b, request, result);
    return std::clamp(result.min_distance, 0.0, bound);
  }

  /// Calls `look` at poses on a motion, no point of what moves travelling more than `travel` mm from one to
  /// the next, until it returns true. It is told whether the pose ends a piece of the motion. The bodies are
  /// placed.
  template <class Look>
  void Walk(const Motion& motion, double travel, Look look) {
    // Pieces of at most 2° keep the reach taken at a piece's middle within 4 % of the reach anywhere on it.
    Real widest = 0;
    for (size_t i = 0; i < 6; ++i) widest = std::max(widest, std::abs(motion.to[i] - motion.from[i]));
    const int pieces = std::max(1, static_cast<int>(std::ceil(widest / (2 * kDegree))));
    const auto angles_at = [&](Real share) {
      Angles angles;
      for (size_t i = 0; i < 6; ++i) angles[i] = motion.from[i] + (motion.to[i] - motion.from[i]) * share;
      return angles;
    };
    const auto axes_at = [&](Real share) {
      Position position = motion.external_from;
      for (size_t i = 0; i < position.size(); ++i)
        position[i] += (motion.external_to[i] - motion.external_from[i]) * share;
      return position;
    };
    const bool axes = !motion.external_from.empty();
    for (int piece = 0; piece < pieces; ++piece) {
      const Real begin = static_cast<Real>(piece) / pieces, end = static_cast<Real>(piece + 1) / pieces;
      if (axes) Stand(axes_at((begin + end) / 2));
      Real way = Travel(angles_at(begin), angles_at(end)) * 1.04L;
      if (axes) way += MoveTravel(axes_at(begin), axes_at(end), axes_at((begin + end) / 2), way);
      const int steps = std::max(1, static_cast<int>(std::ceil(way / travel)));
      for (int step = piece > 0 ? 1 : 0; step <= steps; ++step) {
        const Real share = (piece + static_cast<Real>(step) / steps) / pieces;
        const Angles angles = angles_at(share);
        if (axes) Stand(axes_at(share));
        Place(angles);
        ++poses;
        if (look(angles, step == 0 || step == steps)) return;
      }
    }
  }

  /// Calls `look` with every pair that can come together on a motion until it returns true: also those that
  /// external axes alone move against each other, where these move.
  template <class Look>
  bool AnyPair(const Motion& motion, Look look) const {
    for (const auto& [i, j] : pairs)
      if (look(i, j)) return true;
    if (motion.external_from != motion.external_to)
      for (const auto& [i, j] : standing)
        if (look(i, j)) return true;
    return false;
  }

  /// The first pair that touches as the bodies are placed.
  std::optional<Contact> Touching(const Motion& motion, const Angles& angles, bool inside) const {
    std::optional<Contact> contact;
    AnyPair(motion, [&](size_t i, size_t j) {
      const Item &a = items[i], &b = items[j];
      if (MayTouch(a, b, motion.cutting)) return false;
      if (Touch(a, b) || (inside && (Inside(a, b) || Inside(b, a))))
        contact = Contact{a.body.name, b.body.name, angles};
      return contact.has_value();
    });
    return contact;
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

void Judge::Stand(const Position& position) { impl_->Stand(position); }

std::vector<Near> Judge::Moving(const Position& from, const Position& to, const Angles& angles, double slack,
                                double travel) {
  impl_->Stand(from);
  impl_->Place(angles);
  const auto steps =
      static_cast<int>(std::ceil(std::max<Real>(1, impl_->MoveTravel(from, to, from, 0) / travel)));
  std::map<std::pair<size_t, size_t>, Near> nearest;
  for (int step = 0; step <= steps; ++step) {
    Position position = from;
    for (size_t i = 0; i < position.size(); ++i) position[i] += (to[i] - from[i]) * step / steps;
    impl_->Stand(position);
    impl_->Place(angles);
    ++impl_->poses;
    for (const auto* pairs : {&impl_->pairs, &impl_->standing})
      for (const auto& [i, j] : *pairs) {
        const Impl::Item &a = impl_->items[i], &b = impl_->items[j];
        if (impl_->CarrierOf(a.body) == impl_->CarrierOf(b.body)) continue;
        const double wanted = static_cast<double>(impl_->Clearance(a.body, b.body, false));
        const auto known = nearest.find({i, j});
        const double bound = known != nearest.end() ? known->second.distance : wanted - slack;
        if (bound <= 0 || Impl::BoxGap(a, b) >= bound) continue;
        const double distance = Impl::Touch(a, b) ? 0 : Impl::Apart(a, b, bound);
        if (distance < bound)
          nearest.insert_or_assign({i, j}, Near{a.body.name, b.body.name, distance, wanted});
      }
  }
  std::vector<Near> near;
  for (const auto& [pair, found] : nearest) near.push_back(found);
  return near;
}

std::optional<Contact> Judge::At(const Angles& angles, bool cutting, bool inside) {
  ++impl_->poses;
  impl_->Place(angles);
  return impl_->Touching({angles, angles, cutting}, angles, inside);
}

std::optional<Contact> Judge::Between(const Motion& motion, double travel) {
  std::optional<Contact> contact;
  impl_->Walk(motion, travel, [&](const Angles& angles, bool ends) {
    contact = impl_->Touching(motion, angles, ends);
    return contact.has_value();
  });
  if (!motion.external_to.empty()) impl_->Stand(motion.external_to);
  return contact;
}

std::vector<Near> Judge::TooNear(const Motion& motion, double share, double slack, double travel) {
  std::map<std::pair<size_t, size_t>, Near> nearest;
  impl_->Walk(motion, travel, [&](const Angles&, bool) {
    return impl_->AnyPair(motion, [&](size_t i, size_t j) {
      const Impl::Item &a = impl_->items[i], &b = impl_->items[j];
      if (Impl::MayTouch(a, b, motion.cutting)) return false;
      const double wanted = share * static_cast<double>(impl_->Clearance(a.body, b.body, motion.cutting));
      double bound = wanted - slack;
      const auto known = nearest.find({i, j});
      if (known != nearest.end()) bound = known->second.distance;
      if (bound <= 0 || Impl::BoxGap(a, b) >= bound) return false;
      const double distance = Impl::Apart(a, b, bound);
      if (distance < bound)
        nearest.insert_or_assign({i, j}, Near{a.body.name, b.body.name, distance, wanted});
      return false;
    });
  });
  if (!motion.external_to.empty()) impl_->Stand(motion.external_to);
  std::vector<Near> near;
  for (const auto& [pair, found] : nearest) near.push_back(found);
  return near;
}

long long Judge::poses() const { return impl_->poses; }

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
