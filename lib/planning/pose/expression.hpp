// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "planning/pose/objective.hpp"

namespace millpose {

/// An objective spelled in a job: numbers, the named indices, + - * / ( ), and min, max, sqrt, abs, sin, cos,
/// asin, acos, atan2 (rad) of our own trigonometry, so that it gives the same bytes everywhere.
class Expression {
 public:
  /// Throws InputError with every name that is not known, and with the first place that is no expression, by
  /// characters from 1.
  explicit Expression(std::string_view text);

  /// Whether `text` is meant as an expression and not as the name of an objective: anything but one word, or
  /// the name of an index.
  static bool Looks(std::string_view text);
  /// What may be named, indices first.
  static std::vector<std::string> Names();

  bool ReadsForce() const;
  bool ReadsToolAxis() const;
  /// "mm/N", "mm", "1/mm", …, "1" where it has none, "mixed" where terms of different units meet.
  std::string Unit() const;
  /// One value per lane; +inf where an index or the value is not finite or the value is below 0.
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const;

  struct Step {
    int code;       // of an index, a function or an operator
    int arguments;  // taken from the stack
    double number = 0;
  };

 private:
  std::vector<Step> steps_;  // in reverse Polish order
};

/// The indices that an expression may name, as Names() has them first, and their values for a block, in that
/// order: mm/N, 1 or mm as their names say; not finite where they are not defined.
std::vector<std::string> ObjectiveIndexNames();
std::vector<Lanes> ObjectiveIndices(const ComplianceBlock& c, const ObjectiveContext& context);

/// The entry under which an expression is made: its name is the expression, it has no parameters.
ObjectiveEntry ExpressionEntry(const std::string& text);

/// The entry registered under `name` or, where that is an expression, one of its own. Throws InputError for
/// other names and for what is wrong with it.
ObjectiveEntry ObjectiveNamed(const std::string& name);

}  // namespace millpose
