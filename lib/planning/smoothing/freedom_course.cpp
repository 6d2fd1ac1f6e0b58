// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/smoothing/freedom_course.hpp"

#include <limits>

#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/pose/score_along.hpp"

namespace millpose {
namespace {

/// What is looked at to either side of a value: for derivatives, and for how far it may go.
constexpr double kNear = 0.03 * kRadPerDeg, kFarther = 8 * kNear, kFar = 64 * kNear;
constexpr double kSamePlace = 1e-9;  // mm
/// Bounds are aimed at with this reserve.
constexpr double kReserve = 0.95, kStepReserve = 0.97;
constexpr double kShareRounding = 1e-12;

bool Moves(const FreedomRange& range) { return range.lower != range.upper; }

/// Nothing changes with it.
bool IsHeld(const CoursePlace& place) { return (place.turn.array() == 0).all(); }

Joints Step(const CoursePlace& from, const CoursePlace& to) { return (to.q - from.q).unaryExpr(&WrapToPi); }

/// Derivatives at a place from what was found around it: `at` and `good` by offsets 0, ±kNear, ±kFarther,
/// ±kFar.
void Derive(CoursePlace& place, const FreedomRange& range, const std::array<Candidate, kLanes>& at,
            const std::array<bool, kLanes>& good) {
  const auto reach = [&](size_t near, size_t farther, size_t far) {
    return !good[near] ? 0 : !good[farther] ? kNear : !good[far] ? kFarther : kFar;
  };
  place.upper = std::min(reach(1, 3, 5), std::max(range.upper - place.x, 0.0));
  place.lower = std::max(-reach(2, 4, 6), std::min(range.lower - place.x, 0.0));
  place.turn = Joints::Zero();
  place.slope = place.curvature = 0;
  if (!good[1] && !good[2]) return;
  const Joints up = good[1] ? at[1].q : place.q, down = good[2] ? at[2].q : place.q;
  const double f_up = good[1] ? at[1].objective : place.objective,
               f_down = good[2] ? at[2].objective : place.objective;
  const double width = kNear * (good[1] + good[2]);
  place.turn = (up - down) / width;
  place.slope = (f_up - f_down) / width;
  if (good[1] && good[2]) {
    place.curvature = std::max(0.0, (f_up - 2 * place.objective + f_down) / (kNear * kNear));
  }
}

}  // namespace

FreedomCourse::FreedomCourse(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                             std::span<const PathNode> path, bool closed, const CourseBounds& bounds)
    : scorers_(scorers),
      points_(points),
      path_(path),
      problem_(scorers[0].problem()),
      bounds_(bounds),
      closed_(closed),
      motions_(closed ? path.size() : path.size() - 1),
      limits_(motions_, std::numeric_limits<double>::infinity()) {
  assert(scorers.size() == path.size() && points.size() == path.size());
  MakeRows();
}

std::vector<CoursePlace> FreedomCourse::Start(std::span<const FreedomRange> ranges) const {
  std::vector<CoursePlace> places(path_.size());
  for (size_t t = 0; t < path_.size(); ++t) {
    places[t].x = path_[t].freedoms[bounds_.freedom];
    places[t].q = path_[t].q, places[t].objective = path_[t].objective;
    if (Moves(ranges[t])) Probe(t, places[t].x, ranges[t], places[t]);
  }
  return places;
}

double FreedomCourse::Way(size_t t) const {  // mm, from t to the next
  const size_t next = Next(t);
  return next ? points_[next].arc_length - points_[t].arc_length
              : (points_[0].position - points_[t].position).norm();
}

/// As RatesAlong: the parabola through a point and its neighbours; at open ends the neighbour's.
void FreedomCourse::MakeRows() {
  const size_t count = path_.size();
  if (count < 3) return;
  double time = 0;
  for (size_t t = 0; t < count; ++t) {
    const size_t middle = closed_ ? t : std::clamp<size_t>(t, 1, count - 2);
    const size_t before = Before(middle), after = Next(middle);
    const double h0 = Way(before), h1 = Way(middle);
    if (h0 < kSamePlace || h1 < kSamePlace) continue;
    const bool first = t == 0 && !closed_, last = t + 1 == count && !closed_;
    const double away = first ? -h0 : last ? h1 : 0, half = first ? h0 / 2 : last ? h1 / 2 : (h0 + h1) / 2;
    const double feed = points_[t].feed_rate;
    const double v0 = points_[first ? t : Before(t)].feed_rate, v1 = points_[last ? t : Next(t)].feed_rate;
    const double tangential = (v1 * v1 - v0 * v0) / (4 * half);
    const double curve = feed * feed + tangential * away, sum = h0 + h1;
    rows_.push_back({before, middle, after, (-2 * curve + tangential * h1) / (h0 * sum),
                     (2 * curve + tangential * h0) / (h1 * sum), half / feed});
    time += half / feed;
  }
  for (AccelerationRow& row : rows_) row.share /= time;
}

std::vector<CoursePlace> FreedomCourse::Moved(const std::vector<double>& x,
                                              std::span<const FreedomRange> ranges,
                                              std::vector<CoursePlace> from) const {
  for (size_t t = 0; t < x.size(); ++t)
    if (Moves(ranges[t]) && x[t] != from[t].x) Probe(t, x[t], ranges[t], from[t]);
  return from;
}

void FreedomCourse::Probe(size_t t, double x, const FreedomRange& range, CoursePlace& place) const {
  constexpr std::array<double, kLanes> offsets{0, kNear, -kNear, kFarther, -kFarther, kFar, -kFar, 0};
  std::array<double, kLanes> values;
  for (size_t l = 0; l < kLanes; ++l) values[l] = x + offsets[l];
  std::array<Candidate, kLanes> at =
      ScoreAlong(scorers_[t], path_[t].freedoms, bounds_.freedom, values, path_[t].branch);
  std::array<bool, kLanes> good;
  for (size_t l = 0; l < kLanes; ++l) {
    at[l].q = NearestEquivalent(place.q, at[l].q);
    // The point itself was admitted before; turned back, its angles may differ by rounding.
    good[l] = at[l].obstacle == Infeasibility::kNone && problem_.bounds.Hold(at[l].q, kRevolutionRounding);
  }
  const bool stays = x == place.x;
  if (!good[0] && !stays) return;
  if (!stays) place.x = x, place.q = at[0].q, place.objective = at[0].objective, place.judged = false;
  Derive(place, range, at, good);
}

Eigen::Vector3d FreedomCourse::Off(size_t t, const Joints& from, const Joints& step) const {
  const auto tip = [&](const Joints& q) {
    return Eigen::Vector3d(ForwardFlange(problem_.arm, q) * problem_.X_FT.translation());
  };
  // A leaning tool's tip is not where the point has it.
  if (!bounds_.max_lean.empty()) return tip(from + 0.5 * step) - 0.5 * (tip(from) + tip(from + step));
  if (!bounds_.middles.empty()) return tip(from + 0.5 * step) - bounds_.middles[t];
  const Eigen::Vector3d middle = 0.5 * (points_[t].position + points_[Next(t)].position);
  return tip(from + 0.5 * step) - problem_.X_WB.inverse(Eigen::Isometry) * middle;
}

/// The change of the freedom on motion t as a share of its bound; 0 for one that does not lean.
double FreedomCourse::LeanShare(const std::vector<CoursePlace>& places, size_t t) const {
  if (bounds_.max_lean.empty() || bounds_.freedom == 0) return 0;
  return (places[Next(t)].x - places[t].x) / bounds_.max_lean[t];
}

Joints FreedomCourse::Acceleration(const std::vector<CoursePlace>& places, const AccelerationRow& row) const {
  return row.left * Step(places[row.before], places[row.middle]) +
         row.right * Step(places[row.middle], places[row.after]);
}

Merit FreedomCourse::Judge(std::vector<CoursePlace>& places) const {
  Merit merit;
  for (const AccelerationRow& row : rows_)
    merit.square += row.share * Acceleration(places, row).squaredNorm();
  for (const CoursePlace& place : places) merit.objective += place.objective;
  for (size_t t = 0; t < motions_; ++t) {
    const Joints step = Step(places[t], places[Next(t)]);
    if (!places[t].judged || !places[Next(t)].judged) places[t].off = Off(t, places[t].q, step);
    const double off = places[t].off.norm() / limits_[t];
    const double beyond = std::max(0.0, off - kReserve);
    merit.violation += beyond * beyond;
    merit.within = merit.within && off <= 1;
    for (int j = 0; j < 6; ++j) {
      const double share = std::abs(step[j]) / bounds_.max_step[t][j],
                   over = std::max(0.0, share - kStepReserve);
      merit.violation += over * over;
      merit.steps = merit.steps && share <= 1 + kShareRounding;
    }
    const double lean = std::abs(LeanShare(places, t)), over = std::max(0.0, lean - kStepReserve);
    merit.violation += over * over;
    merit.steps = merit.steps && lean <= 1 + kShareRounding;
  }
  for (CoursePlace& place : places) place.judged = true;
  return merit;
}

void FreedomCourse::AddTo(BoxLeastSquares& squares, const std::vector<CoursePlace>& places,
                          double square_weight, double objective_weight, double violation_weight) const {
  for (const AccelerationRow& row : rows_) {
    if (IsHeld(places[row.before]) && IsHeld(places[row.middle]) && IsHeld(places[row.after])) continue;
    const Joints acceleration = Acceleration(places, row);
    for (int j = 0; j < 6; ++j) {
      squares.Add<3>(row.share * square_weight, acceleration[j],
                     {{{row.before, -row.left * places[row.before].turn[j]},
                       {row.middle, (row.left - row.right) * places[row.middle].turn[j]},
                       {row.after, row.right * places[row.after].turn[j]}}});
    }
  }
  for (size_t t = 0; t < places.size(); ++t) {
    squares.AddCurve(t, objective_weight * places[t].slope, objective_weight * places[t].curvature);
  }
  for (size_t t = 0; t < motions_; ++t) AddViolations(squares, places, t, violation_weight);
}

void FreedomCourse::AddViolations(BoxLeastSquares& squares, const std::vector<CoursePlace>& places, size_t t,
                                  double weight) const {
  const CoursePlace &from = places[t], &to = places[Next(t)];
  const Joints step = Step(from, to);
  const Eigen::Vector3d off = from.off / limits_[t];
  if (const double size = off.norm(); size > kReserve) {
    // The deviation's own derivatives, along its present direction.
    constexpr double kSmall = 1e-6;
    const Eigen::Vector3d along = off / (size * limits_[t] * kSmall);
    const auto derivative = [&](double first, double second) {
      const Joints moved = step + second * to.turn - first * from.turn;
      return along.dot(Off(t, from.q + first * from.turn, moved) - off * limits_[t]);
    };
    squares.Add<2>(weight, size - kReserve, {{{t, derivative(kSmall, 0)}, {Next(t), derivative(0, kSmall)}}});
  }
  if (const double lean = LeanShare(places, t); std::abs(lean) > kStepReserve) {
    const double scale = (lean > 0 ? 1 : -1) / bounds_.max_lean[t];
    squares.Add<2>(weight, std::abs(lean) - kStepReserve, {{{t, -scale}, {Next(t), scale}}});
  }
  for (int j = 0; j < 6; ++j) {
    const double share = step[j] / bounds_.max_step[t][j];
    if (std::abs(share) <= kStepReserve) continue;
    const double scale = (share > 0 ? 1 : -1) / bounds_.max_step[t][j];
    squares.Add<2>(weight, std::abs(share) - kStepReserve,
                   {{{t, -scale * from.turn[j]}, {Next(t), scale * to.turn[j]}}});
  }
}

}  // namespace millpose
