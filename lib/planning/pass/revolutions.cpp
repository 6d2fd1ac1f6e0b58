// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/revolutions.hpp"

#include <limits>

#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "toolpath/pass_variants.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;
// Of full revolutions of all joints of a piece: ordinary arms have 8, with ±360° on every axis 64. Each costs
// memory, and time by their square.
constexpr double kMostCombinations = 256;

/// A piece as the search over turns sees it: the course of its joints, made continuous.
struct Course {
  PassResult* pass = nullptr;
  const Segment* piece = nullptr;
  std::vector<Joints> joints;  ///< of its points; for a closed piece the first again at the end
  bool reversible = false;
};

std::vector<Course> Courses(std::vector<PassResult>& passes, bool free_directions) {
  std::vector<Course> courses;
  for (PassResult& pass : passes) {
    for (const Segment& piece : pass.pieces) {
      Course course{&pass, &piece, {}, free_directions && pass.pieces.size() == 1};
      for (int i = piece.first; i <= piece.last; ++i) {
        const Joints& q = pass.points[i].q;
        course.joints.push_back(course.joints.empty() ? q : NearestEquivalent(course.joints.back(), q));
      }
      if (piece.closed)
        course.joints.push_back(NearestEquivalent(course.joints.back(), course.joints.front()));
      courses.push_back(std::move(course));
    }
  }
  return courses;
}

/// Full revolutions that keep joint `j` of a course within the limits: first..last. Where there are none, the
/// one that violates them least.
std::pair<int, int> TurnRange(const Course& course, int j, double lower, double upper) {
  double least = course.joints.front()[j], most = least;
  for (const Joints& q : course.joints) {
    least = std::min(least, q[j]);
    most = std::max(most, q[j]);
  }
  constexpr double kSlack = 1e-9;  // rad: poses planned exactly on a limit
  const int first = static_cast<int>(std::ceil((lower - kSlack - least) / kTurn));
  const int last = static_cast<int>(std::floor((upper + kSlack - most) / kTurn));
  if (first <= last) return {first, last};
  const int centred = static_cast<int>(std::round((0.5 * (lower + upper) - 0.5 * (least + most)) / kTurn));
  return {centred, centred};
}

/// A way to run a course.
struct State {
  Joints shift = Joints::Zero();  ///< full revolutions, rad
  bool reversed = false;
  Joints start, end;
  double cost = 0;  ///< least, up to here
  size_t before = 0;
};

/// The full revolutions of each joint to choose from. Of more than kMostCombinations those farthest from home
/// are left out, where there are most; `narrowed` tells.
std::array<std::pair<int, int>, 6> TurnRanges(const Course& course, const TurnOptions& options,
                                              bool& narrowed) {
  std::array<std::pair<int, int>, 6> ranges;
  for (int j = 0; j < 6; ++j)
    ranges[static_cast<size_t>(j)] = TurnRange(course, j, options.lower[j], options.upper[j]);
  const auto width = [](const std::pair<int, int>& range) { return range.second - range.first + 1; };
  const auto combinations = [&] {
    double product = 1;
    for (const auto& range : ranges) product *= width(range);
    return product;
  };
  narrowed = combinations() > kMostCombinations;
  while (combinations() > kMostCombinations) {
    const auto widest = std::ranges::max_element(ranges, {}, width);
    const auto j = static_cast<Eigen::Index>(widest - ranges.begin());
    const auto from_home = [&](int turns) {
      return std::abs(course.joints.front()[j] + kTurn * turns - options.home[j]);
    };
    if (from_home(widest->first) > from_home(widest->second))
      ++widest->first;
    else
      --widest->second;
  }
  return ranges;
}

std::vector<State> StatesOf(const Course& course, const TurnOptions& options, bool& narrowed) {
  std::vector<State> states(1);
  const auto ranges = TurnRanges(course, options, narrowed);
  for (int j = 0; j < 6; ++j) {
    const auto [first, last] = ranges[static_cast<size_t>(j)];
    std::vector<State> more;
    for (const State& state : states) {
      for (int k = first; k <= last; ++k) {
        more.push_back(state);
        more.back().shift[j] = kTurn * k;
      }
    }
    states = std::move(more);
  }
  if (course.reversible) {
    const size_t count = states.size();
    for (size_t i = 0; i < count; ++i) {
      states.push_back(states[i]);
      states.back().reversed = true;
    }
  }
  for (State& state : states) {
    state.start = course.joints.front() + state.shift;
    state.end = course.joints.back() + state.shift;
    if (state.reversed) std::swap(state.start, state.end);
  }
  return states;
}

double Turning(const Joints& from, const Joints& to) { return (to - from).cwiseAbs().sum(); }

/// One state per course: a dynamic program over the courses in their order. Of equals the first. `narrowed`:
/// courses of which not all combinations were looked at.
std::vector<State> Choose(const std::vector<Course>& courses, const TurnOptions& options, size_t& narrowed) {
  std::vector<std::vector<State>> stages;
  for (const Course& course : courses) {
    bool left_out = false;
    std::vector<State> states = StatesOf(course, options, left_out);
    narrowed += left_out ? 1 : 0;
    for (State& state : states) {
      state.cost = Turning(options.home, state.start);
      if (!stages.empty()) {
        state.cost = std::numeric_limits<double>::infinity();
        for (size_t p = 0; p < stages.back().size(); ++p) {
          const double cost = stages.back()[p].cost + Turning(stages.back()[p].end, state.start);
          if (cost < state.cost) state.cost = cost, state.before = p;
        }
      }
      if (state.reversed) state.cost += kReversal;
    }
    stages.push_back(std::move(states));
  }
  std::vector<State> chosen;
  size_t at = 0;
  for (size_t i = stages.size(); i-- > 0;) {
    if (chosen.empty()) {
      double best = std::numeric_limits<double>::infinity();
      for (size_t p = 0; p < stages[i].size(); ++p) {
        const double cost = stages[i][p].cost + Turning(stages[i][p].end, options.home);
        if (cost < best) best = cost, at = p;
      }
    }
    chosen.push_back(stages[i][at]);
    at = stages[i][at].before;
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

/// Turns a pass round that is one piece; `joints` as the course has them, already shifted.
void Reverse(PassResult& pass, const std::vector<Joints>& joints) {
  Segment& piece = pass.pieces.front();
  std::vector<PlannedPoint>& points = pass.points;
  const int count = static_cast<int>(points.size());
  double length = points.back().point.arc_length;
  if (piece.closed) {  // begins where it began
    length += (points.front().point.position - points.back().point.position).norm();
    std::reverse(points.begin() + 1, points.end());
    for (int i = 0; i < count; ++i) points[i].q = joints[static_cast<size_t>(count - i)];
  } else {
    std::reverse(points.begin(), points.end());
    std::swap(piece.first, piece.last);
    piece.first = count - 1 - piece.first;
    piece.last = count - 1 - piece.last;
    for (int i = piece.first; i <= piece.last; ++i) points[i].q = joints[static_cast<size_t>(piece.last - i)];
  }
  if (points.front().external) pass.external = *points.front().external;
  for (PlannedPoint& planned : points) {
    ReversePass(length, planned.point);
    if (piece.closed && &planned == &points.front()) planned.point.arc_length = 0;
  }
}

}  // namespace

size_t ChooseRevolutions(std::vector<PassResult>& passes, const TurnOptions& options) {
  std::vector<Course> courses = Courses(passes, options.free_directions);
  size_t narrowed = 0;
  const std::vector<State> chosen = Choose(courses, options, narrowed);
  for (size_t i = 0; i < courses.size(); ++i) {
    Course& course = courses[i];
    for (Joints& q : course.joints) q += chosen[i].shift;
    if (chosen[i].reversed) {
      Reverse(*course.pass, course.joints);
      continue;
    }
    for (int k = course.piece->first; k <= course.piece->last; ++k) {
      course.pass->points[k].q = course.joints[static_cast<size_t>(k - course.piece->first)];
    }
  }
  return narrowed;
}

}  // namespace millpose
