// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/flank_search.hpp"

#include <bit>

#include "base/parallel.hpp"
#include "planning/ladder/edge_kernel.hpp"

namespace millpose {
namespace {

constexpr size_t kStates = 64;  // of six gears: bit i is set where gear i has gone in its + direction last
constexpr uint32_t kNoState = std::numeric_limits<uint32_t>::max();

/// What each state costs at a node.
struct StateCosts {
  std::array<double, kStates> displaced;  ///< largest displacement; 0 where the place does not count
  std::array<double, kStates> marks;      ///< of the gears whose bits are set, when they cross there
  uint8_t pressed = 0, pressed_to = 0;    ///< gears whose flank the load says, and their bits then

  StateCosts(const LostMotion& lost, const FlankNode& node) {
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
        if (set && face.counts) marks[state] += 2 * std::abs(half);
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
    return at < 0 || at >= size_ ? -1 : at_[static_cast<size_t>(branch * size_ + at)];
  }

 private:
  int ring_, first_ = 0, size_ = 0;
  std::vector<int> at_;
};

class FlankSearch {
 public:
  FlankSearch(std::span<const std::vector<FlankNode>> layers, const FlankRules& rules)
      : layers_(layers), rules_(rules) {
    for (const auto& layer : layers) {
      index_.emplace_back(layer, rules.ring);
      costs_.emplace_back();
      for (const FlankNode& node : layer) costs_.back().emplace_back(rules.lost, node);
    }
  }

  std::vector<size_t> Search() {
    if (!rules_.closed) return SearchFrom(kNone);
    // A ring comes back to the node that it begins with: each of the first layer is tried.
    size_t start = kNone;
    double least = kInfinity;
    for (size_t i = 0; i < layers_[0].size(); ++i) {
      const double worst = Sweep(Kind::kWorst, i, least, false);
      if (worst < least) least = worst, start = i;
    }
    return start == kNone ? std::vector<size_t>() : SearchFrom(start);
  }

 private:
  enum class Kind : uint8_t { kWorst, kSum };
  static constexpr size_t kNone = std::numeric_limits<size_t>::max();

  std::vector<size_t> SearchFrom(size_t start) {
    const double worst = Sweep(Kind::kWorst, start, kInfinity, false);
    if (!std::isfinite(worst)) return {};
    constexpr double kRounding = 1 + 1e-9;
    Sweep(Kind::kSum, start, worst * (1 + rules_.slack) * kRounding, true);
    std::vector<size_t> nodes(layers_.size());
    uint32_t at = last_;
    for (size_t t = layers_.size(); t-- > 0; at = t > 0 ? before_[t][at] : at) nodes[t] = at / kStates;
    return nodes;
  }

  /// The least worst displacement, or the least sum among the sequences of which none exceeds `limit`; with
  /// `keep` the way to it is kept. From the node `start` round to it again, or from any.
  double Sweep(Kind kind, size_t start, double limit, bool keep) {
    FlankRow row(layers_[0].size());
    for (size_t i = 0; i < layers_[0].size(); ++i) {
      if ((start != kNone && i != start) || layers_[0][i].barred) continue;
      const StateCosts& costs = costs_[0][i];
      for (unsigned state = 0; state < kStates; ++state) {
        if (costs.Pressed(state) != state || !(costs.displaced[state] <= limit)) continue;
        row.At(i, state) = costs.displaced[state];
        row.reached[i] |= uint64_t{1} << state;
      }
    }
    if (keep) before_.assign(layers_.size(), {});
    for (size_t t = 0; t + 1 < layers_.size(); ++t) {
      CheckStop(rules_.stop);
      FlankRow next(layers_[t + 1].size());
      if (keep) before_[t + 1].assign(next.value.size(), kNoState);
      for (size_t to = 0; to < layers_[t + 1].size(); ++to) Relax(kind, limit, t, to, row, next, keep);
      row = std::move(next);
    }
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

  void Relax(Kind kind, double limit, size_t t, size_t to, FlankRow& row, FlankRow& next, bool keep) {
    const FlankNode& node = layers_[t + 1][to];
    if (node.barred) return;
    for (int off = -rules_.window; off <= rules_.window; ++off) {
      const int from = index_[t].At(node.branch, node.place + off);
      if (from < 0 || row.reached[static_cast<size_t>(from)] == 0) continue;
      RelaxEdge(kind, limit, {t, static_cast<size_t>(from), t + 1, to}, row, next,
                keep ? before_[t + 1].data() : nullptr);
    }
  }

  void RelaxEdge(Kind kind, double limit, const Edge& edge, FlankRow& row, FlankRow& next, uint32_t* before) {
    const FlankNode &a = layers_[edge.from_layer][edge.from], &b = layers_[edge.to_layer][edge.to];
    if (a.branch != b.branch) return;
    const Joints step = (b.q - a.q).unaryExpr(&WrapToPi);
    if ((step.cwiseAbs().array() > rules_.max_step[edge.from_layer].array()).any()) return;
    const Joints move = rules_.lost.gears * step;
    unsigned moved = 0, forward = 0;
    for (unsigned i = 0; i < 6; ++i) {
      if (std::abs(move[i]) <= rules_.lost.dead_zone[i]) continue;
      moved |= 1U << i;
      if (move[i] > 0) forward |= 1U << i;
    }
    const StateCosts& costs = costs_[edge.to_layer][edge.to];
    const double motion = rules_.motion_weight * step.squaredNorm();
    const bool first = edge.from_layer == 0 && edge.to_layer == 1;
    const StateCosts& at_start = costs_[edge.from_layer][edge.from];
    ForStates(row.reached[edge.from], [&](unsigned state) {
      // Settled: a gear that moves at once rests where that leaves it, unless load presses it elsewhere.
      if (first && ((state ^ forward) & moved & ~at_start.pressed) != 0) return;
      const unsigned now = costs.Pressed((state & ~moved) | forward);
      const double displaced = costs.displaced[now];
      if (!(displaced <= limit)) return;
      double& value = next.At(edge.to, now);
      const double come = row.At(edge.from, state);
      // A gear that turns back leaves its mark where it turns, one that load presses over where that happens.
      const auto marks = [&] {
        return at_start.marks[(now ^ state) & ~costs.pressed] + costs.marks[(now ^ state) & costs.pressed];
      };
      const double with = kind == Kind::kWorst ? std::max(come, displaced)
                                               : come + displaced + rules_.mark_weight * marks() + motion;
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
  std::vector<std::vector<uint32_t>> before_;  ///< per layer: node and state before each, node · 64 + state
  uint32_t last_ = kNoState;
};

}  // namespace

std::vector<size_t> SearchFlanks(std::span<const std::vector<FlankNode>> layers, const FlankRules& rules) {
  if (layers.empty() || std::ranges::any_of(layers, [](const auto& layer) { return layer.empty(); }))
    return {};
  return FlankSearch(layers, rules).Search();
}

}  // namespace millpose
