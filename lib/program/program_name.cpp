// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/program_name.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

constexpr size_t kHashLength = 5;
constexpr size_t kLetters = 2;  // that SINUMERIK wants in front
constexpr size_t kLongestToolName = 32;

bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// Letters, digits and '_' alone, `letters` letters in front; as long as it is.
std::string Legal(const std::string& text, size_t letters) {
  std::string name;
  for (const char c : text) name += IsLetter(c) || IsDigit(c) ? c : '_';
  const bool begins_well = name.size() >= letters &&
                           std::all_of(name.begin(), name.begin() + static_cast<long>(letters), IsLetter);
  return begins_well ? name : "mp_" + name;
}

/// `text` without the digits at its end.
std::string WithoutDigits(std::string text) {
  while (!text.empty() && IsDigit(text.back())) text.pop_back();
  return text;
}

/// Takes `ending` away; false where `text` does not end so.
bool Take(std::string& text, std::string_view ending) {
  if (!text.ends_with(ending)) return false;
  text.resize(text.size() - ending.size());
  return true;
}

}  // namespace

std::string NameHash(const std::string& text) {
  constexpr std::string_view kSigns = "0123456789abcdefghijklmnopqrstuvwxyz";
  uint64_t rest = std::stoull(Hash(text).substr(0, 16), nullptr, 16);
  std::string signs;
  for (size_t i = 0; i < kHashLength; ++i, rest /= kSigns.size()) signs += kSigns[rest % kSigns.size()];
  return signs;
}

std::string LegalName(const std::string& text, size_t longest, size_t letters) {
  std::string name = Legal(text, letters);
  if (name.size() <= longest) return name;
  return name.substr(0, longest - kHashLength - 1) + '_' + NameHash(text);
}

// The '/' stands in no name of an operation: what is hashed tells where the job's name ends.
std::string OperationName(const std::string& job, const std::string& operation) {
  return Legal(operation, kLetters).substr(0, kProgramNameLength - kHashLength - 1) + '_' +
         NameHash(job + '/' + operation);
}

std::string SubprogramName(const std::string& name, size_t index, size_t longest) {
  const std::string number = fmt::format("_{:03}", index + 1);
  return LegalName(name, longest - number.size(), 1) + number;
}

std::string StartName(const std::string& job, int pass, int piece) {
  const std::string ending = fmt::format("_P{}_{}", pass, piece);
  return LegalName(job, kProgramNameLength - ending.size(), kLetters) + ending;
}

std::string AsTold(std::string name) {
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return name;
}

std::string WithoutPart(const std::string& name) {
  std::string whole = WithoutDigits(AsTold(name));
  const size_t digits = name.size() - whole.size();
  if (digits == 0 || !Take(whole, "_")) return {};
  std::string start = WithoutDigits(whole);
  if (start.size() < whole.size() && Take(start, "_p")) return start;
  return digits == 3 || digits == 4 ? whole : std::string();
}

bool IsToolName(const std::string& name) {
  constexpr std::string_view kEnds = "\"(){};";  // what ends a text in quotes, a comment, a hole of a text
  const auto odd = [&](char c) { return c < ' ' || c > '~' || kEnds.find(c) != std::string_view::npos; };
  return !name.empty() && name.size() <= kLongestToolName && std::ranges::none_of(name, odd) &&
         name.front() != ' ' && name.back() != ' ' && name.find("  ") == std::string::npos;
}

}  // namespace millpose
