// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/first_node.hpp"

#include <queue>

namespace millpose {
namespace {

/// A set of first nodes, first..last−1, and what is known about closed sequences through it.
struct Part {
  size_t first, last;
  double bound;        ///< no closed sequence through the set costs less
  size_t start, into;  ///< of the sequence that gives the bound
};
/// The nodes that differ from `node` by full revolutions only: first, and one beyond the last.
size_t GroupBegin(const std::vector<size_t>& base, size_t node) {
  while (node > 0 && base[node - 1] == base[node]) --node;
  return node;
}
size_t GroupEnd(const std::vector<size_t>& base, size_t node) {
  const size_t group = base[node];
  while (node < base.size() && base[node] == group) ++node;
  return node;
}

struct Costlier {
  bool operator()(const Part& a, const Part& b) const {
    return a.bound != b.bound ? a.bound > b.bound : a.first > b.first;
  }
};

}  // namespace

std::optional<Sequence> BranchOverFirst(const std::vector<size_t>& base,
                                        const std::function<std::optional<Round>(size_t, size_t)>& round,
                                        int max_sweeps) {
  std::optional<Sequence> best;
  std::priority_queue<Part, std::vector<Part>, Costlier> open;
  const auto bound = [&](size_t first, size_t last) {
    if (first >= last || --max_sweeps < 0) return;
    std::optional<Round> found = round(first, last);
    if (!found) return;
    const size_t start = found->sequence.nodes[0];
    if (base[start] != base[found->into]) {
      open.push({first, last, found->cost, start, found->into});
    } else if (!best || found->cost < best->cost) {
      best = std::move(found->sequence);
      best->cost = found->cost;
      best->closed = true;
    }
  };
  bound(0, base.size());
  while (!open.empty()) {
    const Part part = open.top();
    open.pop();
    if (best && part.bound >= best->cost) break;  // nor can any other part be better
    // The sequence of the bound starts and ends at different nodes. A closed one has both in the half before
    // or in the half after a cut between them.
    if (!best) bound(GroupBegin(base, part.start), GroupEnd(base, part.start));
    const size_t low = std::min(part.start, part.into), high = std::max(part.start, part.into);
    size_t cut = GroupBegin(base, (low + high + 1) / 2);
    if (cut <= GroupBegin(base, low)) cut = GroupBegin(base, high);
    bound(part.first, cut);
    bound(cut, part.last);
  }
  return best;
}

}  // namespace millpose
