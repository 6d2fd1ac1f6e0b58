// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/strike_out.hpp"

#include <limits>
#include <numeric>

#include "base/parallel.hpp"

namespace millpose {

long long CheckInParallel(const World& world, size_t count, int threads, std::stop_token stop,
                          const std::function<void(Checker&, size_t)>& work) {
  // Chunks of fixed size, a checker each: what a checker remembers cannot depend on the number of threads.
  constexpr size_t kChunk = 16;
  const size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<long long> poses(chunks, 0);
  ParallelFor(chunks, threads, stop, [&](size_t chunk) {
    Checker checker(world);
    for (size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) work(checker, i);
    poses[chunk] = checker.poses_checked();
  });
  return std::accumulate(poses.begin(), poses.end(), 0LL);
}

std::string Describe(const Interference& interference) {
  return fmt::format("{} and {} {} at ({:.1f}, {:.1f}, {:.1f}) mm", interference.first, interference.second,
                     interference.distance > 0 ? fmt::format("come within {:.2f} mm", interference.distance)
                                               : std::string("touch"),
                     interference.place.x(), interference.place.y(), interference.place.z());
}

StrikeOut::StrikeOut(const World& world, std::vector<Layer>& layers, double swept_resolution, int threads,
                     std::stop_token stop)
    : world_(world),
      layers_(layers),
      swept_resolution_(swept_resolution),
      threads_(threads),
      stop_(std::move(stop)),
      verdict_(layers.size()),
      struck_(layers.size()),
      free_(layers.size()),
      detail_(layers.size()) {
  for (size_t t = 0; t < layers.size(); ++t) verdict_[t].assign(layers[t].size(), Verdict::kUnknown);
}

bool StrikeOut::Check(const Sequence& sequence) {
  const size_t count = layers_.size();
  std::vector<int> struck_here(count, 0);
  poses_checked_ += CheckInParallel(world_, count, threads_, stop_, [&](Checker& checker, size_t t) {
    if (sequence.nodes[t] == kNoNode) return;
    const auto struck = [&] { return std::count(verdict_[t].begin(), verdict_[t].end(), Verdict::kStruck); };
    const auto before = struck();
    CheckNode(checker, t, sequence.nodes[t]);
    struck_here[t] = static_cast<int>(struck() - before);
  });
  std::vector<char> barred(count, 0);
  poses_checked_ += CheckInParallel(world_, count, threads_, stop_, [&](Checker& checker, size_t t) {
    const size_t to = (t + 1) % count;
    if (to == 0 ? !sequence.closed : bool(sequence.break_before[to])) return;
    barred[t] = !CheckMotion(checker, t, to, sequence);
  });
  barred_.clear();
  bool all_free = true;
  for (size_t t = 0; t < count; ++t) {
    nodes_struck_ += struck_here[t];
    if (barred[t]) barred_.push_back(t);
    all_free = all_free && struck_here[t] == 0 && !barred[t];
  }
  return all_free;
}

void StrikeOut::CheckNode(Checker& checker, size_t layer, size_t node) {
  const auto free = [&](size_t k) {
    Verdict& verdict = verdict_[layer][k];
    if (verdict != Verdict::kUnknown) return verdict == Verdict::kFree;
    const auto hit = checker.At(layers_[layer].joints.At(k), Phase::kCutting);
    verdict = hit ? Verdict::kStruck : Verdict::kFree;
    if (hit) {
      detail_[layer] = Describe(*hit);
      layers_[layer].objective[k] = std::numeric_limits<double>::infinity();
    }
    return !hit.has_value();
  };
  if (free(node)) return;
  // Interference fills intervals: look for its ends now instead of meeting every node of it in a round of its
  // own.
  const int branch = layers_[layer].BranchOf(node);
  const size_t first = layers_[layer].branch_begin[branch], last = layers_[layer].branch_begin[branch + 1];
  for (size_t k = node; k > first && !free(k - 1); --k) {
  }
  for (size_t k = node + 1; k < last && !free(k); ++k) {
  }
}

bool StrikeOut::CheckMotion(Checker& checker, size_t from, size_t to, const Sequence& sequence) {
  const size_t a = sequence.nodes[from], b = sequence.nodes[to];
  if (a == kNoNode || b == kNoNode) return true;
  if (verdict_[from][a] != Verdict::kFree || verdict_[to][b] != Verdict::kFree) return true;
  if (free_[from].contains({a, b})) return true;
  const Joints q0 = layers_[from].joints.At(a);
  const Joints q1 = q0 + (layers_[to].joints.At(b) - q0).unaryExpr(&ShortWay);
  const auto hit = checker.Between(q0, q1, Phase::kCutting, swept_resolution_);
  (hit ? struck_ : free_)[from].insert({a, b});
  if (hit) detail_[from] = Describe(*hit);
  return !hit.has_value();
}

void StrikeOut::StrikeBarred(const Sequence& sequence, Extent extent) {
  const auto strike = [&](size_t t, size_t node) {
    nodes_struck_ += verdict_[t][node] != Verdict::kStruck;
    verdict_[t][node] = Verdict::kStruck;
    layers_[t].objective[node] = std::numeric_limits<double>::infinity();
  };
  for (const size_t t : barred_) {
    const size_t to = (t + 1) % layers_.size();
    if (extent == Extent::kNodes) {
      strike(t, sequence.nodes[t]);
      strike(to, sequence.nodes[to]);
      detail_[to] = detail_[t];
    } else {
      for (size_t k = 0; k < layers_[t].size(); ++k) strike(t, k);
    }
  }
}

}  // namespace millpose
