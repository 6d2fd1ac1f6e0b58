// SPDX-License-Identifier: GPL-3.0-or-later
// Two traces against each other, block by block: ways between cuts as joint motions, cuts by their tips.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/units.hpp"
#include "tests/campaign/polyline.hpp"
#include "tests/campaign/trace.hpp"

namespace millpose::campaign {
namespace {

constexpr double kTolerance = 0.02;  // mm, of verification
constexpr double kAngleTolerance = 0.02 * kRadPerDeg;
constexpr double kClear = 1.6, kHarmless = 0.25;  // of these: clearly changed, hardly anything
constexpr double kSpindleClear = 1.6;             // 1/min; verification: 1
constexpr double kWayClear = 0.1 * kRadPerDeg, kWayHarmless = 0.005 * kRadPerDeg;  // verification: 0.05 deg

/// The worst that was said so far.
struct Verdict {
  Judgement judgement;
  void Say(Effect effect, const std::string& why) {
    if (effect > judgement.effect) judgement = {effect, why};
  }
  /// By how far `value` is from harmless and from clear.
  void Grade(double value, double harmless, double clear, const std::string& why) {
    if (value > harmless)
      Say(value > clear ? Effect::kChanged : Effect::kBorder, fmt::format("{} {:.4g}", why, value));
  }
};

/// Motions of one kind that follow each other, with where they begin.
struct Block {
  Step::Kind kind = Step::Kind::kWay;
  Joints start = Joints::Zero();
  std::map<std::string, double> external;  // likewise
  std::vector<Step> steps;
  bool first = false;  // of the program: where it starts is where its first motion ends
};

std::vector<Block> BlocksOf(const Trace& trace) {
  std::vector<Block> blocks;
  const Step* last = nullptr;
  for (const Step& step : trace.steps) {
    if (step.kind != Step::Kind::kWay && step.kind != Step::Kind::kCut) continue;
    const Step& before = last ? *last : step;
    if (blocks.empty() || blocks.back().kind != step.kind)
      blocks.push_back({step.kind, before.q, before.external, {}, blocks.empty()});
    blocks.back().steps.push_back(step);
    last = &step;
  }
  return blocks;
}

/// How far apart the axes beside the arm's stand, in tolerances.
double ExternalOff(const Step& a, const Step& b) {
  if (a.external.size() != b.external.size()) return kInfinity;
  double off = 0;
  for (const auto& [name, value] : a.external) {
    const auto other = b.external.find(name);
    off = std::max(off, other == b.external.end() ? kInfinity : std::abs(other->second - value));
  }
  return off / kTolerance;  // as many degrees as mm
}

void JudgeWay(const Block& original, const Block& mutant, Verdict& verdict) {
  const auto course = [](const Block& block) {
    std::vector<Joints> way = {block.start};
    for (const Step& step : block.steps) way.push_back(step.q);
    return way;
  };
  const std::vector<Joints> a = course(original), b = course(mutant);
  verdict.Grade(std::max(FarthestOf(a, b), FarthestOf(b, a)), kWayHarmless, kWayClear, "way off by rad");
  Joints before = mutant.start;
  std::map<std::string, double> external = mutant.external;
  for (const Step& step : mutant.steps) {
    const bool stands = (step.q - std::exchange(before, step.q)).norm() < 1e-7 &&
                        step.external == std::exchange(external, step.external);
    if (stands && !(mutant.first && &step == &mutant.steps[0])) continue;
    const auto same_words = [&](const Step& other) { return other.words == step.words; };
    const auto same = [&](const Step& other) { return same_words(other) && other.aside == step.aside; };
    double off = kInfinity;
    for (const Step& other : original.steps)
      if (same_words(other)) off = std::min(off, ExternalOff(other, step));
    if (std::none_of(original.steps.begin(), original.steps.end(), same_words))
      verdict.Say(Effect::kChanged, "words of a way: " + step.words);
    else
      verdict.Grade(off, kHarmless, kClear, "axes beside the arm off by tolerances");
    if (std::none_of(original.steps.begin(), original.steps.end(), same))
      verdict.Say(Effect::kBorder, "holds on a way: " + step.aside);
    if (!step.exact) verdict.Say(Effect::kChanged, "a way-point is rounded");
    verdict.Grade(step.way_speed / original.steps[0].way_speed, 1 + 1e-12, 1.05, "ways faster by");
    if (step.way_speed < original.steps[0].way_speed) verdict.Say(Effect::kBorder, "slower ways");
  }
}

/// mm/min of the tip.
double FeedOf(const Step& step, double length, double angle) {
  double feed = step.seconds > 0 ? length / step.seconds * 60 : step.feed;
  if (step.turn_speed > 0 && angle > 1e-9) feed = std::min(feed, length * step.turn_speed / angle * 60);
  return feed;
}

/// Every sample of `moved` lies on `fixed`, in order.
void JudgeFollow(const Polyline& fixed, const Polyline& moved, Verdict& verdict) {
  Follower follower(fixed, kTolerance, kAngleTolerance);
  for (const Sample& sample : moved.samples)
    verdict.Grade(follower.Follow(sample), kHarmless, kClear, "tip off by tolerances");
}

/// Whether a step that further words (tolerances, the compressor) count for at one of its ends meets the next
/// or the last one there on the straight way of a planned step that stops exactly: there is no corner that
/// they could round.
bool RoundsNothing(const Block& original, const Polyline& fixed, size_t planned, const Block& mutant,
                   const Polyline& moved, size_t at) {
  const auto place = [](const Polyline& line, size_t step, bool end) {
    const Sample* found = nullptr;
    for (size_t i = 0; i < line.samples.size(); ++i) {
      if (line.samples[i].step != step) continue;
      found = &line.samples[i];
      if (!end) return line.samples[i > 0 ? i - 1 : 0].p;
    }
    return found->p;
  };
  const auto elsewhere = [&](bool end) {
    return (place(fixed, planned, end) - place(moved, at, end)).norm() > 2 * kTolerance;
  };
  return original.steps[planned].exact && (mutant.steps[at].exact ? elsewhere(false) : elsewhere(true));
}

void JudgeFeeds(const Block& original, const Polyline& fixed, const Block& mutant, const Polyline& moved,
                Verdict& verdict) {
  Follower follower(fixed, kTolerance, kAngleTolerance);
  for (size_t i = 1; i < moved.samples.size(); ++i) {
    const Sample &from = moved.samples[i - 1], &to = moved.samples[i];
    const size_t at = to.step;
    follower.Follow(Between(from, to));
    const size_t planned = fixed.samples[follower.segment() + 1].step;
    if (moved.lengths[at] < 2 * kTolerance || fixed.lengths[planned] < 2 * kTolerance)
      continue;  // turns only
    const double feed = FeedOf(mutant.steps[at], moved.lengths[at], moved.angles[at]);
    const double wanted = FeedOf(original.steps[planned], fixed.lengths[planned], fixed.angles[planned]);
    verdict.Grade(feed / wanted, 1.005, 1.06, "faster by");
    verdict.Grade(wanted / feed, 1.005, 1 / 0.45, "slower by");
    if (mutant.steps[at].words != original.steps[planned].words)
      verdict.Say(
          RoundsNothing(original, fixed, planned, mutant, moved, at) ? Effect::kBorder : Effect::kChanged,
          "words of a cut: " + mutant.steps[at].words);
    verdict.Grade(ExternalOff(original.steps[planned], mutant.steps[at]), kHarmless, kClear,
                  "axes beside the arm off by tolerances");
    if (mutant.steps[at].aside != original.steps[planned].aside)
      verdict.Say(Effect::kBorder, "holds in a cut: " + mutant.steps[at].aside);
  }
}

/// How far the corner behind step i is rounded at most, in tolerances.
double RoundingAt(const Step& step, const Polyline& line, size_t i) {
  const Corner corner = CornerAt(line, i);
  double reach = std::min(line.lengths[i], line.lengths[i + 1]) / 2;
  if (step.from_corner) reach = std::min(reach, step.blend);
  const bool together = !step.from_corner && step.angle_blend == 0;  // one bound for the whole motion
  if (together && corner.turn > 0) reach = std::min(reach, 4 * step.blend / corner.turn);
  double off = reach / 4 * corner.turn;
  if (!step.from_corner) off = std::min(off, step.blend);
  double turned = reach / 4 * corner.twist;
  if (step.angle_blend > 0) turned = std::min(turned, step.angle_blend);
  return std::max(off / kTolerance, turned / kAngleTolerance);
}

/// How far corners are rounded, against the worst of the original, and whether there is a stop that was none.
void JudgeCorners(const Block& original, const Polyline& fixed, const Block& mutant, const Polyline& moved,
                  Verdict& verdict) {
  double worst = 1;
  for (size_t i = 0; i + 1 < original.steps.size(); ++i)
    if (!original.steps[i].exact) worst = std::max(worst, RoundingAt(original.steps[i], fixed, i));
  for (size_t i = 0; i + 1 < mutant.steps.size(); ++i) {
    const Step& step = mutant.steps[i];
    if (!step.exact) {
      verdict.Grade(RoundingAt(step, moved, i) / worst, worst > 1 ? 1.02 : 0.95, kClear,
                    "corner rounded by tolerances");
      continue;
    }
    const bool planned = std::any_of(original.steps.begin(), original.steps.end(), [&](const Step& other) {
      return other.exact && (other.X_BT.translation() - step.X_BT.translation()).norm() < 1.5 * kTolerance;
    });
    if (!planned) verdict.Say(Effect::kChanged, "stops in a cut");
  }
  // A stop that was planned and is none now.
  for (size_t k = 0; k + 1 < original.steps.size(); ++k) {
    if (!original.steps[k].exact) continue;
    const auto here = [&](const Step& step) {
      return (step.X_BT.translation() - original.steps[k].X_BT.translation()).norm() < kTolerance;
    };
    const auto stops = [&](const Step& step) { return step.exact && here(step); };
    if (std::any_of(mutant.steps.begin(), mutant.steps.end(), here) &&
        std::none_of(mutant.steps.begin(), mutant.steps.end(), stops))
      verdict.Say(Effect::kBorder, "a planned stop is passed");
  }
}

void JudgeCut(const Block& original, const Block& mutant, const Machine& machine, Verdict& verdict) {
  const Polyline fixed = Sampled(original.steps, original.start, machine);
  const Polyline moved = Sampled(mutant.steps, mutant.start, machine);
  JudgeFollow(fixed, moved, verdict);
  JudgeFollow(moved, fixed, verdict);
  if (verdict.judgement.effect == Effect::kChanged) return;
  JudgeFeeds(original, fixed, mutant, moved, verdict);
  JudgeCorners(original, fixed, mutant, moved, verdict);
  for (size_t i = 0; i < mutant.steps.size(); ++i)
    if (moved.lengths[i] < 1e-6 && moved.angles[i] < 1e-7)
      verdict.Say(Effect::kBorder, "goes nowhere in a cut");
}

/// Words of a switch that differ by at most 1 in the number at their end: revolutions per minute.
bool HardlyDiffer(const std::string& a, const std::string& b) {
  const size_t i = a.find_last_not_of("0123456789.-") + 1, k = b.find_last_not_of("0123456789.-") + 1;
  if (i == a.size() || k == b.size() || a.substr(0, i) != b.substr(0, k)) return false;
  const bool speed = a.find("$ANOUT") != std::string::npos || a[i - 1] == 'S';
  return speed && std::abs(std::stod(a.substr(i)) - std::stod(b.substr(k))) < kSpindleClear;
}

/// Outputs and the like in their order, at their places; waits.
void JudgeEvents(const Trace& original, const Trace& mutant, Verdict& verdict) {
  const auto of = [](const Trace& trace, Step::Kind kind) {
    std::vector<size_t> events;
    for (size_t i = 0; i < trace.steps.size(); ++i)
      if (trace.steps[i].kind == kind) events.push_back(i);
    return events;
  };
  // Between two cuts the place of a switch counts little: how many cuts are before it does.
  const auto cuts_before = [](const Trace& trace, size_t i) {
    return std::count_if(trace.steps.begin(), trace.steps.begin() + static_cast<long>(i),
                         [](const Step& step) { return step.kind == Step::Kind::kCut; });
  };
  const auto in_way = [](const Trace& trace, size_t i) {
    const auto moves = [&](size_t k) {
      return trace.steps[k].kind == Step::Kind::kWay || trace.steps[k].kind == Step::Kind::kCut;
    };
    size_t before = i, behind = i;
    while (before > 0 && !moves(before)) --before;
    while (behind + 1 < trace.steps.size() && !moves(behind)) ++behind;
    return trace.steps[before].kind != Step::Kind::kCut || trace.steps[behind].kind != Step::Kind::kCut;
  };
  for (const Step::Kind kind : {Step::Kind::kSwitch, Step::Kind::kStop}) {
    const std::vector<size_t> a = of(original, kind), b = of(mutant, kind);
    size_t i = 0, k = 0;
    for (; i < a.size() && k < b.size(); ++k) {
      const Step &planned = original.steps[a[i]], &given = mutant.steps[b[k]];
      const double off = (planned.X_BT.translation() - given.X_BT.translation()).norm();
      const bool way = in_way(original, a[i]) && in_way(mutant, b[k]) &&
                       cuts_before(original, a[i]) == cuts_before(mutant, b[k]);
      const bool hardly = planned.words != given.words && HardlyDiffer(planned.words, given.words);
      if (hardly) verdict.Say(Effect::kBorder, "nearly switched so: " + given.words);
      if ((planned.words == given.words || hardly) && (way || off <= kClear * kTolerance)) {
        if (off > kTolerance && given.words != "end")
          verdict.Say(Effect::kBorder, "switched elsewhere on a way");
        ++i;
        continue;
      }
      if (kind == Step::Kind::kSwitch) return verdict.Say(Effect::kChanged, "switched: " + given.words);
      // A wait that is not planned marks the cut where the tool would have gone on.
      const bool cutting = b[k] > 0 && b[k] + 1 < mutant.steps.size() &&
                           mutant.steps[b[k] - 1].kind == Step::Kind::kCut && !mutant.steps[b[k] - 1].exact;
      verdict.Say(cutting ? Effect::kChanged : Effect::kBorder, "waits: " + given.words);
    }
    if (i < a.size()) return verdict.Say(Effect::kChanged, "not switched: " + original.steps[a[i]].words);
    for (; k < b.size(); ++k) {
      const bool cutting =
          b[k] > 0 && mutant.steps[b[k] - 1].kind == Step::Kind::kCut && !mutant.steps[b[k] - 1].exact;
      verdict.Say(kind == Step::Kind::kSwitch || cutting ? Effect::kChanged : Effect::kBorder,
                  "more: " + mutant.steps[b[k]].words);
    }
  }
}

bool SameBlock(const Block& a, const Block& b) {
  const auto same = [](const Step& x, const Step& y) {
    return x.q == y.q && x.straight == y.straight && x.angles == y.angles && x.feed == y.feed &&
           x.seconds == y.seconds && x.turn_speed == y.turn_speed && x.way_speed == y.way_speed &&
           x.exact == y.exact && x.blend == y.blend && x.angle_blend == y.angle_blend && x.words == y.words &&
           x.aside == y.aside && x.external == y.external;
  };
  return a.kind == b.kind && a.start == b.start && a.external == b.external &&
         std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(), b.steps.end(), same);
}

}  // namespace

Judgement Judge(const Trace& original, const Trace& mutant, const Machine& machine) {
  if (!mutant.refused.empty()) return {Effect::kRefused, mutant.refused};
  Verdict verdict;
  if (mutant.open != original.open) verdict.Say(Effect::kBorder, mutant.open);
  if (mutant.guards < original.guards)
    verdict.Say(Effect::kChanged, "moves where the controller's frame is another");
  JudgeEvents(original, mutant, verdict);
  const std::vector<Block> a = BlocksOf(original), b = BlocksOf(mutant);
  if (a.size() != b.size())
    return {Effect::kChanged, fmt::format("{} blocks of motions for {}", b.size(), a.size())};
  for (size_t i = 0; i < a.size() && verdict.judgement.effect != Effect::kChanged; ++i) {
    if (SameBlock(a[i], b[i])) continue;
    if (a[i].kind != b[i].kind) return {Effect::kChanged, "another kind of motion"};
    if (a[i].kind == Step::Kind::kWay)
      JudgeWay(a[i], b[i], verdict);
    else
      JudgeCut(a[i], b[i], machine, verdict);
  }
  return verdict.judgement;
}

}  // namespace millpose::campaign
