// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace millpose {

/// Links end to end, by their numbers.
struct LinkChain {
  std::vector<size_t> links;
  bool closed = false;
};

/// Orders directed links (with members `from` and `to`, keys of `Map`; at most one link begins and one ends
/// at each key) end to end: open chains first, then closed ones.
template <typename Map, typename Link>
std::vector<LinkChain> ChainLinks(const std::vector<Link>& links) {
  Map starting, ending;
  for (size_t i = 0; i < links.size(); ++i) {
    starting[links[i].from] = i;
    ending[links[i].to] = i;
  }
  std::vector<char> used(links.size(), 0);
  std::vector<LinkChain> chains;
  const auto follow = [&](size_t at, bool closed) {
    LinkChain& chain = chains.emplace_back();
    chain.closed = closed;
    while (used[at] == 0) {
      used[at] = 1;
      chain.links.push_back(at);
      const auto next = starting.find(links[at].to);
      if (next != starting.end()) at = next->second;
    }
  };
  for (size_t i = 0; i < links.size(); ++i)
    if (!ending.contains(links[i].from)) follow(i, false);
  for (size_t i = 0; i < links.size(); ++i)
    if (used[i] == 0) follow(i, true);
  return chains;
}

}  // namespace millpose
