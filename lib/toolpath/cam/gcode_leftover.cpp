// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_leftover.hpp"

namespace millpose {

void CheckLeftOver(const GcodeMove& move, const GcodeModes& modes, bool in_cycle, const std::string& taken,
                   WordTally& tally) {
  const auto is_taken = [&](char letter) { return taken.find(letter) != std::string::npos; };
  for (const auto& [letter, word] : move.parameters)
    if (!is_taken(letter)) tally.AddUnknown(word->address, word->place);
  const bool arc = modes.motion > 1 && !in_cycle;
  if (move.radius && !arc && !in_cycle && !is_taken('R'))
    throw InputError(move.radius->place, "a radius without an arc");
  if (move.turns && !arc) throw InputError(move.turns->place, "TURN without an arc");
  for (const GcodeWord* word : move.centre)
    if (word && !arc && !in_cycle && !is_taken(word->address[0]))
      throw InputError(word->place, word->address + " without an arc");
  if (modes.vector_in_ijk && modes.motion > 1 && (move.HasLinear() || move.HasTurn()))
    throw InputError(move.place, "arcs under G43.5 are not read");
}

void CheckHighSpeed(const GcodeMove& move, double p, WordTally& tally) {
  if ((p != 0 && p != 10000) || move.HasLinear() || move.HasCentre())
    throw InputError(move.place, "G5 is a spline; as a mode of high speed only G5 P10000 and G5 P0 are read");
  tally.CountHarmless("G5");
}

void RefuseKinematics(double m, const SourceLocation& place) {
  throw InputError(place,
                   fmt::format("M{} switches the machine's kinematics, and what it means is each machine's "
                               "own: state toolpath.cam.kinematics_codes, e.g. {{M{}: tip}}, or "
                               "toolpath.cam.tip_programming for the whole file",
                               m, m));
}

}  // namespace millpose
