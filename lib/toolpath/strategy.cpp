// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategy.hpp"

#include "base/error.hpp"

namespace millpose {
namespace {

using Maker = std::unique_ptr<Strategy> (*)();

const std::map<std::string, Maker>& Registry() {
  static const std::map<std::string, Maker> registry{
      {"contours", MakeContours}, {"curve", MakeSingleCurve},
      {"pad", MakePad},           {"parallel_planes", MakeParallelPlanes},
      {"rings", MakeRings},
  };
  return registry;
}

}  // namespace

std::vector<std::string> StrategyNames() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : Registry()) names.push_back(name);
  return names;
}

std::unique_ptr<Strategy> MakeStrategy(const std::string& name) {
  const auto found = Registry().find(name);
  if (found != Registry().end()) return found->second();
  const std::string nearest = NearestName(name, StrategyNames());
  throw InputError({}, fmt::format("no tool path strategy is called \"{}\"; there are {}{}", name,
                                   fmt::join(StrategyNames(), ", "),
                                   nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

}  // namespace millpose
