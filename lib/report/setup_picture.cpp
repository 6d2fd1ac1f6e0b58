// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/setup_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "report/page/escaped.hpp"
#include "report/view_mesh.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPictureWidth = 720, kPictureHeight = 430, kPictureMargin = 34;  // px
constexpr size_t kOtherFaces = 600;                                               // drawn
// Colours that people of all kinds of sight tell apart (Okabe and Ito 2008).
constexpr std::array kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

/// A parallel projection: x to the right, y downwards, depth towards who looks.
class View {
 public:
  View(const Vector3d& towards, const Vector3d& up) : depth_(towards.normalized()) {
    const Vector3d flat = up - depth_ * up.dot(depth_);
    // Seen from straight above or below no direction is upwards.
    up_ = flat.norm() > 1e-6 ? flat.normalized() : depth_.unitOrthogonal();
    right_ = up_.cross(depth_);
  }
  Vector2d Flat(const Vector3d& p) const { return {p.dot(right_), -p.dot(up_)}; }
  double Depth(const Vector3d& p) const { return p.dot(depth_); }
  const Vector3d& towards() const { return depth_; }

  /// Everything of `box` into the picture, in its middle.
  void Fit(const Eigen::AlignedBox2d& box) {
    scale_ = std::min((kPictureWidth - 2 * kPictureMargin) / std::max(box.sizes().x(), 1e-6),
                      (kPictureHeight - 2 * kPictureMargin) / std::max(box.sizes().y(), 1e-6));
    shift_ = Vector2d(kPictureWidth / 2, kPictureHeight / 2) - scale_ * box.center();
  }
  Vector2d At(const Vector3d& p) const { return scale_ * Flat(p) + shift_; }
  double scale() const { return scale_; }

 private:
  Vector3d depth_, up_, right_;
  double scale_ = 1;
  Vector2d shift_ = Vector2d::Zero();
};

std::string Text(const Vector2d& p) { return fmt::format("{:.1f},{:.1f}", p.x(), p.y()); }

struct Facet {
  double depth = 0;
  std::string svg;
};

/// The faces of a solid that look at us, shaded by how much they do.
void AddFacets(const View& view, const PictureSolid& solid, size_t most, std::vector<Facet>& facets) {
  const Triangles mesh = ThinnedMesh(solid.mesh, most);
  for (const auto& face : mesh.faces) {
    const Vector3d &a = mesh.vertices[static_cast<size_t>(face[0])],
                   &b = mesh.vertices[static_cast<size_t>(face[1])],
                   &c = mesh.vertices[static_cast<size_t>(face[2])];
    const Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-12) continue;
    const double facing = normal.normalized().dot(view.towards());
    if (facing <= 0 && !solid.part) continue;  // an open sheet is seen from both sides
    const int light = static_cast<int>(150 + 95 * std::abs(facing));
    const std::string colour = solid.part ? fmt::format("rgb({0},{0},{0})", light)
                                          : fmt::format("rgb({},{},{})", light - 25, light - 45, light - 75);
    facets.push_back({view.Depth(a + b + c) / 3,
                      fmt::format("<path d=\"M{}L{}L{}Z\" fill=\"{}\" stroke=\"{}\"/>", Text(view.At(a)),
                                  Text(view.At(b)), Text(view.At(c)), colour, colour)});
  }
}

std::string Label(const Vector2d& at, const std::string& text, const std::string& style = {}) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>", at.x(), at.y(), style, Escaped(text));
}

std::string Arrow(const View& view, const Vector3d& from, const Vector3d& to, const char* colour,
                  const std::string& name) {
  const Vector2d a = view.At(from), b = view.At(to), way = b - a;
  if (way.norm() < 3) return {};  // straight at us
  const Vector2d u = way.normalized(), v(-u.y(), u.x());
  return fmt::format(
             "<path d=\"M{}L{}\" stroke=\"{}\" stroke-width=\"2\"/><path d=\"M{}L{}L{}Z\" fill=\"{}\"/>",
             Text(a), Text(b), colour, Text(b + 3 * u), Text(b - 8 * u + 4 * v), Text(b - 8 * u - 4 * v),
             colour) +
         Label(b + 12 * u + Vector2d(-4, 4), name);
}

/// Lines of tips as the `d` of a path.
std::string LinesText(const View& view, const std::vector<std::vector<Vector3d>>& lines) {
  std::string d;
  for (const std::vector<Vector3d>& line : lines)
    for (size_t i = 0; i < line.size(); ++i) d += (i == 0 ? "M" : "L") + Text(view.At(line[i]));
  return d;
}

std::string PathSvg(const View& view, const PicturePath& path, const std::string& colour, size_t number) {
  std::string svg =
      fmt::format("<path class=\"cut\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.1\"/>",
                  LinesText(view, path.cuts), colour);
  for (const Vector3d& p : path.skipped) {
    const Vector2d at = view.At(p);
    svg += fmt::format("<circle class=\"skipped\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.6\" fill=\"#b3261e\"/>",
                       at.x(), at.y());
  }
  if (path.cuts.empty()) return svg;
  const Vector2d first = view.At(path.cuts.front().front());
  return svg +
         fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\" fill=\"{}\"/>", first.x(), first.y(),
                     colour) +
         Label(first + Vector2d(0, 4), std::to_string(number),
               " fill=\"#fff\" text-anchor=\"middle\" font-weight=\"600\"");
}

}  // namespace

std::string PathColour(size_t i) { return kColours[i % kColours.size()]; }

std::string PictureOf(const SetupPicture& picture) {
  View view(picture.towards, picture.up);
  Eigen::AlignedBox2d box;
  Eigen::AlignedBox3d part;
  for (const PictureSolid& solid : picture.solids)
    for (const Vector3d& p : solid.mesh.vertices) {
      box.extend(view.Flat(p));
      if (solid.part) part.extend(p);
    }
  for (const PicturePath& path : picture.paths)
    for (const std::vector<Vector3d>& cut : path.cuts)
      for (const Vector3d& p : cut) {
        box.extend(view.Flat(p));
        part.extend(p);
      }
  if (box.isEmpty()) box.extend(Vector2d::Zero());
  if (part.isEmpty()) part.extend(Vector3d::Zero());
  const double arrow = 0.16 * std::max(part.sizes().norm(), 1.0);
  const std::array axes = {Vector3d(arrow, 0, 0), Vector3d(0, arrow, 0), Vector3d(0, 0, arrow)};
  box.extend(view.Flat(Vector3d::Zero()));
  for (const Vector3d& axis : axes) box.extend(view.Flat(axis));
  const Vector3d out = picture.arm - part.center();
  const Vector3d from = part.center() + 0.5 * part.sizes().norm() * out.normalized(),
                 to = from + arrow * out.normalized();
  box.extend(view.Flat(to));
  view.Fit(box);

  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"currentColor\" "
      "stroke-linejoin=\"round\">"
      "<title>{2}</title><g stroke-width=\".4\">",
      kPictureWidth, kPictureHeight,
      Escaped(Say(picture.language, "The part in its fixture and what is milled")));
  std::vector<Facet> facets;
  for (const PictureSolid& solid : picture.solids)
    AddFacets(view, solid, solid.part ? picture.part_faces : kOtherFaces, facets);
  std::ranges::stable_sort(facets, {}, &Facet::depth);
  for (const Facet& facet : facets) svg += facet.svg;
  svg += "</g>";
  if (!picture.elsewhere.empty())
    svg += fmt::format(
        "<path class=\"elsewhere\" d=\"{}\" fill=\"none\" stroke=\"#9aa0a6\" stroke-width=\".7\"/>",
        LinesText(view, picture.elsewhere));
  for (size_t i = 0; i < picture.paths.size(); ++i)
    svg += PathSvg(view, picture.paths[i], PathColour(i), i + 1);
  constexpr std::array kAxes = {std::pair("x", "#c0392b"), std::pair("y", "#1e8449"),
                                std::pair("z", "#1f5fa8")};
  for (size_t axis = 0; axis < 3; ++axis)
    svg += Arrow(view, Vector3d::Zero(), axes[axis], kAxes[axis].second, kAxes[axis].first);
  return svg + Arrow(view, from, to, "currentColor", Say(picture.language, "arm")) + "</svg>";
}

}  // namespace millpose
