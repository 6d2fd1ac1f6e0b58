// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_score.hpp"

#include <numeric>
#include <tuple>

#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "machine/collision/point_memory.hpp"
#include "machine/robot/make_pose.hpp"
#include "planning/links/retract.hpp"
#include "planning/pose/candidate_table.hpp"
#include "planning/pose/lean_problem.hpp"
#include "run/placement/sample.hpp"

namespace millpose {
namespace {

constexpr double kRotationStep = DegToRad(5);
constexpr size_t kMostLooks = 64;  // at one point on one branch for interference, from its best candidate on
constexpr size_t kReach = 6;       // rotation steps between neighbouring sampled points
constexpr size_t kPart = 8;        // passes that share a checker

/// The points of a pass, all on one branch.
struct BranchScore {
  std::vector<ScoredPoint> points;
  size_t free = 0;
  double worst = 0;
};

bool IsBetter(const BranchScore& a, const BranchScore& b) {
  return a.free != b.free ? a.free > b.free : a.worst < b.worst;
}

constexpr double kNone = std::numeric_limits<double>::infinity();

/// A pass on one branch: of each point one rotation, not far from those of its neighbours, the worst point
/// first, then the sum.
class BranchLadder {
 public:
  BranchLadder(const AdmissibleBounds& bounds, const std::vector<CandidateTable>& tables, size_t branch)
      : bounds_(bounds), tables_(tables) {
    for (const CandidateTable& table : tables) {
      Layer layer{std::vector<Node>(table.settings())};
      for (size_t i = 0; i < table.entries().size(); ++i) {
        const CandidateTable::Entry& entry = table.entries()[i];
        if (entry.branch != branch) continue;
        layer.nodes[entry.setting] = {entry.objective, i};
      }
      layers_.push_back(std::move(layer));
    }
  }

  /// Interference left aside.
  BranchScore Bound() const { return Result(Choose()); }

  /// What is asked of candidates: whether the arm may stand so, and whether it can leave a pass there, which
  /// costs far more.
  struct Looks {
    std::function<bool(size_t point, const Joints& q, const FreedomValues& freedoms)> stands;
    std::function<bool(size_t point, const Joints& q)> leaves;
  };
  /// Looked at for interference; something no better than `best` where it cannot be better.
  BranchScore Score(const Looks& look, const std::optional<BranchScore>& best) {
    size_t looks = 0;
    const auto stands = [&](size_t t, const Node& node, size_t setting) {
      ++looks;
      return look.stands(t, tables_[t].entries()[node.entry].q, tables_[t].Setting(setting));
    };
    const auto leaves = [&](size_t t, const Node& node, size_t) {
      return look.leaves(t, tables_[t].entries()[node.entry].q);
    };
    while (true) {
      const std::vector<Choice> chosen = Choose();
      const BranchScore bound = Result(chosen);
      // Where all points are free no pass that is broken or lacks one is better, and each node less makes the
      // worst of the others no less.
      if (best && best->free == layers_.size() && !IsBetter(bound, *best)) return bound;
      if (AllAre(&Node::stands, chosen, stands) && AllAre(&Node::leaves, chosen, leaves)) return bound;
      if (looks > kMostLooks * layers_.size()) return Result(std::vector<Choice>(layers_.size()));
    }
  }

 private:
  static constexpr size_t kNoSetting = std::numeric_limits<size_t>::max();
  struct Node {
    double objective = kNone;
    size_t entry = 0;
    bool stands = false, leaves = false;  ///< free of interference, as looked at
  };
  struct Layer {
    std::vector<Node> nodes;
    bool blocked = false;  ///< some node interferes
  };
  struct Cost {
    size_t breaks = 0;
    double worst = kNone, sum = kNone;
    bool any() const { return worst < kNone; }
    bool operator<(const Cost& other) const {  // what is none comes last
      if (any() != other.any()) return any();
      return std::tie(breaks, worst, sum) < std::tie(other.breaks, other.worst, other.sum);
    }
  };
  /// What is chosen of a layer. A pass that no way leads along is broken: there the tool is lifted.
  struct Choice {
    size_t setting = kNoSetting;
    bool after_break = false;
  };

  /// Looks at those of the chosen nodes that it is not known of, and takes out the others; returns whether
  /// none was taken out.
  template <class Look>
  bool AllAre(bool Node::*what, const std::vector<Choice>& chosen, const Look& look) {
    bool all = true;
    for (size_t t = 0; t < layers_.size(); ++t) {
      const size_t setting = chosen[t].setting;
      if (setting == kNoSetting) continue;
      Node& node = layers_[t].nodes[setting];
      if (node.*what) continue;
      node.*what = look(t, node, setting);
      if (node.*what) continue;
      all = false;
      node.objective = kNone;
      layers_[t].blocked = true;
    }
    return all;
  }

  /// Of every layer; no setting where no node is left.
  std::vector<Choice> Choose() const {
    std::vector<size_t> used;
    for (size_t t = 0; t < layers_.size(); ++t)
      if (std::ranges::any_of(layers_[t].nodes, [](const Node& node) { return node.objective < kNone; }))
        used.push_back(t);
    std::vector<Choice> chosen(layers_.size());
    if (used.empty()) return chosen;
    const size_t count = layers_.front().nodes.size();
    std::vector<std::vector<Choice>> from(used.size(), std::vector<Choice>(count));
    std::vector<Cost> before(count, Cost{0, 0, 0}), now(count);
    for (size_t u = 0; u < used.size(); ++u) {
      const std::vector<Node>& nodes = layers_[used[u]].nodes;
      const size_t reach = u == 0 ? 0 : kReach;
      const auto least = static_cast<size_t>(std::min_element(before.begin(), before.end()) - before.begin());
      for (size_t s = 0; s < count; ++s) {
        now[s] = {};
        if (nodes[s].objective == kNone) continue;
        size_t best = kNoSetting;
        for (size_t d = 0; d <= 2 * reach; ++d) {
          const size_t other = (s + count + d - reach) % count;
          if (before[other].any() && (best == kNoSetting || before[other] < before[best]) &&
              (u == 0 || Leads(used[u - 1], other, used[u], s)))
            best = other;
        }
        const bool broken = best == kNoSetting || before[least].breaks + 1 < before[best].breaks;
        if (broken) best = least;
        from[u][s] = {best, broken};
        now[s] = {before[best].breaks + (broken ? 1 : 0), std::max(before[best].worst, nodes[s].objective),
                  before[best].sum + nodes[s].objective};
      }
      std::swap(before, now);
    }
    auto s = static_cast<size_t>(std::min_element(before.begin(), before.end()) - before.begin());
    for (size_t u = used.size(); u-- > 0;) {
      chosen[used[u]] = {s, from[u][s].after_break};
      s = from[u][s].setting;
    }
    return chosen;
  }

  /// Whether the joints can go from a node of layer t to one of layer u without a limit between them. An axis
  /// with far more than a turn goes round as far as it must.
  bool Leads(size_t t, size_t from, size_t u, size_t to) const {
    const Joints& q0 = tables_[t].entries()[layers_[t].nodes[from].entry].q;
    const Joints& q1 = tables_[u].entries()[layers_[u].nodes[to].entry].q;
    for (int j = 0; j < 6; ++j)
      if (std::abs(q1[j] - q0[j]) > kPi && bounds_.upper[j] - bounds_.lower[j] < 3 * kPi) return false;
    return true;
  }

  BranchScore Result(const std::vector<Choice>& chosen) const {
    BranchScore score;
    for (size_t t = 0; t < layers_.size(); ++t) {
      const Choice& choice = chosen[t];
      if (choice.setting != kNoSetting && choice.after_break) {
        score.points.push_back({Infeasibility::kStep, 0});
      } else if (choice.setting != kNoSetting) {
        score.points.push_back({Infeasibility::kNone, layers_[t].nodes[choice.setting].objective});
        ++score.free;
        score.worst = std::max(score.worst, score.points.back().objective);
      } else if (tables_[t].entries().empty()) {
        score.points.push_back({tables_[t].reason(), 0});
      } else {
        score.points.push_back({layers_[t].blocked ? Infeasibility::kInterference : Infeasibility::kStep, 0});
      }
    }
    return score;
  }

  const AdmissibleBounds& bounds_;
  const std::vector<CandidateTable>& tables_;
  std::vector<Layer> layers_;
};

/// What a pass is scored with.
struct PassScorer {
  const PoseProblem& problem;
  RetractOptions leave;
  Checker& checker;

  /// A pass stays on one branch: the one that is best for it, more free points first, then the least worst.
  /// Its ends must have room for the retract.
  std::vector<ScoredPoint> Score(const Pass& pass) const {
    std::vector<CandidateTable> tables;
    for (const MillingPoint& point : pass.points)
      tables.push_back(
          CandidateTable::OfStep(PointScorer(problem, point, pass.rotation_reference), kRotationStep));
    std::vector<std::pair<BranchScore, size_t>> bounds;
    std::vector<BranchLadder> ladders;
    for (size_t branch = 0; branch < 8; ++branch) {
      ladders.emplace_back(problem.bounds, tables, branch);
      bounds.emplace_back(ladders.back().Bound(), branch);
    }
    std::ranges::stable_sort(bounds, [](const auto& a, const auto& b) { return IsBetter(a.first, b.first); });
    const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
    std::vector<PointMemory> memories(tables.size());
    const BranchLadder::Looks looks{[&](size_t t, const Joints& q, const FreedomValues& freedoms) {
                                      return !checker.Blocked(q, Phase::kCutting, freedoms, memories[t]);
                                    },
                                    [&](size_t t, const Joints& q) {
                                      const bool end = t == 0 || (!pass.closed && t + 1 == tables.size());
                                      return !end || CanLeave(checker, carrier, q, leave);
                                    }};
    std::optional<BranchScore> best;
    for (const auto& [bound, branch] : bounds) {
      if (best && !IsBetter(bound, *best)) break;
      BranchScore score = ladders[branch].Score(looks, best);
      if (!best || IsBetter(score, *best)) best = std::move(score);
    }
    return best->points;
  }
};

OperationScore SumOf(const std::vector<ScoredPoint>& points) {
  OperationScore score;
  for (const ScoredPoint& point : points) {
    ++score.points[static_cast<size_t>(point.obstacle)];
    if (point.obstacle != Infeasibility::kNone) continue;
    score.worst = std::max(score.worst, point.objective);
    score.mean += point.objective;
  }
  if (const size_t free = score.points.front(); free > 0) score.mean /= static_cast<double>(free);
  return score;
}

/// The cell's bodies that stand still, and those to keep out of.
Cell StandingBodies(const JobInputs& inputs, const Cell& cell) {
  Cell standing = cell;
  standing.excluded_pairs.clear();
  std::erase_if(standing.bodies, [](const Body& body) {
    return body.mount == Mount::kTool || (body.mount == Mount::kLink && body.link > 0);
  });
  for (const KeepOutSettings& keep_out : inputs.job.placement->keep_out)
    standing.bodies.push_back(MakeKeepOut(keep_out, inputs.keep_out_bytes));
  return standing;
}

}  // namespace

size_t PlaceScore::total() const {
  size_t count = 0;
  for (const OperationScore& score : operations)
    count += std::accumulate(score.points.begin(), score.points.end(), size_t{0});
  return count;
}

size_t PlaceScore::free() const { return Count(Infeasibility::kNone); }

size_t PlaceScore::Count(Infeasibility obstacle) const {
  size_t count = 0;
  for (const OperationScore& score : operations) count += score.points[static_cast<size_t>(obstacle)];
  return count;
}

PlaceScorer::PlaceScorer(const std::vector<JobInputs>& inputs, const Execution& execution) : inputs_(inputs) {
  count_ = static_cast<size_t>(inputs.front().job.placement->points);
  for (const JobInputs& own : inputs) {
    prepared_.push_back(PrepareJob(own, NoCheckpoints{}, execution));
    samples_.push_back(millpose::SampleOf(prepared_.back().made.toolpath, count_));
  }
  standing_.emplace(StandingBodies(inputs.front(), prepared_.front().cell));
  for (const std::string& name : standing_->TouchedBy(Mover()))
    if (std::ranges::none_of(inputs.front().job.placement->keep_out,
                             [&](const KeepOutSettings& body) { return body.name == name; }))
      stands_on_.push_back(name);
}

bool PlaceScorer::robot() const { return inputs_.front().job.placement->moves == PlaceMoves::kRobot; }

Mount PlaceScorer::Mover() const { return robot() ? Mount::kLink : Mount::kWorkpiece; }

std::pair<Pose, Pose> PlaceScorer::PosesAt(const PoseSettings& place, size_t operation) const {
  const Cell& cell = prepared_[operation].cell;
  if (robot()) {
    const Pose X_SB = MakePose(inputs_.front().cell.stated_base).inverse(Eigen::Isometry) * cell.X_WB;
    return {MakePose(place) * X_SB, cell.X_WP};
  }
  WorkpieceSettings settings = inputs_.front().job.workpiece;
  settings.pose = place;
  return {cell.X_WB, MakeWorkpiecePose(settings, cell.X_WB)};
}

std::string PlaceScorer::Touches(const Pose& X_WB, const Pose& X_WP) const {
  for (const std::string& name : standing_->With(X_WB, X_WP).TouchedBy(Mover()))
    if (std::ranges::find(stands_on_, name) == stands_on_.end()) return name;
  return "";
}

std::vector<ScoredPoint> PlaceScorer::ScorePoints(size_t operation, const Toolpath& sample,
                                                  const World& world, const Execution& execution) const {
  const PreparedJob& prepared = prepared_[operation];
  const Toolpath placed = PlacedToolpath(inputs_[operation], sample, world.cell().X_WP);
  PoseProblem problem = AtOwnAxis(prepared.problem);
  problem.X_WB = world.cell().X_WB;
  const RetractOptions leave = MakeLinkMoveOptions(inputs_[operation].job).leave;
  std::vector<std::vector<ScoredPoint>> passes(placed.passes.size());
  const size_t parts = (passes.size() + kPart - 1) / kPart;
  ParallelFor(parts, execution.Threads(), execution.stop, [&](size_t part) {
    Checker checker(world);
    for (size_t i = part * kPart; i < std::min(passes.size(), (part + 1) * kPart); ++i)
      passes[i] = PassScorer{problem, leave, checker}.Score(placed.passes[i]);
  });
  std::vector<ScoredPoint> points;
  for (const std::vector<ScoredPoint>& pass : passes) points.insert(points.end(), pass.begin(), pass.end());
  return points;
}

Samples PlaceScorer::SampleOf(const PathSection& share) const {
  Samples samples;
  for (const PreparedJob& prepared : prepared_)
    samples.push_back(millpose::SampleOf(Shared(prepared.made.toolpath, share), count_));
  return samples;
}

std::vector<ScoredPoint> PlaceScorer::Points(const PoseSettings& place, const Execution& execution) const {
  const auto [X_WB, X_WP] = PosesAt(place, 0);
  const World world = prepared_.front().world.With(X_WB, X_WP);
  if (!Touches(X_WB, X_WP).empty() || Checker(world).Blocked(world.cell().home, Phase::kFree))
    return std::vector<ScoredPoint>(CountPoints(samples_.front()),
                                    ScoredPoint{Infeasibility::kInterference, 0});
  return ScorePoints(0, samples_.front(), world, execution);
}

PlaceScore PlaceScorer::Score(const PoseSettings& place, const Samples& samples,
                              const Execution& execution) const {
  PlaceScore score;
  score.place = place;
  for (size_t i = 0; i < prepared_.size() && score.touches.empty(); ++i)
    score.touches = std::apply([&](const Pose& X_WB, const Pose& X_WP) { return Touches(X_WB, X_WP); },
                               PosesAt(place, i));
  score.operations.resize(prepared_.size());
  for (size_t i = 0; i < prepared_.size(); ++i) {
    const auto [X_WB, X_WP] = PosesAt(place, i);
    const World world = prepared_[i].world.With(X_WB, X_WP);
    if (score.touches.empty() && Checker(world).Blocked(world.cell().home, Phase::kFree))
      score.touches = "home";
    if (!score.touches.empty()) {  // not looked at any further
      score.operations[i].points[static_cast<size_t>(Infeasibility::kInterference)] = CountPoints(samples[i]);
      continue;
    }
    score.operations[i] = SumOf(ScorePoints(i, samples[i], world, execution));
  }
  return score;
}

}  // namespace millpose
