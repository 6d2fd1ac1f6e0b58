// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/fixed_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace millpose {
namespace {

/// A pass's planned points on one branch.
struct BranchCourse {
  bool serves = true;
  double sum = 0;
  std::vector<Joints> q;
};

/// `q` with the full revolutions that bring each joint nearest to `near`.
Joints NearestTurn(Joints q, const Joints& near) {
  for (int i = 0; i < 6; ++i) q[i] -= 2 * kPi * std::round((q[i] - near[i]) / (2 * kPi));
  return q;
}

std::array<BranchCourse, 8> Courses(const PassResult& pass, const Stations& stations, double rotation) {
  std::array<BranchCourse, 8> courses;
  std::array<Candidate, 8> candidates;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    if (pass.points[t].skip != Infeasibility::kNone) continue;
    const std::shared_ptr<const Station> station = stations.Of(pass, t);
    const FreedomValues freedoms{rotation};
    PointScorer(station->problem, pass.points[t].point, pass.rotation_reference)
        .Score({&freedoms, 1}, candidates);
    for (size_t branch = 0; branch < 8; ++branch) {
      BranchCourse& course = courses[branch];
      course.serves = course.serves && candidates[branch].obstacle == Infeasibility::kNone;
      if (!course.serves) continue;
      course.sum += candidates[branch].objective;
      const Joints& q = candidates[branch].q;
      course.q.push_back(course.q.empty() ? q : NearestTurn(q, course.q.back()));
    }
  }
  return courses;
}

}  // namespace

std::optional<PlanResult> AtFixedRotation(const PlanResult& plan, const Stations& stations, double rotation,
                                          std::string* why) {
  PlanResult fixed = plan;
  for (PassResult& pass : fixed.passes) {
    const std::array<BranchCourse, 8> courses = Courses(pass, stations, rotation);
    const auto best = std::ranges::min_element(
        courses, {}, [](const BranchCourse& course) { return course.serves ? course.sum : kInfinity; });
    if (!best->serves) {
      if (why)
        *why = fmt::format("at {:.6g} deg no branch serves all points of pass {}", RadToDeg(rotation),
                           pass.pass);
      return std::nullopt;
    }
    size_t next = 0;
    for (PlannedPoint& point : pass.points) {
      if (point.skip != Infeasibility::kNone) continue;
      point.q = best->q[next++];
      point.branch = static_cast<int>(best - courses.begin());
      point.freedoms = {rotation};
      point.compensation.reset();
    }
  }
  return fixed;
}

}  // namespace millpose
