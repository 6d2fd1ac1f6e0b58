// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the pictures of docs/engagement.md: a zigzag with what the library finds engaged, and an edge in
// slices.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "base/trig.hpp"
#include "base/units.hpp"
#include "toolpath/engagement/engagement.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadius = 10, kWide = 120, kHigh = 50, kStepover = 8;

Toolpath Zigzag() {
  Toolpath toolpath;
  for (int k = 0; k < 5; ++k) {
    Pass& pass = toolpath.passes.emplace_back();
    const double y = 9 + kStepover * k;
    for (int i = 0; i <= 30; ++i) {
      const double along = -15 + 5.0 * i;
      MillingPoint point;
      point.position = {k % 2 == 0 ? along : kWide - along, y, 0};
      point.feed = {k % 2 == 0 ? 1.0 : -1.0, 0, 0};
      point.feed_rate = 10;
      pass.points.push_back(point);
    }
  }
  return toolpath;
}

EngagementOptions Options() {
  EngagementOptions options;
  options.edge.material = CuttingMaterials().front();
  options.edge.cutter = {kRadius, 0, 20};
  options.edge.teeth = 4;
  options.spindle_speed = 7000.0 / 60;
  options.depth = 1;
  options.stock = [](const Vector3d& p) {
    return p.x() > 0 && p.x() < kWide && p.y() > 0 && p.y() < kHigh && p.z() > -1e-6 && p.z() < 1;
  };
  return options;
}

/// Pixels: 5 a millimetre, y up.
Vector2d Pixel(const Vector2d& p) { return {5 * (p.x() + 18), 5 * (kHigh + 6 - p.y())}; }

std::string LineTo(const Vector2d& a, const Vector2d& b, const char* style) {
  const Vector2d from = Pixel(a), to = Pixel(b);
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", from.x(),
                     from.y(), to.x(), to.y(), style);
}

std::string Text(const Vector2d& at, const std::string& text) {
  const Vector2d pixel = Pixel(at);
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"13\" font-family=\"sans-serif\">{}</text>\n", pixel.x(),
      pixel.y(), text);
}

const char* Colour(CutSide side) {
  switch (side) {
    case CutSide::kUp:
      return "#c0392b";
    case CutSide::kDown:
      return "#2166ac";
    case CutSide::kSlot:
      return "#6a3d9a";
    default:
      return "#888888";
  }
}

/// The cutter at a point: its circle, the cut's width as a bar ahead of it, the force.
std::string Cutter(const MillingPoint& point) {
  const Vector2d centre = point.position.head<2>(), pixel = Pixel(centre);
  const Engagement& cut = point.engagement;
  std::string svg = fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"none\" stroke=\"#444\" stroke-width=\"1\"/>\n",
      pixel.x(), pixel.y(), 5 * kRadius);
  const Vector2d feed = point.feed.head<2>(), left(-feed.y(), feed.x());
  const double from = cut.side == CutSide::kDown ? -kRadius : kRadius - cut.width;
  const std::string style = fmt::format("stroke=\"{}\" stroke-width=\"5\"", Colour(cut.side));
  const Vector2d ahead = centre + (kRadius + 1.5) * feed;
  svg += LineTo(ahead + from * left, ahead + (from + cut.width) * left, style.c_str());
  const Vector2d force = 0.35 * cut.force.head<2>();
  svg += LineTo(centre, centre + force, "stroke=\"#111\" stroke-width=\"2\" marker-end=\"url(#tip)\"");
  return svg;
}

std::string Head(double width, double height) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" "
      "markerHeight=\"7\" orient=\"auto\"><path d=\"M0,0 L8,4 L0,8 z\"/></marker></defs>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height);
}

std::string ZigzagPicture() {
  Toolpath toolpath = Zigzag();
  SetEngagement(Options(), 1, {}, toolpath);
  std::string svg = Head(790, 310);
  const Vector2d corner = Pixel({0, kHigh});
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#eee8d8\" "
      "stroke=\"#999\"/>\n",
      corner.x(), corner.y(), 5 * kWide, 5 * kHigh);
  for (const Pass& pass : toolpath.passes) {
    const Vector3d &a = pass.points.front().position, &b = pass.points.back().position;
    svg += LineTo(a.head<2>(), b.head<2>(), "stroke=\"#aaa\" stroke-width=\"1\" marker-end=\"url(#tip)\"");
  }
  // One cutter a pass, so that they do not hide each other.
  constexpr size_t kShown[] = {6, 19, 14, 8, 26};
  for (size_t k = 0; k < 5; ++k) {
    const MillingPoint& point = toolpath.passes[k].points[kShown[k]];
    const Engagement& cut = point.engagement;
    svg += Cutter(point);
    svg += Text(point.position.head<2>() + Vector2d(-9, -2.5),
                fmt::format("{}: {} {:.1f} mm, {:.0f} N", k, Name(cut.side), cut.width, cut.force.norm()));
  }
  return svg + "</svg>\n";
}

std::string SlicesPicture() {
  const CutterShape cutter{10, 6, 20};
  std::string svg = Head(420, 300);
  const auto at = [](double radius, double height) { return Vector2d(radius + 5, height + 10); };
  svg += LineTo(at(0, 0), at(0, 40), "stroke=\"#888\" stroke-dasharray=\"6 3\"");
  for (const EdgeSlice& slice : SliceEdge(cutter, 12, 1.5)) {
    const Vector2d middle = at(slice.radius, slice.height), along(slice.cos_lead, slice.sin_lead);
    const Vector2d normal(slice.sin_lead, -slice.cos_lead);
    svg += LineTo(middle - 0.45 * slice.length * along, middle + 0.45 * slice.length * along,
                  "stroke=\"#2166ac\" stroke-width=\"4\"");
    svg +=
        LineTo(middle, middle + 4 * normal, "stroke=\"#c0392b\" stroke-width=\"1\" marker-end=\"url(#tip)\"");
  }
  svg += Text(at(-13, 30), "tool axis a");
  svg += Text(at(24, 18), "normal n_e = sin κ·e_r − cos κ·a");
  svg += Text(at(24, 14), "chip h = f_z·(f·n_e)");
  return svg + "</svg>\n";
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::filesystem::create_directories(argv[1]);
  std::ofstream(std::filesystem::path(argv[1]) / "zigzag.svg") << millpose::ZigzagPicture();
  std::ofstream(std::filesystem::path(argv[1]) / "slices.svg") << millpose::SlicesPicture();
}
