// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"

#include <algorithm>
#include <cctype>

#include "base/shown.hpp"

namespace millpose {

std::string ToString(const SourceLocation& place) {
  if (place.byte >= 0) return fmt::format("{}, byte {}", place.file, place.byte);
  if (place.line > 0 && place.column > 0)
    return fmt::format("{}:{}:{}", place.file, place.line, place.column);
  if (place.line > 0) return fmt::format("{}:{}", place.file, place.line);
  return place.file;
}

InputError::InputError(std::vector<Problem> problems) : problems_(std::move(problems)) {
  // Whatever a message repeats of a foreign file, it must not print that file.
  constexpr size_t kLongest = 2000;
  const size_t more = problems_.size() > kMostProblems ? problems_.size() - kMostProblems : 0;
  if (more > 0) {
    problems_.resize(kMostProblems);
    problems_.push_back(
        {SourceLocation{problems_.back().place.file}, "more problems follow that are not listed"});
  }
  for (Problem& problem : problems_)
    if (problem.message.size() > kLongest) problem.message = Shown(problem.message, kLongest);
  for (const Problem& problem : problems_) {
    if (!text_.empty()) text_ += '\n';
    std::string place = ToString(problem.place);
    std::ranges::replace_if(
        place, [](char c) { return c == '\n' || c == '\t'; }, '?');
    text_ += place.empty() ? problem.message : place + ": " + problem.message;
  }
  std::ranges::replace(text_, '\0', '?');  // what() ends at the first
}

InputError::InputError(SourceLocation place, std::string message)
    : InputError(std::vector<Problem>{{std::move(place), std::move(message)}}) {}

namespace {

// Levenshtein distance, letters compared without case.
size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const bool same = std::tolower(static_cast<unsigned char>(a[i - 1])) ==
                        std::tolower(static_cast<unsigned char>(b[j - 1]));
      const size_t substituted = diagonal + (same ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

// Whether a name goes on where what was given ends: kr500 of kr500_r2830. Two letters begin too many.
bool IsBegun(std::string_view given, std::string_view name) {
  return given.size() > 2 && name.size() > given.size() &&
         EditDistance(given, name.substr(0, given.size())) == 0;
}

}  // namespace

std::string NearestName(std::string_view given, const std::vector<std::string>& known) {
  constexpr size_t kBegun = 2;  // so near is a name's beginning: nearer than a slip in several letters
  std::string nearest;
  size_t best = given.size() / 2 + 2;  // farther than this is another word, not a slip
  for (const std::string& name : known) {
    if (IsBegun(given, name) && best > kBegun) {
      best = kBegun;
      nearest = name;
    }
    if (given.size() >= name.size() + best || name.size() >= given.size() + best) continue;
    const size_t distance = EditDistance(given, name);
    if (distance < best) {
      best = distance;
      nearest = name;
    }
  }
  return nearest;
}

std::string UnknownName(const std::string& kind, const std::string& name,
                        const std::vector<std::string>& known) {
  if (known.empty()) return fmt::format("no {} \"{}\"; there are none", kind, name);
  const std::string nearest = NearestName(name, known);
  return fmt::format("no {} \"{}\"; known: {}{}", kind, name, fmt::join(known, ", "),
                     nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest));
}

}  // namespace millpose
