// SPDX-License-Identifier: GPL-3.0-or-later
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

}  // namespace millpose
