// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_unit.hpp"

#include <algorithm>

namespace millpose {
namespace {

constexpr double kInch = 25.4;            // mm
constexpr double kSmallestCutter = 2;     // below it no robot mills in mm
constexpr double kSurelyMillimetres = 6;  // cutters of that many inches are none for a spindle on a robot

bool IsOneOf(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, text) != words.end();
}

std::string UnitName(double unit) { return unit == 1 ? "mm" : unit == kInch ? "inches" : "cm"; }

}  // namespace

void AptUnit::Look(const AptStatement& statement) {
  const std::string& major = statement.major.text;
  if (IsOneOf(major, {"FEDRAT", "CYCLE", "SPINDL"}))
    for (const AptWord& word : statement.minors) {
      if (!mm_ && IsOneOf(word.text, {"MMPM", "MMPR", "SMM"})) mm_ = word;
      if (!inch_ && IsOneOf(word.text, {"IPM", "IPR", "SFM"})) inch_ = word;
    }
  if (!stated_ && !unstated_ &&
      IsOneOf(major, {"GOTO", "FROM", "GODLTA", "CIRCLE", "MOVARC", "CNTRL", "GOHOME", "TLON,GOFWD"}) &&
      !statement.minors.empty())
    unstated_ = statement.major.place;
}

void AptUnit::SetStated(const SourceLocation& place, double unit) {
  if (!stated_) {
    stated_ = place;
    unit_ = unit;
  }
}

void AptUnit::TakeCutter(double diameter) {
  if (stated_) return;
  smallest_ = smallest_ > 0 ? std::min(smallest_, diameter) : diameter;
  largest_ = std::max(largest_, diameter);
}

void AptUnit::Check(const std::string& name) const {
  if (!unstated_ || options_.unit) return;
  const bool tiny = smallest_ > 0 && smallest_ < kSmallestCutter;
  if (mm_ && !inch_ && !tiny) return;
  if (!mm_ && !inch_ && smallest_ >= kSurelyMillimetres) return;
  std::string why = "nothing tells whether its lengths are mm or inches";
  const auto feeds = [](const AptWord& word) {
    return fmt::format("its feeds are in {} (line {})", word.text, word.place.line);
  };
  if (inch_) why = feeds(*inch_) + (mm_ ? " and " + feeds(*mm_).substr(14) : ": inches?");
  if (tiny && !(inch_ && mm_))
    why = fmt::format("{}a cutter of {:.6g} would be one of {:.4g} mm in inches: inches?",
                      inch_ ? feeds(*inch_) + ", and " : "", smallest_, smallest_ * kInch);
  throw InputError({name, unstated_->line, unstated_->column},
                   fmt::format("the file states no UNITS before its lengths, and {} State "
                               "toolpath.cam.unit: mm or inch",
                               why.ends_with('?') ? why : why + "."));
}

std::string AptUnit::ToText() const {
  if (unstated_ && options_.unit) return UnitName(*options_.unit) + ", by toolpath.cam.unit";
  if (stated_ && !unstated_) return fmt::format("{}, by UNITS in line {}", UnitName(unit_), stated_->line);
  if (mm_) return fmt::format("mm, by {} in line {}", mm_->text, mm_->place.line);
  return "mm, by the size of the cutter";
}

}  // namespace millpose
