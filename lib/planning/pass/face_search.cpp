// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_search.hpp"

#include <numeric>

namespace millpose {
namespace {

constexpr int kCoarse = 3;                 // places of the grid that the first search steps by
constexpr int kCoarseWindow = 2;           // and how many of these steps it may go from point to point
constexpr int kReach = 4;                  // places to either side of what was found, on each finer grid
constexpr int kSearchRounds = 16;          // of searches; what interferes is barred in between
constexpr double kCrossingCost = 2e-3;     // mm: of two ways with the same marks the fewer
constexpr double kDisplacedWeight = 0.02;  // so that a mark is worth 50 times its height of displacement
constexpr double kSlack = 0.05;            // where the limit cannot be kept
constexpr double kRounding = 1 + 1e-9;

int Crossings(const FaceChoiceFigures& figures) {
  return std::accumulate(figures.crossings.begin(), figures.crossings.end(), 0);
}

PathNode NodeOf(const FlankNode& node) {
  return {node.freedoms, node.branch, node.q, node.objective, false, false};
}

const FlankNode* NodeIn(const std::vector<FlankNode>& layer, const FixedPose& at) {
  const auto key = [](const auto& of) { return std::pair(of.branch, of.place); };
  const auto found = std::ranges::lower_bound(layer, key(at), {}, key);
  return found != layer.end() && key(*found) == key(at) ? &*found : nullptr;
}

}  // namespace

/// Within the limit the marks count, and the displacement beside them; beyond it the displacement alone.
bool FaceSearch::Better(const FaceChoiceFigures& a, const FaceChoiceFigures& b) const {
  const bool within_a = a.worst <= limit_ * kRounding, within_b = b.worst <= limit_ * kRounding;
  if (within_a != within_b) return within_a;
  if (!within_a) return a.worst < b.worst;
  return a.worst + a.marks < b.worst + b.marks;
}

std::optional<FaceCandidate> FaceSearch::AtFixed(const FixedPose& at) const {
  std::vector<PathNode> path;
  for (const FlankNode* node : NodesAt(at)) path.push_back(NodeOf(*node));
  return path.empty() ? std::nullopt : segment_.Join(std::move(path));
}

/// The nodes of all layers there; empty where one has none.
std::vector<const FlankNode*> FaceSearch::NodesAt(const FixedPose& at) const {
  std::vector<const FlankNode*> nodes;
  for (const std::vector<FlankNode>& layer : layers_) {
    nodes.push_back(NodeIn(layer, at));
    if (nodes.back() == nullptr) return {};
  }
  return nodes;
}

std::vector<FaceSearch::Fixed> FaceSearch::AllFixed() const {
  std::vector<Fixed> all;
  for (const FlankNode& node : layers_[0]) {
    const FixedPose at{node.place, node.branch};
    const std::vector<const FlankNode*> nodes = NodesAt(at);
    if (nodes.empty()) continue;
    std::vector<PathNode> path;
    std::vector<FacePlace> faces;
    for (const FlankNode* of : nodes) path.push_back(NodeOf(*of)), faces.push_back(of->face);
    if (const auto figures = segment_.FiguresJoined(std::move(path), std::move(faces)))
      all.push_back({at, *figures});
  }
  return all;
}

std::optional<FaceCandidate> FaceSearch::BestFixed(const FaceChoiceFigures& than) {
  std::vector<Fixed> all = AllFixed();
  std::erase_if(all, [&](const Fixed& fixed) { return !Better(fixed.figures, than); });
  std::ranges::stable_sort(all, [&](const Fixed& a, const Fixed& b) { return Better(a.figures, b.figures); });
  for (const Fixed& fixed : all) {
    FaceCandidate candidate = *AtFixed(fixed.at);
    if (!segment_.Hits(candidate).any()) return candidate;
  }
  return std::nullopt;
}

double FaceSearch::Attainable() const {
  double least = kInfinity;
  for (const Fixed& fixed : AllFixed()) least = std::min(least, fixed.figures.worst);
  if (!std::isfinite(least)) {
    const std::vector<std::vector<FlankNode>> coarse = Coarse();
    const std::vector<size_t> nodes = SearchFlanks(coarse, CoarseRules());
    std::vector<PathNode> path;
    for (size_t t = 0; t < nodes.size(); ++t) path.push_back(NodeOf(coarse[t][nodes[t]]));
    if (!path.empty()) least = segment_.Figures(path).worst;
  }
  return least;
}

std::vector<std::vector<FlankNode>> FaceSearch::Coarse() const {
  std::vector<std::vector<FlankNode>> coarse(layers_.size());
  for (size_t t = 0; t < layers_.size(); ++t) {
    for (const FlankNode& node : layers_[t]) {
      if (node.place % kCoarse != 0) continue;
      coarse[t].push_back(node);
      coarse[t].back().place /= kCoarse;
    }
  }
  return coarse;
}

FlankRules FaceSearch::CoarseRules() const {
  FlankRules rules = segment_.Rules();
  rules.window = kCoarseWindow;
  rules.ring = segment_.ring() % kCoarse == 0 ? segment_.ring() / kCoarse : 0;
  rules.displaced_weight = kDisplacedWeight;
  rules.crossing_cost = kCrossingCost;
  rules.limit = limit_;
  rules.slack = kSlack;
  return rules;
}

/// On ever finer grids about a coarse way; with `bar` what interferes is left out where the coarse grid has
/// something barred beside the way. Empty where a grid has no way.
std::vector<FlankNode> FaceSearch::Refined(const std::vector<std::vector<FlankNode>>& coarse,
                                           const std::vector<size_t>& nodes, bool bar) {
  std::vector<FlankNode> path;
  std::vector<bool> asked(nodes.size(), false);
  for (size_t t = 0; t < nodes.size(); ++t) {
    path.push_back(coarse[t][nodes[t]]);
    for (const FlankNode& node : coarse[t])
      if (bar && node.barred && node.branch == path[t].branch &&
          std::abs(node.place - path[t].place) <= kCoarseWindow)
        asked[t] = true;
  }
  FlankRules rules = CoarseRules();
  rules.ring = 0;
  for (const int parts : {1, 4, 16}) {
    // One grid for all layers, as a place must be the same rotation in each; the short way round.
    const double step = segment_.step() / parts, origin = path[0].freedoms[0];
    std::vector<std::vector<FlankNode>> layers(path.size());
    double near = origin, last = 0;
    rules.window = 0;
    for (size_t t = 0; t < path.size(); ++t) {
      const double turn = segment_.ring() > 0 ? segment_.ring() * segment_.step() : 0;
      double at = path[t].freedoms[0];
      if (turn > 0) at -= turn * std::round((at - near) / turn);
      near = at;
      const double places = std::round((at - origin) / step);
      rules.window = std::max(rules.window, 2 * kReach + static_cast<int>(std::abs(places - last)));
      last = places;
      layers[t] = segment_.LayerAround(t, origin + places * step, path[t].branch, step, kReach);
      for (FlankNode& node : layers[t]) node.place += static_cast<int>(places);
    }
    segment_.BarBlocked(path[0].branch, asked, layers);
    const std::vector<size_t> finer = SearchFlanks(layers, rules);
    if (finer.empty()) return parts == 1 ? std::vector<FlankNode>() : path;
    for (size_t t = 0; t < path.size(); ++t) path[t] = layers[t][finer[t]];
  }
  return path;
}

FaceCandidate FaceSearch::Smoothed(FaceCandidate found) {
  FaceCandidate smooth = segment_.Smoothed(found);
  const FaceChoiceFigures &was = found.figures, &is = smooth.figures;
  const bool keeps = is.worst <= std::max(was.worst, limit_) * kRounding &&
                     is.marks <= was.marks * kRounding && Crossings(is) <= Crossings(was);
  return keeps ? std::move(smooth) : std::move(found);
}

/// Coarse, then finer about what was found. Where that interferes, all of the coarse grid's branch is looked
/// at; where motions alone do, what lies beside them is barred, more of it each time.
std::optional<FaceCandidate> FaceSearch::Searched() {
  std::vector<std::vector<FlankNode>> coarse = Coarse();
  const FlankRules rules = CoarseRules();
  std::array<bool, 8> looked_at{};
  std::optional<FaceCandidate> best;
  for (int round = 0; round < kSearchRounds; ++round) {
    const std::vector<size_t> nodes = SearchFlanks(coarse, rules);
    if (nodes.empty()) break;
    const int branch = coarse[0][nodes[0]].branch;
    bool& known = looked_at[static_cast<size_t>(branch)];
    const auto bar_beside = [&](const std::vector<bool>& points, int reach) {
      for (size_t t = 0; t < points.size(); ++t)
        for (FlankNode& node : coarse[t])
          if (points[t] && node.branch == branch && std::abs(node.place - coarse[t][nodes[t]].place) <= reach)
            node.barred = true;
    };
    std::vector<PathNode> path;
    for (const FlankNode& node : Refined(coarse, nodes, known)) path.push_back(NodeOf(node));
    std::optional<FaceCandidate> found;
    if (!path.empty()) found = segment_.Join(std::move(path));
    if (!found) {  // limits: full revolutions, or a finer way that steps too far
      std::vector<bool> ends(nodes.size(), false);
      ends.front() = true;
      bar_beside(ends, 1);
      continue;
    }
    const SegmentHits hits = segment_.Hits(*found);
    if (!hits.any()) {
      // Slower crossings than the search takes them for may exceed the limit: round that place, if any way
      // is.
      std::vector<bool> places(nodes.size(), false);
      size_t worst_at = 0;
      segment_.Figures(found->path, &worst_at);
      places[worst_at] = true;
      if (!best || Better(found->figures, best->figures)) best.emplace(std::move(*found));
      if (best->figures.worst <= limit_ * kRounding || limit_ == 0) break;
      bar_beside(places, 0);
    } else if (!known) {
      segment_.BarBlocked(branch, std::vector<bool>(nodes.size(), true), coarse);
      known = true;
    } else {
      bar_beside(hits.Points(), std::min(round, 2));
    }
  }
  if (!best) return std::nullopt;
  return Smoothed(std::move(*best));
}

bool FaceSearch::Improve(std::pair<FaceWay, FaceCandidate>& best) {
  bool improved = false;
  const auto take = [&](FaceWay way, std::optional<FaceCandidate> candidate) {
    if (!candidate || !Better(candidate->figures, best.second.figures)) return;
    best = {way, std::move(*candidate)};
    improved = true;
  };
  take(FaceWay::kSearched, Searched());
  take(FaceWay::kFixed, BestFixed(best.second.figures));
  return improved;
}

}  // namespace millpose
