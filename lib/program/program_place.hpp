// SPDX-License-Identifier: GPL-3.0-or-later
// Where a statement stands among the motions of a program, and which statements may stand where.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// A place among the motions, by the motions before and behind it.
enum class ProgramPlace : uint8_t {
  kHead,     ///< before the first motion
  kWay,      ///< between two joint motions
  kEntry,    ///< behind a way, before the straight approach
  kCut,      ///< between two motions with feed
  kStop,     ///< likewise, behind an exact stop: end of an approach, handover to another file
  kBetween,  ///< behind a retract, before the next way
  kTail      ///< behind the last motion
};

/// A set of places.
class Places {
 public:
  constexpr Places(std::initializer_list<ProgramPlace> places) {
    for (const ProgramPlace place : places) bits_ |= 1u << static_cast<unsigned>(place);
  }
  constexpr bool Contains(ProgramPlace place) const {
    return (bits_ >> static_cast<unsigned>(place) & 1u) != 0;
  }
  /// "before the first motion, in a way": for messages.
  std::string Text() const;

 private:
  unsigned bits_ = 0;
};

/// Everywhere but in a cut, its approach and its retract.
inline constexpr Places kOutsideCuts = {ProgramPlace::kHead, ProgramPlace::kWay, ProgramPlace::kEntry,
                                        ProgramPlace::kBetween, ProgramPlace::kTail};
/// Likewise, and where a cut stands still anyway: settings that only the next motions see.
inline constexpr Places kAtStops = {ProgramPlace::kHead,    ProgramPlace::kWay,  ProgramPlace::kEntry,
                                    ProgramPlace::kBetween, ProgramPlace::kTail, ProgramPlace::kStop};
inline constexpr Places kHeadOnly = {ProgramPlace::kHead};
inline constexpr Places kTailOnly = {ProgramPlace::kTail};

/// Where a statement stands that was read before motion `before_motion` of a whole program.
ProgramPlace PlaceOf(const MotionProgram& program, size_t before_motion);

/// Statements whose place is known only when the motion behind them is.
class PlaceRules {
 public:
  /// The statement `what` at `at`, read before motion `before_motion`, may stand at `places` alone.
  void Add(SourceLocation at, std::string what, size_t before_motion, Places places);
  /// Those that stand elsewhere in the whole program.
  std::vector<Problem> Broken(const MotionProgram& program) const;

 private:
  struct Rule {
    SourceLocation at;
    std::string what;
    size_t before_motion;
    Places places;
  };
  std::vector<Rule> rules_;
};

}  // namespace millpose
