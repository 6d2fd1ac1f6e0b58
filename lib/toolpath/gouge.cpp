// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/gouge.hpp"

#include <optional>

#include "base/parallel.hpp"

namespace millpose {
namespace {

// The pieces of a mesh that have no rim, which alone have an inside; none when there are none.
std::optional<Mesh> ClosedPieces(const Mesh& mesh) {
  std::vector<char> open(mesh.face_count(), 0);
  std::vector<int> queue;
  const auto mark = [&](int face) {
    if (face < 0 || open[face] != 0) return;
    open[face] = 1;
    queue.push_back(face);
  };
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k)
      if (mesh.Neighbour(face, k) < 0) mark(face);
  for (size_t head = 0; head < queue.size(); ++head)
    for (int k = 0; k < 3; ++k) mark(mesh.Neighbour(queue[head], k));
  if (queue.empty()) return mesh;
  if (queue.size() == open.size()) return std::nullopt;
  Triangles closed;
  closed.vertices = mesh.triangles().vertices;
  for (int face = 0; face < mesh.face_count(); ++face)
    if (open[face] == 0) closed.faces.push_back(mesh.triangles().faces[face]);
  return Mesh(std::move(closed));
}

class GougeChecker {
 public:
  GougeChecker(const Mesh& mesh, const CutterShape& cutter, const GougeOptions& options)
      : mesh_(mesh), solid_(ClosedPieces(mesh)), cutter_(cutter), options_(options) {}

  struct Found {
    Gouge deepest;
    std::array<double, 2> depth{};  // near the way's first and second end
    double lift = 0;
  };

  /// The way from a point to the next; `next` may be the same point.
  Found Look(const MillingPoint& point, const MillingPoint& next) const {
    Found found;
    const double length = (next.position - point.position).norm();
    const int steps = GougeSteps(cutter_, length);
    for (int i = 0; i < steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const Eigen::Vector3d tip = point.position + share * (next.position - point.position);
      const Eigen::Vector3d axis =
          (point.tool_axis + share * (next.tool_axis - point.tool_axis)).normalized();
      const std::vector<Part> parts = Outside(tip, axis, point.own, next.own, share);
      Gouge gouge;
      for (const Part& part : parts)
        if (const Gouge found_here = DeepestOf(part, axis); found_here.depth > gouge.depth)
          gouge = found_here;
      if (gouge.face < 0) continue;
      double& near = found.depth[share < 0.5 ? 0 : 1];
      near = std::max(near, gouge.depth);
      if (gouge.depth > found.deepest.depth) found.deepest = gouge;
      if (options_.action != GougeAction::kLift) continue;
      for (const Part& part : parts) found.lift = std::max(found.lift, LiftOf(part, axis));
    }
    return found;
  }

 private:
  // A stretch of the cutter.
  struct Part {
    CutterShape cutter;
    Eigen::Vector3d tip;
  };

  // The cutter without the stretch that stands in what its own pass cuts open: all of it, what is over that
  // stretch, and what has come out at the far side.
  std::vector<Part> Outside(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis,
                            const std::optional<OwnCut>& own, const std::optional<OwnCut>& next,
                            double share) const {
    constexpr double kOff = 0.01;  // mm, from the part's far side, which the cutter comes out of
    if (!own || !next) return {{cutter_, tip}};
    const double top = own->top + share * (next->top - own->top);
    const double out = own->out + share * (next->out - own->out) - kOff;
    if (top <= 0) return {{cutter_, tip}};
    std::vector<Part> parts;
    if (top < cutter_.length) {
      const double corner = top < cutter_.corner_radius ? cutter_.corner_radius : 0;
      parts.push_back({{cutter_.radius, corner, cutter_.length - top}, tip + top * axis});
    }
    if (out > 0)
      parts.push_back({{cutter_.radius, cutter_.corner_radius, std::min(out, cutter_.length)}, tip});
    return parts;
  }

  Gouge DeepestOf(const Part& part, const Eigen::Vector3d& axis) const {
    Gouge gouge = DeepestGouge(mesh_, part.cutter, part.tip, axis, options_.tolerance);
    if (gouge.face >= 0 || !IsBuried(part, axis)) return gouge;
    const SurfacePoint surface = solid_->Closest(part.tip);
    return {surface.distance, surface.position, surface.face};
  }

  // Of a cutter that touches nothing: its middle tells which side all of it is on.
  bool IsBuried(const Part& part, const Eigen::Vector3d& axis) const {
    return solid_ && solid_->Contains(part.tip + axis * part.cutter.length / 2);
  }

  // How far along the axis the cutter is clear, mm; infinite when not within its length.
  double LiftOf(const Part& part, const Eigen::Vector3d& axis) const {
    const auto clear = [&](double lift) {
      const Part lifted{part.cutter, part.tip + lift * axis};
      return !Gouges(mesh_, part.cutter, lifted.tip, axis, options_.tolerance) && !IsBuried(lifted, axis);
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
  std::optional<Mesh> solid_;
  const CutterShape& cutter_;
  const GougeOptions& options_;
};

struct PointState {
  double depth = 0, lift = 0;
};

// Every way of a pass, from each point to the next (of an open pass the last to itself).
std::vector<GougeChecker::Found> LookAt(const GougeChecker& checker, const Pass& pass,
                                        const Execution& execution) {
  const size_t count = pass.points.size();
  std::vector<GougeChecker::Found> found(count);
  ParallelFor(count, execution.Threads(), execution.stop, [&](size_t i) {
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

int GougeSteps(const CutterShape& cutter, double way) {
  return std::max(1, static_cast<int>(std::ceil(way / std::max(0.5, cutter.radius / 10))));
}

GougeReport CheckGouges(const Mesh& mesh, const CutterShape& cutter, const GougeOptions& options,
                        const Execution& execution, Toolpath& toolpath) {
  const GougeChecker checker(mesh, cutter, options);
  GougeReport report;
  for (Pass& pass : toolpath.passes) {
    const auto found = LookAt(checker, pass, execution);
    for (const auto& way : found)
      if (way.deepest.depth > report.deepest.depth) report.deepest = way.deepest;
    std::vector<PointState> states = StatesOf(found, pass.closed);
    const size_t bad = static_cast<size_t>(
        std::ranges::count_if(states, [](const PointState& state) { return state.depth > 0; }));
    report.points += bad;
    if (bad == 0 || options.action == GougeAction::kReport) continue;
    if (options.action == GougeAction::kLift) {
      Lift(pass, states, report);
      states = StatesOf(LookAt(checker, pass, execution), pass.closed);
    }
    if (!pass.whole) report.leads_left_out += DropLeads(pass, states);  // else its entry counts as all of it
    const double begin = pass.points.empty() ? 0.0 : pass.points[0].arc_length;
    for (MillingPoint& point : pass.points) point.arc_length -= begin;
    for (size_t i = 0; i < states.size(); ++i)
      pass.points[i].gouge = std::max(pass.points[i].gouge, states[i].depth);
  }
  return report;
}

}  // namespace millpose
