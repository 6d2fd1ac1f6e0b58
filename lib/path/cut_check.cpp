// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/cut_check.hpp"

#include "base/trig.hpp"
#include "path/pass_checks.hpp"

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

std::optional<CutProblem> CheckPart(Checker& checker, const Carrier& carrier, const Joints& q0,
                                    const Joints& q1, double resolution, int depth) {
  const std::optional<Joints> deviation = JointDeviation(carrier, q0, q1);
  const std::optional<Joints> middle = deviation ? OnLine(carrier, q0, q1, 0.5) : std::nullopt;
  if (!middle) return CutProblem{};
  if (depth == kDeepest || Movement(carrier, *deviation) <= kTubeShare * resolution) {
    const auto found = checker.BlockedBetween(q0, q1, Phase::kCutting, resolution, *deviation);
    return found ? std::optional(CutProblem{found}) : std::nullopt;
  }
  const auto first = CheckPart(checker, carrier, q0, *middle, resolution, depth + 1);
  return first ? first : CheckPart(checker, carrier, *middle, q1, resolution, depth + 1);
}

Carrier PartOf(const Carrier& carrier, double begin, double end) {
  Carrier part = carrier;
  Ride ride = *carrier.ride;
  ride.from = carrier.ride->At(begin), ride.to = carrier.ride->At(end);
  part.ride = std::make_shared<const Ride>(std::move(ride));
  return part;
}

std::optional<CutProblem> CheckRide(RidingChecker& checker, const Carrier& carrier, const Joints& q0,
                                    const Joints& q1, double resolution, int depth) {
  const std::optional<Joints> deviation = JointDeviation(carrier, q0, q1);
  const std::optional<Joints> middle = deviation ? OnLine(carrier, q0, q1, 0.5) : std::nullopt;
  if (!middle) return CutProblem{};
  if (depth == kDeepest || Movement(carrier, *deviation) <= kTubeShare * resolution) {
    const auto found = checker.BlockedBetween({q0, carrier.ride->from}, {q1, carrier.ride->to},
                                              Phase::kCutting, resolution, *deviation);
    return found ? std::optional(CutProblem{found->sighting, 0, found->external}) : std::nullopt;
  }
  const auto first = CheckRide(checker, PartOf(carrier, 0, 0.5), q0, *middle, resolution, depth + 1);
  return first ? first : CheckRide(checker, PartOf(carrier, 0.5, 1), *middle, q1, resolution, depth + 1);
}

}  // namespace

std::optional<CutProblem> CheckCut(RidingChecker& checker, const Carrier& carrier, const Joints& q0,
                                   const Joints& q1, double resolution) {
  return CheckRide(checker, carrier, q0, q1, resolution, 0);
}

std::optional<CutProblem> CheckCut(Checker& checker, const Carrier& carrier, const Joints& q0,
                                   const Joints& q1, double resolution) {
  return CheckPart(checker, carrier, q0, q1, resolution, 0);
}

std::string Describe(Checker& checker, const CutProblem& problem) {
  if (problem.gouge > 0) return fmt::format("the cutter would go {:.3f} mm into the part", problem.gouge);
  if (!problem.sighting) return "the straight motion to the next point leaves the arm's configuration";
  return Describe(checker.Measure(*problem.sighting));
}

}  // namespace millpose
