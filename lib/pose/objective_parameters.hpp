// SPDX-License-Identifier: GPL-3.0-or-later
// What implementations of Objective share.
#pragma once

#include <string>
#include <vector>

#include "pose/objective.hpp"

namespace millpose {

/// A parameter that an objective knows.
struct ParameterRule {
  std::string name;
  double fallback;  ///< when the job does not give it
  double minimum;   ///< least allowed value
};

/// Checks the parameters of a job against what an objective knows. The constructor throws InputError with
/// every unknown name (and the nearest known one), every value below its minimum or not finite.
class ParameterReader {
 public:
  ParameterReader(const std::string& objective, const ObjectiveParameters& given,
                  std::vector<ParameterRule> rules);
  double Value(const std::string& name) const;

 private:
  std::map<std::string, double> values_;
};

/// An objective without parameters; `unit` as reports show it.
class PlainObjective : public Objective {
 public:
  /// Throws InputError for any parameter given.
  PlainObjective(const char* name, const char* unit, const ObjectiveParameters& parameters)
      : name_(name), unit_(unit) {
    ParameterReader(name, parameters, {});
  }
  std::string Name() const override { return name_; }
  std::string Unit() const override { return unit_; }

 private:
  const char *name_, *unit_;
};

}  // namespace millpose
