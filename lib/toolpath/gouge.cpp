// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/gouge.hpp"

#include "base/parallel.hpp"

namespace millpose {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

struct Depth {
  double value;
  Eigen::Vector3d slope;  // a supergradient
};

// Depth of a point given in the tool's frame: negative distance from the rounded cylinder.
Depth DepthAt(const CutterShape& cutter, const Eigen::Vector3d& p) {
  const double r = cutter.corner_radius, distance = std::hypot(p.x(), p.y());
  const double out = distance - (cutter.radius - r), down = r - p.z();
  const Eigen::Vector3d outwards =
      distance > 0 ? Eigen::Vector3d(p.x() / distance, p.y() / distance, 0) : Eigen::Vector3d::UnitX();
  if (out > 0 && down > 0) {
    const double length = std::hypot(out, down);
    return {r - length, (down * Eigen::Vector3d::UnitZ() - out * outwards) / length};
  }
  return out > down ? Depth{r - out, -outwards} : Depth{r - down, Eigen::Vector3d::UnitZ()};
}

/// Branch and bound over triangles in the tool's frame.
class DeepestPoint {
 public:
  DeepestPoint(const CutterShape& cutter, double tolerance) : cutter_(cutter), best_(tolerance) {}

  /// Returns whether a deeper place was found.
  bool Look(const Corners& triangle) {
    bool found = false;
    stack_.assign(1, triangle);
    while (!stack_.empty()) {
      const Corners corner = stack_.back();
      stack_.pop_back();
      const Eigen::Vector3d centre = (corner[0] + corner[1] + corner[2]) / 3;
      const Depth depth = DepthAt(cutter_, centre);
      found = Try(centre, depth.value) || found;
      double bound = -std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& p : corner)
        bound = std::max(bound, depth.value + depth.slope.dot(p - centre));
      if (bound <= best_ + std::max(1e-4, 1e-3 * best_)) continue;
      for (const Eigen::Vector3d& p : corner) found = Try(p, DepthAt(cutter_, p).value) || found;
      Halve(corner);
    }
    return found;
  }

  double best() const { return best_; }
  const Eigen::Vector3d& place() const { return place_; }

 private:
  bool Try(const Eigen::Vector3d& p, double depth) {
    if (!(depth > best_)) return false;
    best_ = depth;
    place_ = p;
    return true;
  }

  void Halve(const Corners& corner) {
    int longest = 0;
    std::array<double, 3> length;
    for (int k = 0; k < 3; ++k) {
      length[k] = (corner[(k + 1) % 3] - corner[k]).squaredNorm();
      if (length[k] > length[longest]) longest = k;
    }
    const Eigen::Vector3d &a = corner[longest], &b = corner[(longest + 1) % 3],
                          &c = corner[(longest + 2) % 3];
    const Eigen::Vector3d middle = (a + b) / 2;
    stack_.push_back({a, middle, c});
    stack_.push_back({middle, b, c});
  }

  const CutterShape& cutter_;
  double best_;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
  std::vector<Corners> stack_;
};

// The part of a triangle that is not above the cutter: none, one or two triangles.
std::vector<Corners> Below(const Corners& corner, double length) {
  std::vector<Eigen::Vector3d> polygon;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d &a = corner[k], &b = corner[(k + 1) % 3];
    if (a.z() <= length) polygon.push_back(a);
    if ((a.z() < length && b.z() > length) || (a.z() > length && b.z() < length))
      polygon.push_back(a + (length - a.z()) / (b.z() - a.z()) * (b - a));
  }
  std::vector<Corners> parts;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) parts.push_back({polygon[0], polygon[i], polygon[i + 1]});
  return parts;
}

class GougeChecker {
 public:
  GougeChecker(const Mesh& mesh, const CutterShape& cutter, const GougeOptions& options)
      : mesh_(mesh), cutter_(cutter), options_(options) {}

  struct Found {
    Gouge deepest;
    std::array<double, 2> depth{};  // near the way's first and second end
    double lift = 0;
  };

  /// The way from a point to the next; `next` may be the same point.
  Found Look(const MillingPoint& point, const MillingPoint& next) const {
    Found found;
    const double length = (next.position - point.position).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / std::max(0.5, cutter_.radius / 10))));
    for (int i = 0; i < steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const Eigen::Vector3d tip = point.position + share * (next.position - point.position);
      const Eigen::Vector3d axis =
          (point.tool_axis + share * (next.tool_axis - point.tool_axis)).normalized();
      const Gouge gouge = DeepestGouge(mesh_, cutter_, tip, axis, options_.tolerance);
      if (gouge.face < 0) continue;
      double& near = found.depth[share < 0.5 ? 0 : 1];
      near = std::max(near, gouge.depth);
      if (gouge.depth > found.deepest.depth) found.deepest = gouge;
      if (options_.action == GougeAction::kLift) found.lift = std::max(found.lift, LiftOf(tip, axis));
    }
    return found;
  }

 private:
  // How far along the axis the cutter is clear, mm; infinite when not within its length.
  double LiftOf(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) const {
    const auto clear = [&](double lift) {
      return DeepestGouge(mesh_, cutter_, tip + lift * axis, axis, options_.tolerance).face < 0;
    };
    double low = 0, high = options_.tolerance;
    while (!clear(high)) {
      low = high;
      high *= 2;
      if (high > cutter_.length) return std::numeric_limits<double>::infinity();
    }
    while (high - low > 1e-3) {
      const double middle = (low + high) / 2;
      (clear(middle) ? high : low) = middle;
    }
    return high;
  }

  const Mesh& mesh_;
  const CutterShape& cutter_;
  const GougeOptions& options_;
};

struct PointState {
  double depth = 0, lift = 0;
};

// Every way of a pass, from each point to the next (of an open pass the last to itself).
std::vector<GougeChecker::Found> LookAt(const GougeChecker& checker, const Pass& pass, int threads,
                                        const std::stop_token& stop) {
  const size_t count = pass.points.size();
  std::vector<GougeChecker::Found> found(count);
  ParallelFor(count, threads, stop, [&](size_t i) {
    const size_t next = i + 1 < count ? i + 1 : pass.closed ? 0 : i;
    found[i] = checker.Look(pass.points[i], pass.points[next]);
  });
  return found;
}

std::vector<PointState> StatesOf(const std::vector<GougeChecker::Found>& found, bool closed) {
  const size_t count = found.size();
  std::vector<PointState> states(count);
  for (size_t i = 0; i < count; ++i) {
    PointState& own = states[i];
    PointState& next = i + 1 < count ? states[i + 1] : closed ? states[0] : own;
    own.depth = std::max(own.depth, found[i].depth[0]);
    next.depth = std::max(next.depth, found[i].depth[1]);
    own.lift = std::max(own.lift, found[i].lift);
    next.lift = std::max(next.lift, found[i].lift);
  }
  return states;
}

// Leaves out a lead in which a point gouges, as a whole: half a lead leads nowhere.
size_t DropLeads(Pass& pass, std::vector<PointState>& states) {
  size_t dropped = 0;
  for (const PointKind kind : {PointKind::kLeadIn, PointKind::kLeadOut}) {
    bool bad = false;
    for (size_t i = 0; i < states.size(); ++i)
      bad = bad || (pass.points[i].kind == kind && states[i].depth > 0);
    if (!bad) continue;
    ++dropped;
    for (size_t i = states.size(); i-- > 0;)
      if (pass.points[i].kind == kind) {
        pass.points.erase(pass.points.begin() + static_cast<std::ptrdiff_t>(i));
        states.erase(states.begin() + static_cast<std::ptrdiff_t>(i));
      }
  }
  return dropped;
}

void Lift(Pass& pass, const std::vector<PointState>& states, GougeReport& report) {
  for (size_t i = 0; i < states.size(); ++i) {
    if (!std::isfinite(states[i].lift)) continue;  // marked afterwards
    pass.points[i].position += states[i].lift * pass.points[i].tool_axis;
    report.largest_lift = std::max(report.largest_lift, states[i].lift);
  }
}

}  // namespace

Gouge DeepestGouge(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
                   const Eigen::Vector3d& axis, double tolerance) {
  Eigen::Matrix3d R;  // rows: the tool's axes
  R.row(0) = axis.unitOrthogonal();
  R.row(2) = axis;
  R.row(1) = axis.cross(R.row(0).transpose());
  DeepestPoint deepest(cutter, tolerance);
  Gouge gouge;
  const double reach = std::hypot(cutter.radius, cutter.length / 2);
  for (const int face : mesh.FacesNear(tip + axis * cutter.length / 2, reach)) {
    Corners corner;
    for (int k = 0; k < 3; ++k) corner[k] = R * (mesh.Corner(face, k) - tip);
    for (const Corners& part : Below(corner, cutter.length))
      if (deepest.Look(part)) gouge = {deepest.best(), tip + R.transpose() * deepest.place(), face};
  }
  return gouge;
}

GougeReport CheckGouges(const Mesh& mesh, const CutterShape& cutter, const GougeOptions& options, int threads,
                        Toolpath& toolpath, std::stop_token stop) {
  const GougeChecker checker(mesh, cutter, options);
  GougeReport report;
  for (Pass& pass : toolpath.passes) {
    const auto found = LookAt(checker, pass, threads, stop);
    for (const auto& way : found)
      if (way.deepest.depth > report.deepest.depth) report.deepest = way.deepest;
    std::vector<PointState> states = StatesOf(found, pass.closed);
    const size_t bad = static_cast<size_t>(
        std::ranges::count_if(states, [](const PointState& state) { return state.depth > 0; }));
    report.points += bad;
    if (bad == 0 || options.action == GougeAction::kReport) continue;
    if (options.action == GougeAction::kLift) {
      Lift(pass, states, report);
      states = StatesOf(LookAt(checker, pass, threads, stop), pass.closed);
    }
    report.leads_left_out += DropLeads(pass, states);
    const double begin = pass.points.empty() ? 0.0 : pass.points[0].arc_length;
    for (MillingPoint& point : pass.points) point.arc_length -= begin;
    for (size_t i = 0; i < states.size(); ++i) pass.points[i].gouge = states[i].depth;
  }
  return report;
}

}  // namespace millpose
