// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_cycle.hpp"

#include <set>

namespace millpose {
namespace {

constexpr double kChipRetract =
    0.254;  // mm, between the strokes of G73: LinuxCNC's; others keep it to themselves

// Motions are all they are. The others stop, orient or synchronise the spindle.
const std::set<double> kDrilling{73, 81, 82, 83, 85, 89};
const std::set<double> kSpindle{74, 76, 84, 84.2, 84.3, 86, 87, 88};

}  // namespace

bool GcodeCycles::IsCycle(double g) { return kDrilling.contains(g) || kSpindle.contains(g); }

bool GcodeCycles::TakeG(double g) {
  if (g == 98 || g == 99) {
    returns_to_initial_ = g == 98;
  } else if (g == 80) {
    End();
  } else if (IsCycle(g)) {
    if (!active_) {
      clearance_.reset();
      bottom_.reset();
      peck_.reset();
      initial_ = motion_.at()[motion_.DrillingAxis()];
    }
    active_ = g;
  } else {
    return false;
  }
  return true;
}

void GcodeCycles::TakeHeights(const GcodeMove& move, const GcodeMotion::ValueOf& value_of) {
  const auto k = static_cast<size_t>(motion_.DrillingAxis());
  if (move.radius) clearance_ = value_of(*move.radius) * modes_.Unit() + (modes_.incremental ? initial_ : 0);
  if (const GcodeWord* depth = move.linear[k]) {
    const double value = value_of(*depth) * modes_.Unit();
    if (modes_.incremental && !clearance_) throw InputError(depth->place, "a depth in steps needs its R");
    bottom_ = modes_.incremental ? *clearance_ + value : value;
  }
  if (const GcodeWord* peck = move.Parameter('Q')) peck_ = value_of(*peck) * modes_.Unit();
}

GcodeHole GcodeCycles::Hole(const GcodeMove& move) const {
  GcodeHole hole;
  hole.name = fmt::format("G{}", *active_);
  hole.place = move.place;
  if (kSpindle.contains(*active_)) hole.left_out = "the cycle stops, orients or synchronises the spindle";
  if (!clearance_ || !bottom_)
    throw InputError(move.place,
                     fmt::format("{} needs R and the hole's depth before its first hole", hole.name));
  hole.clearance = *clearance_;
  hole.retract = returns_to_initial_ ? std::max(initial_, *clearance_) : *clearance_;
  const bool pecks = *active_ == 73 || *active_ == 83;
  if (move.centre[0] || move.centre[1]) hole.left_out = "I and J in a cycle are not read";
  if (pecks && !peck_) hole.left_out = "it has no Q";
  if (!hole.left_out.empty()) return hole;
  const Drilling drilling{
      *clearance_, pecks ? EvenStrokes(*clearance_, *bottom_, *peck_, move.place) : std::vector{*bottom_},
      *active_ == 73 ? kChipRetract : 0};
  hole.strokes = Heights(drilling, move.place);
  return hole;
}

void GcodeCycles::Run(const GcodeMove& move, const GcodeMotion::ValueOf& value_of) {
  TakeHeights(move, value_of);
  if (move.HasTurn()) motion_.Turn(move);
  if (!move.HasLinear() && !move.HasTurn() && !move.radius) return;
  // L (LinuxCNC) and K (Fanuc): so many holes, each a step on; 0 only takes over the values.
  const GcodeWord* times = move.Parameter('L') ? move.Parameter('L') : move.centre[2];
  const double count = times ? value_of(*times) : 1;
  if (!(count >= 0 && count <= 10000 && count == std::floor(count)))
    throw InputError(times->place, "the number of holes must be a whole one from 0 to 10000");
  const auto holes = count > 1 && !modes_.incremental ? 1 : static_cast<int>(count);
  for (int i = 0; i < holes; ++i) motion_.Drill(move, Hole(move));
}

}  // namespace millpose
