// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

/// Where in an input something is wrong. Lines and columns count from 1; 0 means unknown. `byte` counts from
/// 0 and is used by binary formats; -1 means unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
  long long byte = -1;
};

/// "file:line:column", "file:line", "file, byte 84" or "file", by what is known.
std::string ToString(const SourceLocation& place);

/// One thing that is wrong with an input.
struct Problem {
  SourceLocation place;
  std::string message;  ///< what was given, what is allowed, the nearest known name
};

/// Bad input or usage (exit status 2). Carries every problem that was found, never only the first.
class InputError : public std::exception {
 public:
  explicit InputError(std::vector<Problem> problems);
  InputError(SourceLocation place, std::string message);

  const std::vector<Problem>& problems() const { return problems_; }
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::vector<Problem> problems_;
  std::string text_;
};

/// Thrown by loops that saw the stop token (exit status 130).
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// The entry of `known` that is nearest to `given` by edit distance, or empty when none is near.
std::string NearestName(std::string_view given, const std::vector<std::string>& known);

/// The message for a `name` that no `kind` of thing has, with the known names and the nearest: no objective
/// "chen2012"; known: chen2021, drilling; did you mean "chen2021"?
std::string UnknownName(const std::string& kind, const std::string& name,
                        const std::vector<std::string>& known);

}  // namespace millpose
