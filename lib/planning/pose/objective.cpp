// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/objective.hpp"

#include "base/text.hpp"
#include "planning/pose/expression.hpp"

namespace millpose {

/// Defined in objectives/<name>.cpp.
ObjectiveEntry Chen2021Entry(), DrillingEntry(), FaceErrorEntry(), IsotropyEntry(), NormalDeflectionEntry(),
    ProcessForceEntry(), SurfaceErrorEntry(), WorstInPlaneEntry();

Registry<ObjectiveEntry>& Objectives() {
  static Registry<ObjectiveEntry> objectives{
      "objective",
      {Chen2021Entry(), DrillingEntry(), FaceErrorEntry(), IsotropyEntry(), NormalDeflectionEntry(),
       ProcessForceEntry(), SurfaceErrorEntry(), WorstInPlaneEntry()}};
  return objectives;
}

const ObjectiveEntry& TheObjective(bool ObjectiveEntry::*is) {
  const auto& all = Objectives().entries();
  return *std::ranges::find(all, true, is);
}

namespace {

// Every parameter of the entry, and in `problems` what is wrong with the given ones.
ObjectiveParameters Complete(const ObjectiveEntry& entry, const ObjectiveParameters& given,
                             std::vector<Problem>& problems) {
  ObjectiveParameters all;
  std::vector<std::string> known;
  for (const ParameterRule& rule : entry.parameters) {
    known.push_back(rule.name);
    const auto found = given.find(rule.name);
    const double value = all[rule.name] = found == given.end() ? rule.fallback : found->second;
    if (!std::isfinite(value) || value < rule.minimum)
      problems.push_back(
          {SourceLocation{}, fmt::format("objective {}: {} is {}; allowed: at least {}", entry.name,
                                         rule.name, ShortestNumber(value), ShortestNumber(rule.minimum))});
    const auto words = static_cast<double>(rule.words.size());
    if (words > 0 && (value >= words || value != std::floor(value)))
      problems.push_back({SourceLocation{},
                          fmt::format("objective {}: {} is {}; allowed: the index of one of {}", entry.name,
                                      rule.name, ShortestNumber(value), fmt::join(rule.words, ", "))});
  }
  for (const auto& [name, value] : given) {
    if (!all.contains(name))
      problems.push_back({SourceLocation{}, fmt::format("objective {}: {}", entry.name,
                                                        UnknownName("parameter", name, known))});
  }
  return all;
}

}  // namespace

ObjectiveEntry ObjectiveNamed(const std::string& name) {
  if (!Expression::Looks(name)) return Objectives().At(name);
  [[maybe_unused]] const Expression readable(name);  // throws where it is not
  return ExpressionEntry(name);
}

std::unique_ptr<Objective> MakeObjective(const std::string& name, const ObjectiveParameters& parameters) {
  const ObjectiveEntry entry = ObjectiveNamed(name);
  std::vector<Problem> problems;
  const ObjectiveParameters all = Complete(entry, parameters, problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  std::unique_ptr<Objective> objective = entry.make(all);
  objective->parameters_ = parameters;
  return objective;
}

}  // namespace millpose
