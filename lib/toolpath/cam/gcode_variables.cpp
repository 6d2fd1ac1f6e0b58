// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_variables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"

namespace millpose {
namespace {

using Kind = GcodeWord::Kind;

bool IsParameter(const std::string& name) {  // R1
  return name.size() > 1 && name[0] == 'R' && name[1] >= '0' && name[1] <= '9';
}

}  // namespace

bool GcodeVariables::Take(const GcodeBlock& block) {
  const std::string& first = block.words[0].address;
  const bool definition = first == "DEF";
  if (definition)
    for (size_t i = 2; i < block.words.size(); ++i) defined_.insert(block.words[i].address);
  for (const GcodeWord& word : block.words)
    if (IsAssignment(word) && (word.kind == Kind::kValue || word.kind == Kind::kVariable))
      values_[word.address] = ValueOf(word);
  return definition || first == "PROC" ||
         std::ranges::all_of(block.words, [&](const GcodeWord& word) { return IsAssignment(word); });
}

bool GcodeVariables::IsAssignment(const GcodeWord& word) const {
  if (word.kind == Kind::kName || word.kind == Kind::kCall) return false;
  const std::string& name = word.address;
  return IsParameter(name) || defined_.contains(name) || (name.size() > 1 && name[0] == '_');
}

double GcodeVariables::ValueOf(const GcodeWord& word) const {
  if (word.kind == Kind::kText) throw InputError(word.place, word.address + " needs a number");
  if (word.kind != Kind::kVariable) return word.value;
  const auto found = values_.find(word.text);
  if (found == values_.end())
    throw InputError(word.place, fmt::format("the variable \"{}\" has no value", word.text.substr(0, 40)));
  return word.negative ? -found->second : found->second;
}

std::optional<double> GcodeVariables::ValueOf(std::string text) const {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  if (text.starts_with('+')) text.erase(0, 1);
  if (const auto number = ParseNumber(text)) return number;
  const bool negative = text.starts_with('-');
  const auto found = values_.find(negative ? text.substr(1) : text);
  if (found == values_.end()) return std::nullopt;
  return negative ? -found->second : found->second;
}

}  // namespace millpose
