// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/piece_planner.hpp"

#include <cassert>
#include <limits>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "motion/cut_feed.hpp"
#include "path/cut_check.hpp"
#include "path/smoothing.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kRounding = 1e-12;  // rad: of angles that full turns were added to
// How often the search runs again over what the checks struck out, before motions that interfere take their
// nodes with them, and before they take their points with them; after that each round removes a point.
constexpr int kRoundsOfMotions = 6, kRoundsOfNodes = 60;
constexpr int kRefineRounds = 5;
// Where a smoothed path interferes it goes back, half-way when met first, then all the way, and turns no
// farther to that side, after so many times, or in the last rounds, to neither; so many points to either side
// may follow.
constexpr int kSmoothRounds = 24, kOneSided = 5, kOneSidedRounds = 12;
constexpr size_t kFollow = 40;

/// `q` moved by whole turns to where each joint is nearest to `near`; exact where none is needed.
Joints Beside(const Joints& near, const Joints& q) {
  Joints moved = q;
  for (int j = 0; j < 6; ++j) {
    const double turns = std::round((near[j] - q[j]) / kTurn);
    if (turns != 0.0) moved[j] += turns * kTurn;
  }
  return moved;
}

class PiecePlanner {
 public:
  PiecePlanner(const PassContext& context, bool all_turns)
      : context_(context),
        carrier_{context.problem.arm, context.problem.X_WB, context.problem.X_FT},
        all_turns_(all_turns),
        count_(context.scorers.size()) {
    rule_.max_step = context.options.max_joint_step;
    rule_.motion_weight = context.options.motion_weight;
    rule_.modulo_turns = !all_turns;
    plan_.nodes.resize(count_);
    plan_.piece.assign(count_, -1);
    plan_.interference.resize(count_);
  }

  std::optional<PassPlan> Plan() {
    MakeLayers();
    TakeSequence(SearchFree());
    double coarse = 0.0, refined = 0.0;
    for (const Piece& piece : plan_.pieces) {
      coarse += Cost(piece);
      RefineFree(piece);
      refined += Cost(piece);
    }
    plan_.grid_gap = refined > 0.0 ? (coarse - refined) / refined : 0.0;
    for (const Piece& piece : plan_.pieces) {
      const bool fits = Unwind(piece);
      assert((fits || !all_turns_) && "nodes of single turns lie within the bounds");
      if (!fits && !all_turns_) return std::nullopt;
    }
    plan_.unsmoothed = plan_.nodes;
    for (const Piece& piece : plan_.pieces) SmoothFree(piece);
    return std::move(plan_);
  }

 private:
  void MakeLayers() {
    layers_.resize(count_);
    ParallelFor(count_, context_.threads, context_.stop, [&](size_t t) {
      const PointScorer& scorer = context_.scorers[t];
      std::vector<NodeSeed> seeds;
      if (!(context_.points[t].gouge > 0)) seeds = GridSeeds(scorer, context_.options.rotation_step);
      const auto add = [&](const PointOptimum& optimum, bool genetic) {
        if (!optimum.found) return;
        seeds.push_back(
            {optimum.freedoms, scorer.ScoreOne(optimum.freedoms, optimum.branch), optimum.branch, genetic});
      };
      add(context_.genetic[t], true);
      // Intervals narrower than the grid: better the judge's answer than a skipped point.
      if (seeds.empty()) add(context_.exhaustive[t], false);
      layers_[t] = MakeLayer(scorer, std::move(seeds), all_turns_);
    });
  }

  /// The layered search, repeated until what it finds is free of interference.
  Sequence SearchFree() {
    StrikeOut strike_out(context_.world, carrier_, layers_, context_.options.swept_resolution,
                         context_.threads, context_.stop);
    // The band needs the one freedom to be the rotation (BandWidth).
    const bool banded =
        context_.problem.freedoms.size() == 1 && context_.problem.freedoms[0]->IsToolRotation();
    const LayeredProblem problem{layers_, rule_,         strike_out.struck_edges(), banded,
                                 banded,  context_.stop, context_.break_before};
    // While there is interference to find, any good closed sequence finds it. A free one is kept when the
    // best of all is hardly cheaper.
    constexpr int kQuickSweeps = 3;
    constexpr double kHardlyCheaper = 1e-3;
    Sequence sequence;
    for (int round = 0;; ++round) {
      std::optional<Sequence> closed;
      if (context_.closed) closed = SearchClosed(problem, kQuickSweeps);
      if (context_.closed && !closed) closed = SearchClosed(problem);
      sequence = closed ? std::move(*closed) : SearchOpen(problem);
      bool free = strike_out.Check(sequence);
      if (free && sequence.closed) {
        std::optional<Sequence> best = SearchClosed(problem);
        if (best && best->cost < (1 - kHardlyCheaper) * sequence.cost) {
          sequence = std::move(*best);
          free = strike_out.Check(sequence);
        }
      }
      if (free) break;
      if (round >= kRoundsOfMotions) {
        strike_out.StrikeBarred(
            sequence, round < kRoundsOfNodes ? StrikeOut::Extent::kNodes : StrikeOut::Extent::kLayers);
      }
    }
    plan_.poses_checked += strike_out.poses_checked();
    plan_.nodes_struck = strike_out.nodes_struck();
    plan_.candidates_checked = strike_out.nodes_checked();
    for (const Layer& layer : layers_) plan_.candidates += static_cast<long long>(layer.size());
    for (size_t t = 0; t < count_; ++t) {
      if (sequence.nodes[t] == kNoNode) plan_.interference[t] = strike_out.detail(t);
    }
    return sequence;
  }

  /// Cuts the sequence into pieces. A piece of one point is no cut; only a pass of one point keeps it.
  void TakeSequence(const Sequence& sequence) {
    for (size_t first = 0; first < count_;) {
      if (sequence.nodes[first] == kNoNode) {
        ++first;
        continue;
      }
      size_t last = first;
      while (last + 1 < count_ && sequence.nodes[last + 1] != kNoNode && !sequence.break_before[last + 1])
        ++last;
      if (last > first || count_ == 1) {
        Piece piece;
        piece.piece = static_cast<int>(plan_.pieces.size());
        piece.first = static_cast<int>(first);
        piece.last = static_cast<int>(last);
        piece.closed = sequence.closed;
        for (size_t t = first; t <= last; ++t) {
          plan_.piece[t] = piece.piece;
          plan_.nodes[t] = NodeOf(layers_[t], sequence.nodes[t]);
        }
        plan_.pieces.push_back(piece);
      }
      first = last + 1;
    }
  }

  static PathNode NodeOf(const Layer& layer, size_t node) {
    return {layer.freedoms[node],  layer.BranchOf(node),      layer.joints.At(node),
            layer.objective[node], bool(layer.genetic[node]), false};
  }

  std::span<PathNode> NodesOf(const Piece& piece) {
    return std::span(plan_.nodes).subspan(piece.first, piece.last - piece.first + 1);
  }

  double Cost(const Piece& piece) { return PathCost(NodesOf(piece), rule_, piece.closed); }

  /// Refines a piece. Where the finer path interferes, its points go back to the coarse one, which is free,
  /// with ever more of their neighbours, and the rest is refined again.
  void RefineFree(const Piece& piece) {
    RefineOptions options;
    options.rule = rule_;
    options.first_step = context_.options.rotation_step;
    options.last_step = DegToRad(0.002);
    options.closed = piece.closed;
    options.all_turns = all_turns_;
    options.stop = context_.stop;
    const std::span<PathNode> path = NodesOf(piece);
    const std::vector<PathNode> coarse(path.begin(), path.end());
    std::vector<bool> frozen(path.size(), false);
    for (int round = 0; round < kRefineRounds; ++round) {
      for (size_t i = 0; i < path.size(); ++i) {
        path[i] = coarse[i];
        path[i].frozen = frozen[i];
      }
      RefinePath(std::span(context_.scorers).subspan(piece.first, path.size()),
                 std::span(context_.genetic).subspan(piece.first, path.size()), options, path);
      if (FreezeWhatInterferes(piece, round, frozen)) return;
    }
    std::copy(coarse.begin(), coarse.end(), path.begin());
  }

  /// Points of a piece that interfere, or are at an end of a motion that does. Points whose pose is `known`
  /// to be free are not looked at, nor are motions between two of them.
  std::vector<bool> Interfering(const Piece& piece, const std::vector<bool>& known) {
    const std::span<const PathNode> path = NodesOf(piece);
    std::vector<char> hit(path.size(), 0), hit_after(path.size(), 0);
    plan_.poses_checked += CheckInParallel(
        context_.world, path.size(), context_.threads, context_.stop, [&](Checker& checker, size_t i) {
          if (!known[i]) hit[i] = checker.At(path[i].q, Phase::kCutting).has_value();
          const size_t next = (i + 1) % path.size();
          if ((next == 0 && !piece.closed) || (known[i] && known[next])) return;
          hit_after[i] = !CheckCut(checker, carrier_, path[i].q, Beside(path[i].q, path[next].q),
                                   context_.options.swept_resolution)
                              .empty();
        });
    std::vector<bool> interfering(path.size(), false);
    for (size_t i = 0; i < path.size(); ++i) {
      if (hit[i] || hit_after[i]) interfering[i] = true;
      if (hit_after[i]) interfering[(i + 1) % path.size()] = true;
    }
    return interfering;
  }

  /// The points of `marked` and `reach` more to either side, round the end of a closed piece.
  static std::vector<bool> Widened(const std::vector<bool>& marked, size_t reach, bool closed) {
    const size_t count = marked.size();
    reach = std::min(reach, count - 1);
    std::vector<bool> wide(count, false);
    for (size_t i = 0; i < count; ++i) {
      for (size_t k = 0; marked[i] && k <= 2 * reach; ++k) {
        const size_t at = i + k;  // reach too far
        if (closed || (at >= reach && at - reach < count)) wide[(at + count - reach) % count] = true;
      }
    }
    return wide;
  }

  /// Checks the nodes of a refined piece and the motions between them; marks the points that must go back,
  /// with 4^round − 1 neighbours to either side. True when there are none.
  bool FreezeWhatInterferes(const Piece& piece, int round, std::vector<bool>& frozen) {
    const std::vector<bool> hit = Interfering(piece, frozen);
    const std::vector<bool> wide = Widened(hit, (size_t{1} << (2 * round)) - 1, piece.closed);
    for (size_t i = 0; i < wide.size(); ++i) frozen[i] = frozen[i] || wide[i];
    return std::find(hit.begin(), hit.end(), true) == hit.end();
  }

  /// Smooths a piece. Where the smoothed path interferes its points go back towards where they were, which is
  /// free, with ever more of their neighbours, and those beside them are smoothed again.
  void SmoothFree(const Piece& piece) {
    const std::span<PathNode> path = NodesOf(piece);
    const std::vector<PathNode> origin(path.begin(), path.end());
    const auto points = context_.points.subspan(piece.first, path.size());
    const auto scorers = std::span(context_.scorers).subspan(piece.first, path.size());
    SmoothOptions options;
    for (const PathNode& node : origin) options.objective += node.objective;
    options.loss = context_.options.smoothing_loss;
    options.max_step = context_.options.max_joint_step;
    options.max_deviation = context_.options.max_deviation;
    options.closed = piece.closed;
    options.stop = context_.stop;
    const Freedom& freedom = *context_.problem.freedoms[0];
    const double wide = freedom.Periodic() ? std::numeric_limits<double>::infinity() : 0;
    std::vector<FreedomRange> ranges(path.size(), {freedom.Lower() - wide, freedom.Upper() + wide});
    std::vector<FreedomRange> fixed = ranges;  // as ranges, but where nothing interferes for now
    std::vector<PathNode> checked = origin;
    std::vector<int> met(path.size(), 0);  // how often a point interfered
    for (int round = 0; round < kSmoothRounds; ++round) {
      SmoothPath(scorers, points, fixed, options, path);
      if (!Fits(piece)) break;
      std::vector<bool> known(path.size());
      for (size_t i = 0; i < path.size(); ++i) known[i] = path[i].q == checked[i].q;
      std::vector<bool> hit = Interfering(piece, known);
      MarkLongSteps(piece, hit);
      if (std::find(hit.begin(), hit.end(), true) == hit.end()) {
        if (SquareOf(points, path) <= SquareOf(points, origin)) return;
        break;
      }
      std::copy(path.begin(), path.end(), checked.begin());
      Count(hit, met);
      const std::vector<int> level = Levels(hit, met, piece.closed);
      for (size_t i = 0; i < path.size(); ++i) met[i] = std::max(met[i], level[i]);
      std::vector<bool> back(path.size());
      for (size_t i = 0; i < path.size(); ++i) back[i] = level[i] > 0;
      const std::vector<bool> beside = Widened(back, kFollow, piece.closed);
      for (size_t i = 0; i < path.size(); ++i) {
        const double now = path[i].freedoms[0], was = origin[i].freedoms[0];
        if (back[i]) {
          const bool both = level[i] > kOneSided || round >= kOneSidedRounds;
          path[i] = GoneBack(scorers[i], origin[i], path[i], level[i] > 1 || both ? 0 : 0.5);
          if (now >= was || both) ranges[i].upper = path[i].freedoms[0];
          if (now <= was || both) ranges[i].lower = path[i].freedoms[0];
        }
        // In the last rounds nothing else moves any more, so that these end.
        const bool moves = beside[i] && round < kOneSidedRounds;
        const double stays = path[i].freedoms[0];
        fixed[i] = {moves ? ranges[i].lower : stays, moves ? ranges[i].upper : stays};
      }
    }
    std::copy(origin.begin(), origin.end(), path.begin());
  }

  /// Counts hits. A point beside others that were met before counts with them: where the border of what went
  /// back interferes next, it must not begin anew.
  static void Count(const std::vector<bool>& hit, std::vector<int>& met) {
    constexpr size_t kBeside = 2;
    const std::vector<int> before = met;
    for (size_t i = 0; i < hit.size(); ++i) {
      if (!hit[i]) continue;
      const size_t first = i - std::min(i, kBeside), last = std::min(i + kBeside, hit.size() - 1);
      met[i] = 1 + *std::max_element(before.begin() + static_cast<std::ptrdiff_t>(first),
                                     before.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    }
  }

  /// Points at the ends of joint steps beyond the bounds, as where some went back and others did not.
  void MarkLongSteps(const Piece& piece, std::vector<bool>& marked) {
    const std::span<const PathNode> path = NodesOf(piece);
    for (size_t i = 0; i < path.size(); ++i) {
      const size_t next = (i + 1) % path.size();
      if (next == 0 && !piece.closed) continue;
      const Joints step = (path[next].q - path[i].q).unaryExpr(&ShortWay);
      bool long_step = false;
      for (int j = 0; j < 6; ++j) long_step = long_step || std::abs(step[j]) > rule_.max_step[j] + kRounding;
      if (long_step) marked[i] = marked[next] = true;
    }
  }

  /// Mean square of the joint accelerations along a path, as the report has it.
  static double SquareOf(std::span<const MillingPoint> points, std::span<const PathNode> path) {
    std::vector<CutSample> cut;
    for (size_t i = 0; i < path.size(); ++i) {
      if (i > 0 && points[i].arc_length <= cut.back().arc_length) continue;
      cut.push_back({path[i].q, points[i].arc_length, points[i].feed_rate});
    }
    return TimeRms(cut, RatesAlong(cut).acceleration).squaredNorm();
  }

  /// For points that go back, how often what takes them along was met: a point met k times takes 2^(k−1) − 1
  /// neighbours to either side. 0 for points that stay.
  static std::vector<int> Levels(const std::vector<bool>& hit, const std::vector<int>& met, bool closed) {
    std::vector<int> level(hit.size(), 0);
    const int most = *std::max_element(met.begin(), met.end());
    for (int k = 1; k <= most; ++k) {
      std::vector<bool> marked(hit.size());
      for (size_t i = 0; i < hit.size(); ++i) marked[i] = hit[i] && met[i] == k;
      const std::vector<bool> wide = Widened(marked, (size_t{1} << std::min(k - 1, 30)) - 1, closed);
      for (size_t i = 0; i < hit.size(); ++i) {
        if (wide[i]) level[i] = k;
      }
    }
    return level;
  }

  /// A point on `share` of its way from where it was; there itself where that pose is not admissible.
  static PathNode GoneBack(const PointScorer& scorer, const PathNode& was, const PathNode& now,
                           double share) {
    PathNode node = was;
    node.freedoms[0] += share * (now.freedoms[0] - was.freedoms[0]);
    const Candidate candidate = scorer.ScoreOne(node.freedoms, node.branch);
    if (share == 0 || candidate.admissibility != Admissibility::kAdmissible) return was;
    node.q = Beside(was.q, candidate.q);
    node.objective = candidate.objective;
    return node;
  }

  /// Makes the joints of a piece continuous and moves each by as few full turns as bring all of the piece
  /// within the bounds. False when no number of turns does.
  bool Unwind(const Piece& piece) {
    const std::span<PathNode> path = NodesOf(piece);
    for (size_t i = 1; i < path.size(); ++i) path[i].q = Beside(path[i - 1].q, path[i].q);
    const auto [least, most] = Extent(piece);
    const AdmissibleBounds& bounds = context_.problem.bounds;
    for (int j = 0; j < 6; ++j) {
      bool fits = false;
      for (const int turns : {0, -1, 1, -2, 2}) {
        const double shift = turns * kTurn;
        if (least[j] + shift < bounds.lower[j] - kRounding || most[j] + shift > bounds.upper[j] + kRounding) {
          continue;
        }
        for (PathNode& node : path) node.q[j] += shift;
        fits = true;
        break;
      }
      if (!fits) return false;
    }
    return true;
  }

  /// Least and largest angles along a piece whose joints are continuous.
  std::pair<Joints, Joints> Extent(const Piece& piece) {
    const std::span<const PathNode> path = NodesOf(piece);
    Joints least = path[0].q, most = path[0].q;
    for (const PathNode& node : path) {
      least = least.cwiseMin(node.q);
      most = most.cwiseMax(node.q);
    }
    if (piece.closed) {  // back to the first point, by whatever turns the way round has made
      const Joints end = Beside(path.back().q, path[0].q);
      least = least.cwiseMin(end);
      most = most.cwiseMax(end);
    }
    return {least, most};
  }

  bool Fits(const Piece& piece) {
    const auto [least, most] = Extent(piece);
    const AdmissibleBounds& bounds = context_.problem.bounds;
    return (least.array() >= bounds.lower.array() - kRounding).all() &&
           (most.array() <= bounds.upper.array() + kRounding).all();
  }

  const PassContext& context_;
  Carrier carrier_;
  bool all_turns_;
  size_t count_;
  StepRule rule_;
  std::vector<Layer> layers_;
  PassPlan plan_;
};

}  // namespace

std::optional<PassPlan> PlanPieces(const PassContext& context, bool all_turns) {
  return PiecePlanner(context, all_turns).Plan();
}

}  // namespace millpose
