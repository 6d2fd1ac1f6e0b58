// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/pose_reason.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kSame = 0.002;    // relative: not worth telling apart
constexpr double kStiffer = 0.02;  // relative: a forbidden pose that is worth telling

std::string Value(const PoseReason& reason, double objective) {
  return fmt::format("{:.4g}{}{}", objective, reason.unit.empty() ? "" : " ", reason.unit);
}

std::string Text(const PoseReason& reason, const PoseAt& pose) {
  return fmt::format("{:.0f} deg (S{}, {})", RadToDeg(pose.rotation), pose.branch,
                     Value(reason, pose.objective));
}

bool IsSame(double a, double b) { return std::abs(a - b) <= kSame * std::abs(b); }

std::string OfForbidden(const PoseReason& reason) {
  const ForbiddenPose& forbidden = *reason.forbidden;
  if (forbidden.joint < 0)
    return fmt::format("stiffer without limits: {}, but that is singular", Text(reason, forbidden.pose));
  return fmt::format("stiffer without limits: {}, but axis {} is {:.0f} deg beyond its limit there",
                     Text(reason, forbidden.pose), forbidden.joint + 1,
                     std::ceil(RadToDeg(forbidden.beyond)));
}

std::string OfOptimum(const PoseReason& reason) {
  const std::string optimum = "the optimum at " + Text(reason, reason.own);
  if (reason.barred.empty()) return optimum + " is free of interference";
  if (reason.beyond > 0)
    return fmt::format("{} is {:.0f} deg beyond where {} come too near", optimum, RadToDeg(reason.beyond),
                       reason.barred);
  return fmt::format("{} is blocked: {} come too near, and no rotation on its branch is known to be free",
                     optimum, reason.barred);
}

/// Why the path does not take the best free pose.
std::string OfContinuity(const PoseReason& reason) {
  const std::string best = "the best free pose at " + Text(reason, reason.free);
  if (reason.free.branch != reason.path.branch)
    return fmt::format("{} is on branch S{}, the cut runs on S{} and cannot change", best, reason.free.branch,
                       reason.path.branch);
  const double turn = reason.path.rotation - reason.free.rotation;
  const double away = std::abs(RadToDeg(turn - 2 * kPi * std::floor(turn / (2 * kPi) + 0.5)));
  if (reason.stretch.to_the_ends)
    return fmt::format(
        "{} is {:.0f} deg away: it can be followed along the whole cut, but the cut as a whole is "
        "better as planned",
        best, away);
  return fmt::format(
      "{} can be followed for {:.0f} mm only ({}): the cut would have to turn by {:.0f} deg and "
      "back within that",
      best, reason.stretch.length, reason.stretch.obstacle, away);
}

/// Of a pose whose lean was chosen too.
std::string OfLean(const PoseReason& reason) {
  const std::string own = Value(reason, reason.own.objective), free = Value(reason, reason.free.objective);
  if (IsSame(reason.path.objective, reason.own.objective))
    return "that is the point's own optimum over all leans";
  if (reason.barred.empty()) return "the point's own optimum over all leans is " + own;
  return fmt::format(
      "over all leans the point's own optimum is {}, where {} come too near, and the best free "
      "pose known has {}",
      own, reason.barred, free);
}

}  // namespace

std::vector<std::string> ReasonSentences(const PoseReason& reason) {
  if (!reason.skipped.empty()) return {"skipped: " + reason.skipped};
  std::vector<std::string> sentences{"the path has " + Text(reason, reason.path)};
  if (reason.lean)
    sentences.back() += fmt::format(", lead {:.1f} and tilt {:.1f} deg", RadToDeg((*reason.lean)[0]),
                                    RadToDeg((*reason.lean)[1]));
  if (reason.forbidden && reason.forbidden->pose.objective < (1 - kStiffer) * reason.own.objective)
    sentences.push_back(OfForbidden(reason));
  if (reason.lean) {
    sentences.push_back(OfLean(reason));
    return sentences;
  }
  if (IsSame(reason.path.objective, reason.own.objective)) {
    sentences.push_back("that is the point's own optimum");
    return sentences;
  }
  sentences.push_back(OfOptimum(reason));
  const double unsmoothed = reason.unsmoothed > 0 ? reason.unsmoothed : reason.path.objective;
  const bool is_smoothed = !IsSame(reason.path.objective, unsmoothed);
  if (!IsSame(unsmoothed, reason.free.objective))
    sentences.push_back(OfContinuity(reason));
  else if (!is_smoothed)
    sentences.push_back("the path has the best free pose");
  if (is_smoothed)
    sentences.push_back(fmt::format("smoothing changed the objective by {:+.1f} %",
                                    100 * (reason.path.objective / unsmoothed - 1)));
  return sentences;
}

}  // namespace millpose
