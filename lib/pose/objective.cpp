// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objective.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "pose/objective_parameters.hpp"
#include "pose/objectives/chen2021.hpp"
#include "pose/objectives/drilling.hpp"
#include "pose/objectives/isotropy.hpp"
#include "pose/objectives/normal_deflection.hpp"
#include "pose/objectives/process_force.hpp"
#include "pose/objectives/worst_in_plane.hpp"

namespace millpose {
namespace {

template <typename Implementation>
std::unique_ptr<Objective> Make(const ObjectiveParameters& parameters) {
  return std::make_unique<Implementation>(parameters);
}

struct Registration {
  const char* name;
  std::unique_ptr<Objective> (*make)(const ObjectiveParameters&);
};

/// One line per objective.
constexpr Registration kRegistry[] = {
    {"chen2021", Make<Chen2021>},           {"isotropy", Make<Isotropy>},
    {"drilling", Make<Drilling>},           {"normal_deflection", Make<NormalDeflection>},
    {"worst_in_plane", Make<WorstInPlane>}, {"process_force", Make<ProcessForce>},
};

std::string Suggestion(const std::string& given, const std::vector<std::string>& known) {
  const std::string nearest = NearestName(given, known);
  return nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest);
}

}  // namespace

std::unique_ptr<Objective> MakeObjective(const std::string& name, const ObjectiveParameters& parameters) {
  for (const Registration& entry : kRegistry) {
    if (name == entry.name) return entry.make(parameters);
  }
  const std::vector<std::string> known = ObjectiveNames();
  throw InputError(Place{}, fmt::format("no objective \"{}\"; known: {}{}", name, fmt::join(known, ", "),
                                        Suggestion(name, known)));
}

std::vector<std::string> ObjectiveNames() {
  std::vector<std::string> names;
  for (const Registration& entry : kRegistry) names.emplace_back(entry.name);
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
