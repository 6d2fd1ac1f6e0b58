// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/program_place.hpp"

#include <array>

namespace millpose {
namespace {

constexpr std::array<std::pair<ProgramPlace, const char*>, 7> kNames = {{
    {ProgramPlace::kHead, "before the first motion"},
    {ProgramPlace::kWay, "in a way"},
    {ProgramPlace::kEntry, "before an approach"},
    {ProgramPlace::kCut, "in a cut"},
    {ProgramPlace::kStop, "at a stop in a cut"},
    {ProgramPlace::kBetween, "behind a retract"},
    {ProgramPlace::kTail, "behind the last motion"},
}};

}  // namespace

std::string Places::Text() const {
  std::vector<std::string> names;
  for (const auto& [place, name] : kNames) {
    if (Contains(place)) names.emplace_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

ProgramPlace PlaceOf(const MotionProgram& program, size_t before_motion) {
  if (before_motion == 0) return ProgramPlace::kHead;
  if (before_motion >= program.motions.size()) return ProgramPlace::kTail;
  const Motion &before = program.motions[before_motion - 1], &behind = program.motions[before_motion];
  if (!HasFeed(before)) return HasFeed(behind) ? ProgramPlace::kEntry : ProgramPlace::kWay;
  if (!HasFeed(behind)) return ProgramPlace::kBetween;
  return before.exact ? ProgramPlace::kStop : ProgramPlace::kCut;
}

void PlaceRules::Add(SourceLocation at, std::string what, size_t before_motion, Places places) {
  rules_.push_back({std::move(at), std::move(what), before_motion, places});
}

std::vector<Problem> PlaceRules::Broken(const MotionProgram& program) const {
  std::vector<Problem> problems;
  for (const Rule& rule : rules_) {
    const ProgramPlace place = PlaceOf(program, rule.before_motion);
    if (rule.places.Contains(place)) continue;
    const auto name =
        std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.first == place; });
    problems.push_back({rule.at, fmt::format("{} is not allowed {}; allowed: {}", rule.what, name->second,
                                             rule.places.Text())});
  }
  return problems;
}

}  // namespace millpose
