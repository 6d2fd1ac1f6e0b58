// SPDX-License-Identifier: GPL-3.0-or-later
// The words of an objective spelled in a job, and its parser; users include expression.hpp.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "planning/pose/expression.hpp"

namespace millpose::expression {

/// What a step of the reverse Polish order does: indices first, then functions, a number, operators.
enum Code : int {
  kLambdaT1,
  kLambdaT2,
  kLambdaN,
  kMu,
  kNormal,
  kInPlane,
  kWorstInPlane,
  kAlongAxis,
  kUnderForce,
  kIndexCount,
  kMin = kIndexCount,
  kMax,
  kSqrt,
  kAbs,
  kSin,
  kCos,
  kAsin,
  kAcos,
  kAtan2,
  kNamedCount,
  kNumber = kNamedCount,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kNegate,
};

/// An index or a function by its name.
struct Named {
  const char* name;
  int least, most;  // arguments; 0: an index
  int mm, newton;   // exponents of its unit
};

inline constexpr int kMostArguments = 16, kMostSteps = 256, kMostDepth = 32;
inline constexpr std::array<Named, kNamedCount> kNamed{{{"lambda_t1_mm_N", 0, 0, 1, -1},
                                                        {"lambda_t2_mm_N", 0, 0, 1, -1},
                                                        {"lambda_n_mm_N", 0, 0, 1, -1},
                                                        {"mu", 0, 0, 0, 0},
                                                        {"normal_deflection_mm_N", 0, 0, 1, -1},
                                                        {"in_plane_deflection_mm_N", 0, 0, 1, -1},
                                                        {"worst_in_plane_mm_N", 0, 0, 1, -1},
                                                        {"axis_deflection_mm_N", 0, 0, 1, -1},
                                                        {"force_deflection_mm", 0, 0, 1, 0},
                                                        {"min", 2, kMostArguments, 0, 0},
                                                        {"max", 2, kMostArguments, 0, 0},
                                                        {"sqrt", 1, 1, 0, 0},
                                                        {"abs", 1, 1, 0, 0},
                                                        {"sin", 1, 1, 0, 0},
                                                        {"cos", 1, 1, 0, 0},
                                                        {"asin", 1, 1, 0, 0},
                                                        {"acos", 1, 1, 0, 0},
                                                        {"atan2", 2, 2, 0, 0}}};

inline bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/// Adds the steps of `text`. Throws InputError as Expression's constructor does.
void Parse(std::string_view text, std::vector<Expression::Step>& steps);

}  // namespace millpose::expression
