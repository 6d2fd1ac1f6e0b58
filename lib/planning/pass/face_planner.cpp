// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_planner.hpp"

#include "base/parallel.hpp"
#include "planning/pass/describe_point.hpp"
#include "planning/pass/face_piece.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/continuity.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

constexpr int kCoarse = 3;   // places of the grid that the first search steps by
constexpr int kRounds = 10;  // of searches; what interferes is barred in between
constexpr double kMarkWeight = 1;
constexpr double kSlack = 0.05;

class PieceFaces {
 public:
  explicit PieceFaces(FacePiece& piece) : piece_(piece), layers_(piece.Layers()) {}

  FaceCandidate Best(FaceCandidate best) {
    if (std::optional<FaceCandidate> found = Searched()) Take(std::move(*found), best);
    if (std::optional<FaceCandidate> fixed = Fixed(best.figures)) Take(std::move(*fixed), best);
    return best;
  }

 private:
  static void Take(FaceCandidate candidate, FaceCandidate& best) {
    if (candidate.figures.worst < best.figures.worst) best = std::move(candidate);
  }

  /// The best fixed rotation that is better than `than`, if one is.
  std::optional<FaceCandidate> Fixed(const FaceFigures& than) {
    std::vector<FaceCandidate> all;
    for (const FlankNode& first : layers_[0]) {
      std::vector<PathNode> nodes;
      for (size_t t = 0; t < layers_.size(); ++t) {
        const FlankNode* same = Find(t, first.branch, first.place);
        if (same == nullptr) break;
        nodes.push_back({same->freedoms, same->branch, same->q, same->objective, false, false});
      }
      if (nodes.size() < layers_.size()) continue;
      std::optional<FaceCandidate> joined = piece_.Join(std::move(nodes));
      if (joined && joined->figures.worst < than.worst) all.push_back(std::move(*joined));
    }
    std::ranges::stable_sort(all, {}, [](const FaceCandidate& of) { return of.figures.worst; });
    for (FaceCandidate& candidate : all)
      if (IsFree(candidate)) return std::move(candidate);
    return std::nullopt;
  }

  bool IsFree(const FaceCandidate& candidate) {
    return std::ranges::count(piece_.Hits(candidate), true) == 0;
  }

  const FlankNode* Find(size_t t, int branch, int place) const {
    for (const FlankNode& node : layers_[t])
      if (node.branch == branch && node.place == place) return &node;
    return nullptr;
  }

  /// Coarse, then finer about what was found; what interferes is barred in the coarse grid, more of it each
  /// time.
  std::optional<FaceCandidate> Searched() {
    std::vector<std::vector<FlankNode>> coarse(layers_.size());
    for (size_t t = 0; t < layers_.size(); ++t)
      for (const FlankNode& node : layers_[t])
        if (node.place % kCoarse == 0) {
          coarse[t].push_back(node);
          coarse[t].back().place /= kCoarse;
        }
    FlankRules rules = piece_.Rules();
    rules.window = 2;
    rules.ring = piece_.ring() / kCoarse;
    rules.mark_weight = kMarkWeight;
    rules.slack = kSlack;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<size_t> nodes = SearchFlanks(coarse, rules);
      if (nodes.empty()) return std::nullopt;
      const std::optional<FaceCandidate> found = Refined(coarse, nodes, rules);
      if (!found) return std::nullopt;
      const std::vector<bool> hits = piece_.Hits(*found);
      if (std::ranges::count(hits, true) == 0) {
        FaceCandidate smooth = piece_.Smoothed(*found);
        return smooth.figures.worst <= found->figures.worst ? smooth : *found;
      }
      for (size_t t = 0; t < hits.size(); ++t)
        for (FlankNode& node : coarse[t])
          if (hits[t] && node.branch == coarse[t][nodes[t]].branch &&
              std::abs(node.place - coarse[t][nodes[t]].place) <= round)
            node.barred = true;
    }
    return std::nullopt;
  }

  std::optional<FaceCandidate> Refined(const std::vector<std::vector<FlankNode>>& coarse,
                                       const std::vector<size_t>& nodes, FlankRules rules) const {
    std::vector<FlankNode> path;
    for (size_t t = 0; t < nodes.size(); ++t) path.push_back(coarse[t][nodes[t]]);
    rules.ring = 0;
    for (const int parts : {1, 4, 16}) {
      constexpr int kReach = 4;
      // One grid for all layers, as a place must be the same rotation in each.
      std::vector<std::vector<FlankNode>> layers(path.size());
      const double step = piece_.step() / parts, origin = path[0].freedoms[0];
      for (size_t t = 0; t < path.size(); ++t) {
        const double turns = std::round((path[t].freedoms[0] - origin) / step);
        layers[t] = piece_.LayerAround(t, origin + turns * step, path[t].branch, step, kReach);
        for (FlankNode& node : layers[t]) node.place += static_cast<int>(turns);
      }
      rules.window = 2 * kReach;
      const std::vector<size_t> finer = SearchFlanks(layers, rules);
      if (finer.empty()) break;
      for (size_t t = 0; t < path.size(); ++t) path[t] = layers[t][finer[t]];
    }
    std::vector<PathNode> joined;
    for (const FlankNode& node : path)
      joined.push_back({node.freedoms, node.branch, node.q, node.objective, false, false});
    return piece_.Join(std::move(joined));
  }

  FacePiece& piece_;
  std::vector<std::vector<FlankNode>> layers_;
};

/// Puts a candidate into the plan in place of a piece.
void Put(const Stations& stations, const Segment& piece, const FaceCandidate& chosen, PassResult& pass) {
  for (size_t i = 0; i < chosen.path.size(); ++i) {
    PlannedPoint& point = pass.points[static_cast<size_t>(piece.first) + i];
    const PathNode& node = chosen.path[i];
    const std::vector<double> freedoms = point.freedoms;
    DescribePoint(stations.Of(pass, static_cast<size_t>(piece.first) + i)->problem, node, point);
    for (size_t d = 1; d < freedoms.size(); ++d) point.freedoms.push_back(freedoms[d]);
    point.unsmoothed = node.objective;
    if (point.objective >= point.free_optimum) continue;
    point.free_optimum = point.objective;
    point.free_rotation = point.freedoms[0];
    point.free_branch = point.branch;
  }
}

}  // namespace

PassResult PlanFace(const Stations& given, const PassResult& pass, const FaceOptions& options,
                    const Execution& execution) {
  const Stations stations = given.AtOwnAxis();
  PassResult result = pass;
  bool changed = false;
  for (const Segment& piece : pass.pieces) {
    FacePiece face(stations, pass, piece, options, execution);
    const FaceCandidate planned = face.AsPlanned();
    const FaceCandidate best = PieceFaces(face).Best(planned);
    result.poses_checked += face.poses_checked();
    if (best.figures.worst >= planned.figures.worst) continue;
    Put(stations, piece, best, result);
    changed = true;
  }
  if (!changed) return result;
  const PlannedIn in(stations, result);
  for (size_t t = 0; t < result.points.size(); ++t) {
    PlannedPoint& point = result.points[t];
    if (point.skip != Infeasibility::kNone) continue;
    Checker checker(in.At(t).world);
    point.clearance = checker.Clearance(point.q, Phase::kCutting, kPointClearanceBound);
  }
  return result;
}

FaceModel ModelOf(const Stations& stations, const GearModel& gears) {
  return {gears, stations.problem().objective->JudgesFace().value_or(ForceBounds{}),
          stations.world().cell().external_axes};
}

std::vector<FaceFigures> FacesOf(const Stations& given, const GearModel& gears, const PassResult& pass) {
  const Stations stations = given.AtOwnAxis();
  const FaceModel model = ModelOf(stations, gears);
  const PlannedIn in(stations, pass);
  std::vector<FaceFigures> faces;
  for (const Segment& piece : pass.pieces) {
    std::vector<FacePlace> places;
    for (auto t = static_cast<size_t>(piece.first); t <= static_cast<size_t>(piece.last); ++t)
      places.push_back(
          FacePlaceAt(in.At(t).problem, model, pass.points[t].point, pass.points[t].q, ExternalAt(pass, t)));
    faces.push_back(FiguresOf(gears.lost, std::move(places), piece.closed));
  }
  return faces;
}

}  // namespace millpose
