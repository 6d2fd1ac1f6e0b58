// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/job_planner.hpp"

#include <limits>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;

/// `angle` plus full turns, as near to `reference` as they bring it.
double Near(double angle, double reference) {
  return angle + kTurn * std::round((reference - angle) / kTurn);
}

/// A piece as the search over turns sees it: the course of its joints, made continuous.
struct Course {
  PassResult* pass = nullptr;
  const Piece* piece = nullptr;
  std::vector<Joints> joints;  ///< of its points; for a closed piece the first again at the end
};

std::vector<Course> Courses(std::vector<PassResult>& passes) {
  std::vector<Course> courses;
  for (PassResult& pass : passes) {
    for (const Piece& piece : pass.pieces) {
      Course course{&pass, &piece, {}};
      for (int i = piece.first; i <= piece.last; ++i) {
        Joints q = pass.points[i].q;
        for (int j = 0; j < 6 && !course.joints.empty(); ++j) q[j] = Near(q[j], course.joints.back()[j]);
        course.joints.push_back(q);
      }
      if (piece.closed) {
        Joints q = course.joints.front();
        for (int j = 0; j < 6; ++j) q[j] = Near(q[j], course.joints.back()[j]);
        course.joints.push_back(q);
      }
      courses.push_back(std::move(course));
    }
  }
  return courses;
}

/// Full turns that keep joint `j` of a course within the limits: first..last. Where there are none, the one
/// that violates them least.
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

/// Turns of one joint for all courses in their order: a dynamic programme over the offsets that minimises the
/// turning between them, from home and back to it.
std::vector<int> ChooseTurns(const std::vector<Course>& courses, int j, double home, double lower,
                             double upper) {
  struct Stage {
    int first = 0;
    std::vector<double> cost;
    std::vector<int> previous;
  };
  std::vector<Stage> stages;
  for (size_t i = 0; i < courses.size(); ++i) {
    const auto [first, last] = TurnRange(courses[i], j, lower, upper);
    Stage stage{first, {}, {}};
    for (int k = first; k <= last; ++k) {
      const double start = courses[i].joints.front()[j] + kTurn * k;
      if (i == 0) {
        stage.cost.push_back(std::abs(start - home));
        stage.previous.push_back(0);
        continue;
      }
      double best = std::numeric_limits<double>::infinity();
      int from = 0;
      for (size_t p = 0; p < stages.back().cost.size(); ++p) {
        const double end =
            courses[i - 1].joints.back()[j] + kTurn * (stages.back().first + static_cast<int>(p));
        const double cost = stages.back().cost[p] + std::abs(start - end);
        if (cost < best) best = cost, from = static_cast<int>(p);
      }
      stage.cost.push_back(best);
      stage.previous.push_back(from);
    }
    stages.push_back(std::move(stage));
  }
  std::vector<int> turns(courses.size());
  if (courses.empty()) return turns;
  size_t at = 0;
  double best = std::numeric_limits<double>::infinity();
  for (size_t p = 0; p < stages.back().cost.size(); ++p) {
    const double end = courses.back().joints.back()[j] + kTurn * (stages.back().first + static_cast<int>(p));
    const double cost = stages.back().cost[p] + std::abs(home - end);
    if (cost < best) best = cost, at = p;
  }
  for (size_t i = courses.size(); i-- > 0;) {
    turns[i] = stages[i].first + static_cast<int>(at);
    at = static_cast<size_t>(stages[i].previous[at]);
  }
  return turns;
}

}  // namespace

void FixTurns(std::vector<PassResult>& passes, const Joints& home, const Joints& lower, const Joints& upper) {
  std::vector<Course> courses = Courses(passes);
  // Turning is counted joint by joint, so each joint is a search of its own.
  for (int j = 0; j < 6; ++j) {
    const std::vector<int> turns = ChooseTurns(courses, j, home[j], lower[j], upper[j]);
    for (size_t i = 0; i < courses.size(); ++i) {
      const Piece& piece = *courses[i].piece;
      for (int k = piece.first; k <= piece.last; ++k) {
        courses[i].pass->points[k].q[j] = courses[i].joints[k - piece.first][j] + kTurn * turns[i];
      }
    }
  }
}

std::vector<std::pair<GapEnd, GapEnd>> GapEnds(const Joints& home_joints,
                                               const std::vector<PassResult>& passes) {
  const GapEnd home{-1, -1, home_joints};
  std::vector<std::pair<GapEnd, GapEnd>> gaps;
  GapEnd from = home;
  for (const PassResult& pass : passes) {
    for (const Piece& piece : pass.pieces) {
      GapEnd start{pass.pass, piece.piece, pass.points[piece.first].q};
      GapEnd end{pass.pass, piece.piece, pass.points[piece.last].q};
      if (piece.closed) {  // the cut goes on from the last point round to the first
        for (int j = 0; j < 6; ++j) end.q[j] = Near(start.q[j], end.q[j]);
      }
      gaps.emplace_back(from, start);
      from = end;
    }
  }
  if (!gaps.empty()) gaps.emplace_back(from, home);
  return gaps;
}

}  // namespace millpose
