// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/side_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWidth = 560, kHeight = 320, kMargin = 46;  // px

/// What W looks like from the side: r away from axis 1 towards the point, z up.
struct Side {
  Vector3d origin, along;
  Vector2d At(const Vector3d& p) const { return {(p - origin).dot(along), p.z()}; }
  Vector2d Way(const Vector3d& v) const { return {v.dot(along), v.z()}; }
};

Side SideOf(const Vector3d& base, const Vector3d& point) {
  const Vector3d out(point.x() - base.x(), point.y() - base.y(), 0);
  return {base, out.norm() > 1e-6 ? Vector3d(out.normalized()) : Vector3d::UnitX()};
}

double Turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<Vector2d> Hull(std::vector<Vector2d> points) {
  const auto key = [](const Vector2d& p) { return std::pair(p.x(), p.y()); };
  std::ranges::sort(points, {}, key);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vector2d> hull;
  for (const bool back : {false, true}) {
    const size_t floor = hull.size() + (back ? 0 : 1);
    for (size_t i = back ? 1 : 0; i < points.size(); ++i) {
      const Vector2d& p = back ? points[points.size() - 1 - i] : points[i];
      while (hull.size() > floor && Turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
  }
  hull.pop_back();  // the first again
  return hull;
}

/// From mm to the picture.
class Frame {
 public:
  explicit Frame(const Eigen::AlignedBox2d& box)
      : box_(box),
        scale_(std::min((kWidth - 2 * kMargin) / std::max(box.sizes().x(), 1.0),
                        (kHeight - 2 * kMargin) / std::max(box.sizes().y(), 1.0))) {}
  std::string At(const Vector2d& p) const { return fmt::format("{:.1f},{:.1f}", X(p), Y(p)); }
  double X(const Vector2d& p) const { return kMargin + (p.x() - box_.min().x()) * scale_; }
  double Y(const Vector2d& p) const { return kHeight - kMargin - (p.y() - box_.min().y()) * scale_; }

 private:
  Eigen::AlignedBox2d box_;
  double scale_;
};

std::string Line(const Frame& frame, const Vector2d& from, const Vector2d& to, const std::string& style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>", frame.X(from),
                     frame.Y(from), frame.X(to), frame.Y(to), style);
}

/// A triangle at the end of an arrow.
std::string Head(const Frame& frame, const Vector2d& from, const Vector2d& to) {
  const Vector2d tip(frame.X(to), frame.Y(to)), way = tip - Vector2d(frame.X(from), frame.Y(from));
  if (way.norm() < 1) return {};  // straight towards who looks
  const Vector2d u = way.normalized(), v(-u.y(), u.x()), a = tip - 11 * u + 5 * v, b = tip - 11 * u - 5 * v;
  return fmt::format("<polygon points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\" fill=\"var(--bad)\"/>",
                     tip.x(), tip.y(), a.x(), a.y(), b.x(), b.y());
}

std::string Label(const Frame& frame, const Vector2d& at, double down, const char* text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", frame.X(at) + 7, frame.Y(at) + down, text);
}

}  // namespace

std::string SideView(const Cell& cell, const Mesh& part, const WrongSide& wrong) {
  const Vector3d base = cell.X_WB.translation(), shoulder3 = cell.X_WB * Vector3d(0, 0, cell.arm.d1);
  const Side side = SideOf(base, wrong.position);
  std::vector<Vector2d> outline;
  for (const Vector3d& p : part.triangles().vertices) outline.push_back(side.At(cell.X_WP * p));
  outline = Hull(std::move(outline));
  const Vector2d foot = side.At(base), shoulder = side.At(shoulder3), point = side.At(wrong.position);
  Eigen::AlignedBox2d box(foot);
  for (const Vector2d& p : outline) box.extend(p);
  box.extend(shoulder).extend(point);
  const double arrow = 0.16 * box.sizes().maxCoeff();
  const Vector2d normal = point + arrow * side.Way(wrong.normal),
                 tool = point + 1.3 * arrow * side.Way(wrong.tool_axis);
  box.extend(normal).extend(tool);
  const Frame frame(box);
  const char* bad = "stroke=\"var(--bad)\"";
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" "
      "fill=\"var(--ink)\" "
      "font-size=\"12\"><title>Seen from the side, across the plane through axis 1 and the point</title>",
      kWidth, kHeight);
  std::string corners;
  for (const Vector2d& p : outline) corners += frame.At(p) + " ";
  if (!outline.empty())
    svg += fmt::format("<polygon class=\"part\" points=\"{}\" fill=\"var(--faint)\" stroke=\"var(--edge)\"/>",
                       corners);
  svg += Line(frame, foot, shoulder, "stroke=\"var(--muted)\" stroke-width=\"9\" stroke-linecap=\"round\"");
  svg += Line(frame, point, shoulder, "stroke=\"var(--muted)\" stroke-dasharray=\"4 4\"");
  svg += Label(frame, shoulder, -7, "shoulder of the arm");
  svg += Line(frame, point, tool,
              fmt::format("class=\"tool\" {} stroke-width=\"7\" stroke-opacity=\".55\"",
                          wrong.below ? bad : "stroke=\"var(--accent)\""));
  svg += Label(frame, tool, 14, "tool, towards its holder");
  svg += Line(frame, point, normal, fmt::format("class=\"normal\" {} stroke-width=\"2\"", bad));
  svg += Head(frame, point, normal);
  svg += Label(frame, normal, -5, wrong.away ? "normal: looks away from the arm" : "normal");
  svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"var(--bad)\"/></svg>",
                     frame.X(point), frame.Y(point));
  return svg;
}

}  // namespace millpose
