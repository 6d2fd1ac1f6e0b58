// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/flank_search.hpp"

#include <bit>

#include "base/parallel.hpp"
#include "planning/ladder/edge_kernel.hpp"

namespace millpose {
namespace {

constexpr size_t kStates = 64;  // of six gears: bit i is set where gear i has gone in its + direction last
constexpr uint32_t kNoState = std::numeric_limits<uint32_t>::max();
constexpr double kStill = 1e-8;          // rad: a joint that moves by less keeps its flank
constexpr size_t kFewCandidates = 1024;  // of a ring: each of its first layer is tried as its start
constexpr int kStartsApart = 2;          // places, of many

/// What each state costs at a node.
struct StateCosts {
  std::array<double, kStates> displaced;  ///< largest displacement; 0 where the place does not count
  std::array<double, kStates> marks;      ///< of the gears whose bits are set, when they cross there
  uint8_t pressed = 0, pressed_to = 0;    ///< gears whose flank the load says, and their bits then

  StateCosts(const FlankRules& rules, const FlankNode& node) {
    const LostMotion& lost = rules.lost;
    const FacePlace& face = node.face;
    for (unsigned i = 0; i < 6; ++i) {
      const double load = face.gears.place.load[i];
      if (std::abs(load) <= lost.friction[i]) continue;
      pressed |= 1U << i;
      if (load < 0) pressed_to |= 1U << i;  // pressed behind its input, where going on in + leaves it
    }
    double beside = 0;  // of external axes, which come from their + direction
    for (Eigen::Index i = 6; i < kMostGears; ++i) beside -= 0.5 * lost.width[i] * face.gears.levers[i];
    for (unsigned state = 0; state < kStates; ++state) {
      double displacement = beside;
      marks[state] = 0;
      for (unsigned i = 0; i < 6; ++i) {
        const double half = 0.5 * lost.width[i] * face.gears.levers[i];
        const bool set = ((state >> i) & 1U) != 0;
        displacement += set ? -half : half;
        if (set && face.counts && half != 0) marks[state] += 2 * std::abs(half) + rules.crossing_cost;
      }
      displaced[state] = face.counts ? LargestWith(face, displacement) : 0;
    }
  }
  unsigned Pressed(unsigned state) const { return (state & ~unsigned{pressed}) | pressed_to; }
};

/// Values of the ways to the nodes of a layer in each state; `reached` says which are finite.
struct FlankRow {
  std::vector<double> value;
  std::vector<uint64_t> reached;

  explicit FlankRow(size_t nodes) : value(nodes * kStates, kInfinity), reached(nodes, 0) {}
  double& At(size_t node, unsigned state) { return value[node * kStates + state]; }
};

/// Nodes of a layer by branch and place.
class NodeIndex {
 public:
  NodeIndex(const std::vector<FlankNode>& layer, int ring) : ring_(ring) {
    if (layer.empty()) return;
    int last = 0;
    first_ = last = layer.front().place;
    for (const FlankNode& node : layer)
      first_ = std::min(first_, node.place), last = std::max(last, node.place);
    if (ring > 0) first_ = 0, last = ring - 1;
    size_ = last - first_ + 1;
    at_.assign(8 * static_cast<size_t>(size_), -1);
    for (size_t i = 0; i < layer.size(); ++i)
      at_[static_cast<size_t>(layer[i].branch * size_ + layer[i].place - first_)] = static_cast<int>(i);
  }
  /// −1 where there is none.
  int At(int branch, int place) const {
    int at = place - first_;
    if (ring_ > 0) at = (at % ring_ + ring_) % ring_;
    return at < 0 || at >= size_
               ? -1
               : at_[static_cast<size_t>(branch) * static_cast<size_t>(size_) + static_cast<size_t>(at)];
  }

 private:
  int ring_, first_ = 0, size_ = 0;
  std::vector<int> at_;
};

class FlankSearch {
 public:
  FlankSearch(std::span<const std::vector<FlankNode>> layers, const FlankRules& rules)
      : layers_(layers), rules_(rules) {
    for (unsigned i = 0; i < 6; ++i)
      if (rules.lost.width[i] > 0) active_ |= 1U << i;
    for (const auto& layer : layers) {
      index_.emplace_back(layer, rules.ring);
      costs_.emplace_back();
      for (const FlankNode& node : layer) costs_.back().emplace_back(rules, node);
    }
  }

  std::vector<size_t> Search() {
    if (!rules_.closed) return SearchFrom(kNone);
    const size_t start = StartOfRing();
    return start == kNone ? std::vector<size_t>() : SearchFrom(start);
  }

 private:
  enum class Kind : uint8_t { kWorst, kSum };
  static constexpr size_t kNone = std::numeric_limits<size_t>::max();

  std::vector<size_t> SearchFrom(size_t start) {
    const double worst = Sweep(Kind::kWorst, start, kInfinity, false);
    if (!std::isfinite(worst)) return {};
    Sweep(Kind::kSum, start, LimitFor(worst), true);
    return Way();
  }

  double LimitFor(double worst) const {
    constexpr double kSlightly = 1 + 1e-9;
    return std::max(rules_.limit, worst * (1 + rules_.slack)) * kSlightly;
  }

  /// The nodes of the last sweep that was kept.
  std::vector<size_t> Way() const {
    std::vector<size_t> nodes(before_.size());
    uint32_t at = last_;
    for (size_t t = before_.size(); t-- > 0; at = t > 0 ? before_[t][at] : at) nodes[t] = at / kStates;
    return nodes;
  }

  /// A node of the first layer that a good way round comes back to; kNone where no way does.
  size_t StartOfRing() {
    size_t candidates = 0, start = kNone;
    double least = kInfinity;
    const auto attempt = [&](size_t node) {
      const double worst = Sweep(Kind::kWorst, node, least, false);
      if (worst < least) least = worst, start = node;
    };
    for (const auto& layer : layers_) candidates += layer.size();
    const bool many = candidates > kFewCandidates;
    if (many) {
      // Where the second of two rounds begins, the first has lost what it began with.
      laps_ = 2;
      const double worst = Sweep(Kind::kWorst, kNone, kInfinity, false);
      if (!std::isfinite(worst)) {
        laps_ = 1;
        return kNone;
      }
      Sweep(Kind::kSum, kNone, LimitFor(worst), true);
      const std::vector<size_t> way = Way();
      laps_ = 1;
      attempt(way[layers_.size()]);
    }
    const int every = many ? kStartsApart : 1;
    for (size_t i = 0; i < layers_[0].size() && (!many || least > rules_.limit); ++i)
      if (layers_[0][i].place % every == 0 && !layers_[0][i].barred) attempt(i);
    return start;
  }

  /// The least worst displacement, or the least sum among the sequences of which none exceeds `limit`; with
  /// `keep` the way to it is kept. From the node `start` round to it again, or from any.
  double Sweep(Kind kind, size_t start, double limit, bool keep) {
    FlankRow row(layers_[0].size());
    for (size_t i = 0; i < layers_[0].size(); ++i) {
      if ((start != kNone && i != start) || layers_[0][i].barred) continue;
      const StateCosts& costs = costs_[0][i];
      for (unsigned state = 0; state < kStates; ++state) {
        if (costs.Pressed(state) != state || (state & ~active_ & ~unsigned{costs.pressed}) != 0 ||
            !(costs.displaced[state] <= limit))
          continue;
        row.At(i, state) =
            kind == Kind::kWorst ? costs.displaced[state] : rules_.displaced_weight * costs.displaced[state];
        row.reached[i] |= uint64_t{1} << state;
      }
    }
    const size_t count = laps_ * layers_.size();
    if (keep) before_.assign(count, {});
    for (size_t t = 0; t + 1 < count; ++t) {
      CheckStop(rules_.stop);
      const size_t from = t % layers_.size(), to = (t + 1) % layers_.size();
      FlankRow next(layers_[to].size());
      if (keep) before_[t + 1].assign(next.value.size(), kNoState);
      first_ = t == 0;
      for (size_t node = 0; node < layers_[to].size(); ++node)
        Relax(kind, limit, {from, 0, to, node}, row, next, keep ? before_[t + 1].data() : nullptr);
      row = std::move(next);
      if (std::ranges::all_of(row.reached, [](uint64_t states) { return states == 0; })) return kInfinity;
    }
    first_ = false;
    return Close(kind, limit, start, row);
  }

  /// The least of the last row and, of a ring, of the step back to its start.
  double Close(Kind kind, double limit, size_t start, FlankRow& row) {
    double least = kInfinity;
    FlankRow end(start == kNone ? 0 : layers_[0].size());
    std::vector<uint32_t> before(end.value.size(), kNoState);
    for (size_t node = 0; node < row.reached.size(); ++node) {
      if (start == kNone) {
        ForStates(row.reached[node], [&](unsigned state) {
          const double value = row.At(node, state);
          if (value < least) least = value, last_ = static_cast<uint32_t>(node * kStates + state);
        });
        continue;
      }
      for (unsigned state = 0; state < kStates; ++state) end.At(start, state) = kInfinity;
      end.reached[start] = 0;
      RelaxEdge(kind, limit, {layers_.size() - 1, node, 0, start}, row, end, before.data());
      ForStates(end.reached[start], [&](unsigned state) {
        const double value = end.At(start, state);
        if (value < least) least = value, last_ = before[start * kStates + state];
      });
    }
    return least;
  }

  template <typename Work>
  static void ForStates(uint64_t states, const Work& work) {
    for (; states != 0; states &= states - 1) work(static_cast<unsigned>(std::countr_zero(states)));
  }

  struct Edge {
    size_t from_layer, from, to_layer, to;
  };

  void Relax(Kind kind, double limit, Edge edge, FlankRow& row, FlankRow& next, uint32_t* before) {
    const FlankNode& node = layers_[edge.to_layer][edge.to];
    if (node.barred) return;
    for (int off = -rules_.window; off <= rules_.window; ++off) {
      const int from = index_[edge.from_layer].At(node.branch, node.place + off);
      if (from < 0 || row.reached[static_cast<size_t>(from)] == 0) continue;
      edge.from = static_cast<size_t>(from);
      RelaxEdge(kind, limit, edge, row, next, before);
    }
  }

  void RelaxEdge(Kind kind, double limit, const Edge& edge, FlankRow& row, FlankRow& next, uint32_t* before) {
    const FlankNode &a = layers_[edge.from_layer][edge.from], &b = layers_[edge.to_layer][edge.to];
    if (a.branch != b.branch) return;
    const Joints step = (b.q - a.q).unaryExpr(&WrapToPi);
    if ((step.cwiseAbs().array() > rules_.max_step[edge.from_layer].array()).any()) return;
    const Joints move = rules_.lost.gears * step;
    unsigned moved = 0, forward = 0, slow = 0;
    for (unsigned i = 0; i < 6; ++i) {
      if (std::abs(move[i]) <= kStill || ((active_ >> i) & 1U) == 0) continue;
      moved |= 1U << i;
      if (move[i] > 0) forward |= 1U << i;
      if (std::abs(move[i]) < rules_.lost.width[i]) slow |= 1U << i;
    }
    const StateCosts& costs = costs_[edge.to_layer][edge.to];
    const double motion = rules_.motion_weight * step.squaredNorm();
    const StateCosts& at_start = costs_[edge.from_layer][edge.from];
    ForStates(row.reached[edge.from], [&](unsigned state) {
      // Settled: a gear that moves at once rests where that leaves it, unless load presses it elsewhere.
      if (first_ && ((state ^ forward) & moved & ~at_start.pressed) != 0) return;
      const unsigned now = costs.Pressed((state & ~moved) | forward);
      // One that crosses slowly may be on its way for some points: either flank counts then.
      double displaced = costs.displaced[now];
      const unsigned crossing = (now ^ state) & slow;
      for (unsigned late = crossing; late != 0; late = (late - 1) & crossing)
        displaced = std::max(displaced, costs.displaced[now ^ late]);
      if (!(displaced <= limit)) return;
      double& value = next.At(edge.to, now);
      const double come = row.At(edge.from, state);
      // A gear that turns back leaves its mark where it turns, one that load presses over where that happens.
      const auto marks = [&] {
        return at_start.marks[(now ^ state) & ~costs.pressed] + costs.marks[(now ^ state) & costs.pressed];
      };
      const double with = kind == Kind::kWorst
                              ? std::max(come, displaced)
                              : come + rules_.displaced_weight * displaced + marks() + motion;
      if (with >= value) return;
      value = with;
      next.reached[edge.to] |= uint64_t{1} << now;
      if (before != nullptr)
        before[edge.to * kStates + now] = static_cast<uint32_t>(edge.from * kStates + state);
    });
  }

  std::span<const std::vector<FlankNode>> layers_;
  const FlankRules& rules_;
  std::vector<NodeIndex> index_;
  std::vector<std::vector<StateCosts>> costs_;
  std::vector<std::vector<uint32_t>> before_;  ///< per step: node and state before each, node · 64 + state
  unsigned active_ = 0;                        ///< gears that have a gap
  size_t laps_ = 1;                            ///< rounds that a sweep makes
  bool first_ = false;                         ///< of the edges of the first step
  uint32_t last_ = kNoState;
};

}  // namespace

std::vector<size_t> SearchFlanks(std::span<const std::vector<FlankNode>> layers, const FlankRules& rules) {
  if (layers.empty() || std::ranges::any_of(layers, [](const auto& layer) { return layer.empty(); }))
    return {};
  return FlankSearch(layers, rules).Search();
}

}  // namespace millpose
