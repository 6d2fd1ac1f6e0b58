// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/edge_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/trig.hpp"

namespace millpose {
namespace {

struct Spoke {
  double angle;
  bool forward;  // runs low→high
  Side side;
  int component;
};

// The sides in their order around the edge, seen along low→high.
std::vector<Spoke> SpokesOf(const Triangles& mesh, std::span<const EdgeSide> sides,
                            const std::vector<int>& component) {
  const Eigen::Vector3d& origin = mesh.vertices[sides[0].low];
  const Eigen::Vector3d axis = (mesh.vertices[sides[0].high] - origin).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Spoke> spokes;
  for (const EdgeSide& side : sides) {
    const auto& face = mesh.faces[FaceOf(side.side)];
    const Eigen::Vector3d apex = mesh.vertices[face[(CornerOf(side.side) + 2) % 3]] - origin;
    spokes.push_back({Atan2(apex.dot(v), apex.dot(u)), face[CornerOf(side.side)] == side.low, side.side,
                      component[FaceOf(side.side)]});
  }
  std::ranges::stable_sort(spokes, {}, &Spoke::angle);
  return spokes;
}

void Join(Side a, Side b, std::vector<Side>& partner) {
  partner[a] = b;
  partner[b] = a;
}

// Pairs the sides of components that come with one side either way; the others remain.
std::vector<Spoke> PairWithThemselves(std::vector<Spoke> spokes, std::vector<Side>& partner) {
  struct Own {
    size_t count = 0;
    const Spoke *first = nullptr, *last = nullptr;
  };
  std::unordered_map<int, Own> of_component;
  for (const Spoke& spoke : spokes) {
    Own& own = of_component[spoke.component];
    if (own.count++ == 0) own.first = &spoke;
    own.last = &spoke;
  }
  std::vector<Spoke> others;
  for (const Spoke& spoke : spokes) {
    const Own& own = of_component[spoke.component];
    if (own.count != 2 || own.first->forward == own.last->forward) {
      others.push_back(spoke);
    } else if (&spoke == own.first) {
      Join(own.first->side, own.last->side, partner);
    }
  }
  return others;
}

}  // namespace

void PairAround(const Triangles& mesh, std::span<const EdgeSide> sides, const std::vector<int>& component,
                std::vector<Side>& partner) {
  const std::vector<Spoke> spokes = PairWithThemselves(SpokesOf(mesh, sides, component), partner);
  const auto forward = std::ranges::count_if(spokes, &Spoke::forward);
  if (2 * static_cast<size_t>(forward) != spokes.size()) return;
  // Material lies ahead (by angle) of a side that runs backward and behind one that runs forward: as brackets
  // open and close. Twice round, since the first bracket met may be a closing one.
  std::vector<Side> open;
  for (size_t i = 0; i < 2 * spokes.size(); ++i) {
    const Spoke& spoke = spokes[i % spokes.size()];
    if (partner[spoke.side] != kNoSide) continue;
    if (!spoke.forward) {
      if (i < spokes.size()) open.push_back(spoke.side);
    } else if (!open.empty()) {
      Join(open.back(), spoke.side, partner);
      open.pop_back();
    }
  }
}

}  // namespace millpose
