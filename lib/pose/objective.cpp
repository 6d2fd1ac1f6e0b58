// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objective.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "pose/objective_parameters.hpp"

namespace millpose {

/// Defined in objectives/<name>.cpp.
using ObjectiveMaker = std::unique_ptr<Objective>(const ObjectiveParameters&);
ObjectiveMaker MakeChen2021, MakeDrilling, MakeIsotropy, MakeNormalDeflection, MakeProcessForce,
    MakeWorstInPlane;

namespace {

constexpr struct {
  const char* name;
  ObjectiveMaker* make;
} kRegistry[] = {
    {"chen2021", MakeChen2021},          {"drilling", MakeDrilling},
    {"isotropy", MakeIsotropy},          {"normal_deflection", MakeNormalDeflection},
    {"process_force", MakeProcessForce}, {"worst_in_plane", MakeWorstInPlane},
};

std::string Suggestion(const std::string& given, const std::vector<std::string>& known) {
  const std::string nearest = NearestName(given, known);
  return nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest);
}

}  // namespace

std::unique_ptr<Objective> MakeObjective(const std::string& name, const ObjectiveParameters& parameters) {
  for (const auto& entry : kRegistry) {
    if (name != entry.name) continue;
    std::unique_ptr<Objective> objective = entry.make(parameters);
    objective->parameters_ = parameters;
    return objective;
  }
  const std::vector<std::string> known = ObjectiveNames();
  throw InputError(Place{}, fmt::format("no objective \"{}\"; known: {}{}", name, fmt::join(known, ", "),
                                        Suggestion(name, known)));
}

std::vector<std::string> ObjectiveNames() {
  std::vector<std::string> names;
  for (const auto& entry : kRegistry) names.emplace_back(entry.name);
  return names;
}

ParameterReader::ParameterReader(const std::string& objective, const ObjectiveParameters& given,
                                 std::vector<ParameterRule> rules) {
  std::vector<std::string> known;
  std::vector<Problem> problems;
  for (const ParameterRule& rule : rules) {
    known.push_back(rule.name);
    values_[rule.name] = rule.fallback;
    const auto found = given.find(rule.name);
    if (found == given.end()) continue;
    values_[rule.name] = found->second;
    if (!std::isfinite(found->second) || found->second < rule.minimum) {
      problems.push_back(
          {Place{}, fmt::format("objective {}: {} is {}; allowed: at least {}", objective, rule.name,
                                ShortestNumber(found->second), ShortestNumber(rule.minimum))});
    }
  }
  for (const auto& [name, value] : given) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    problems.push_back({Place{}, fmt::format("objective {}: no parameter \"{}\"; known: {}{}", objective,
                                             name, fmt::join(known, ", "), Suggestion(name, known))});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

double ParameterReader::Value(const std::string& name) const { return values_.at(name); }

}  // namespace millpose
