// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/cut_check.hpp"

#include "base/trig.hpp"
#include "planning/pass/pass_checks.hpp"

namespace millpose {
namespace {

constexpr int kDeepest = 8;             // halvings of one motion
constexpr double kTubeShare = 0.4;      // of the resolution: how far the tube may reach, about
constexpr double kBeyondFlange = 1.25;  // bodies on the flange, in lengths from the wrist to the tip

/// How far a deviation of the joints can move a body, mm, nearly: decides how finely to look, no more.
double Movement(const Carrier& carrier, const Joints& deviation) {
  const Arm& arm = carrier.arm;
  const double hand =
      kBeyondFlange * (std::abs(arm.d5) + std::abs(arm.d6) + carrier.X_FT.translation().norm());
  const double whole = arm.a1 + arm.a2 + Hypot(arm.d4, arm.dz) + hand;
  return whole * deviation.head<3>().sum() + hand * deviation.tail<3>().sum();
}

/// A straight motion of the tool from q0 to q1, or a part of one.
struct Part {
  const Carrier& carrier;
  Joints q0, q1;
};

/// The carrier of the part begin..end (shares) of a motion, kept in `part`; where nothing rides, that of the
/// whole.
const Carrier& PartOf(const Carrier& whole, double begin, double end, std::optional<Carrier>& part) {
  if (!whole.ride) return whole;
  CoordinatedMotion ride = *whole.ride;
  ride.from = whole.ride->At(begin), ride.to = whole.ride->At(end);
  part = whole;
  part->ride = std::make_shared<const CoordinatedMotion>(std::move(ride));
  return *part;
}

std::optional<CutProblem> Look(Checker& checker, const Part& part, const Joints& deviation,
                               double resolution) {
  const auto found = checker.BlockedBetween(part.q0, part.q1, Phase::kCutting, resolution, deviation);
  return found ? std::optional(CutProblem{found}) : std::nullopt;
}

std::optional<CutProblem> Look(CoordinatedChecker& checker, const Part& part, const Joints& deviation,
                               double resolution) {
  const CoordinatedMotion& ride = *part.carrier.ride;
  const auto found = checker.BlockedBetween({part.q0, ride.from}, {part.q1, ride.to}, Phase::kCutting,
                                            resolution, deviation);
  return found ? std::optional(CutProblem{found->sighting, 0, found->external}) : std::nullopt;
}

template <typename AnyChecker>
std::optional<CutProblem> CheckPart(AnyChecker& checker, const Part& part, double resolution, int depth) {
  const auto& [carrier, q0, q1] = part;
  const std::optional<Joints> deviation = JointDeviation(carrier, q0, q1);
  const std::optional<Joints> middle = deviation ? OnLine(carrier, q0, q1, 0.5) : std::nullopt;
  if (!middle) return CutProblem{};
  if (depth == kDeepest || Movement(carrier, *deviation) <= kTubeShare * resolution)
    return Look(checker, part, *deviation, resolution);
  std::optional<Carrier> early, late;
  const auto first = CheckPart(checker, {PartOf(carrier, 0, 0.5, early), q0, *middle}, resolution, depth + 1);
  return first ? first
               : CheckPart(checker, {PartOf(carrier, 0.5, 1, late), *middle, q1}, resolution, depth + 1);
}

}  // namespace

std::optional<CutProblem> CheckCut(CoordinatedChecker& checker, const Carrier& carrier, const Joints& q0,
                                   const Joints& q1, double resolution) {
  return CheckPart(checker, {carrier, q0, q1}, resolution, 0);
}

std::optional<CutProblem> CheckCut(Checker& checker, const Carrier& carrier, const Joints& q0,
                                   const Joints& q1, double resolution) {
  return CheckPart(checker, {carrier, q0, q1}, resolution, 0);
}

std::string Describe(Checker& checker, const CutProblem& problem) {
  if (problem.gouge > 0) return fmt::format("the cutter would go {:.3f} mm into the part", problem.gouge);
  if (!problem.sighting) return "the straight motion to the next point leaves the arm's configuration";
  return Describe(checker.Measure(*problem.sighting));
}

}  // namespace millpose
