// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the pictures of docs/strategies.md: each strategy on a small part, as the library lays it.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "geometry/mesh/corner_normals.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/gouge.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

struct Picture {
  std::string name;
  Mesh mesh;
  Toolpath toolpath;
  Eigen::Vector3d eye = Eigen::Vector3d(-0.5, -1, 1.1);  ///< direction from which it is seen
};

// A plate of 200 × 140 mm with two openings.
Mesh Plate() {
  return SoundMesh(PlateShape(20, 14, 10, {{{{40, 50}, {80, 90}}}, {{{130, 60}, {150, 120}}}}));
}

ToolpathOptions Panel() {
  ToolpathOptions options;
  With<ParallelPlanes>(options);
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(30);
  options.region.rim_distance = 12;
  options.stepover = 30;
  options.spacing = 20;
  options.chord_tolerance = 0.1;
  return options;
}

ToolpathOptions Rings() {
  ToolpathOptions options;
  With<millpose::Rings>(options);
  options.rotation_reference = -Eigen::Vector3d::UnitY();
  options.stepover = 10;
  options.spacing = 5;
  options.chord_tolerance = 0.05;
  return options;
}

ToolpathOptions Pad() {
  ToolpathOptions options;
  With<millpose::Pad>(options);
  options.cutter = {8, 0, 30};
  options.stepover = 8;
  options.spacing = 20;
  return options;
}

std::vector<Picture> Pictures() {
  std::vector<Picture> pictures;
  const auto add = [&](const char* name, const Mesh& mesh, const ToolpathOptions& options) {
    pictures.push_back({name, mesh, MakeToolpath(mesh, options, {})});
  };
  const Mesh panel = SampleMesh("cabin_panel"), wall = SoundMesh(CylinderShape(60, 50, 120, 2)),
             plate = Plate();
  ToolpathOptions options = Panel();
  add("parallel_planes", panel, options);
  options.ends = {10, LeadShape::kArc, 25, 0};
  add("leads", panel, options);
  options = Panel();
  Choose(options, "contours");
  add("contours", panel, options);
  With<CurveStrategy>(options);
  With<CurveStrategy>(options).points = {{-250, -350, 0}, {250, -350, 0}, {0, 380, 0}, {-250, -350, 0}};
  add("curve", panel, options);
  options = Rings();
  options.region.connected = {{60, 0, 20}, DegToRad(20)};
  add("rings_walls", wall, options);
  With<millpose::Rings>(options).seam_step = DegToRad(20);
  add("rings_seam", wall, options);
  With<millpose::Rings>(options).path = millpose::RingPath::kSpiral;
  add("rings_spiral", wall, options);
  options = Rings();
  options.region.connected = {{10, 0, 50}, DegToRad(20)};
  options.region.rim_distance = 2;
  add("rings_faces", wall, options);
  With<millpose::Rings>(options).path = millpose::RingPath::kSpiral;
  add("rings_face_spiral", wall, options);
  options = Pad();
  add("pad_zigzag", plate, options);
  With<millpose::Pad>(options).spiral = true;
  add("pad_spiral", plate, options);
  return pictures;
}

// Seen from far away along `eye`, z up, y of the picture downwards.
class View {
 public:
  View(const Mesh& mesh, const Eigen::Vector3d& eye) : eye_(eye.normalized()) {
    right_ = Eigen::Vector3d::UnitZ().cross(eye_).normalized();
    up_ = eye_.cross(right_);
    for (const Eigen::Vector3d& p : mesh.triangles().vertices) box_.extend(Flat(p));
    scale_ = 560 / box_.sizes().x();
  }
  std::string At(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d q = (Flat(p) - box_.min()) * scale_;
    return fmt::format("{:.1f},{:.1f}", 20 + q.x(), 40 + q.y());
  }
  double height() const { return 60 + box_.sizes().y() * scale_; }
  bool Faces(const Eigen::Vector3d& normal) const { return normal.dot(eye_) > 0; }

 private:
  Eigen::Vector2d Flat(const Eigen::Vector3d& p) const { return {right_.dot(p), -up_.dot(p)}; }

  Eigen::Vector3d eye_, right_, up_;
  Eigen::AlignedBox2d box_;
  double scale_ = 1;
};

// Rims and creases of the part, as seen from the front.
std::string Outline(const Mesh& mesh, const View& view) {
  std::string path;
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(face, k);
      const bool front =
          view.Faces(mesh.FaceNormal(face)) || (other >= 0 && view.Faces(mesh.FaceNormal(other)));
      const bool turns =
          other >= 0 && view.Faces(mesh.FaceNormal(face)) != view.Faces(mesh.FaceNormal(other));
      if (other > face || !front || (other >= 0 && !turns && BendAngle(mesh, face, k) < DegToRad(25)))
        continue;
      path += fmt::format("M{} L{} ", view.At(mesh.Corner(face, k)), view.At(mesh.Corner(face, (k + 1) % 3)));
    }
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#888\" stroke-width=\"0.8\"/>\n", path);
}

std::string Lines(const Picture& picture, const View& view, bool leads) {
  std::string path;
  for (const Pass& pass : picture.toolpath.passes) {
    for (size_t i = 1; i < pass.points.size() + (pass.closed ? 1 : 0); ++i) {
      const MillingPoint &a = pass.points[i - 1], &b = pass.points[i % pass.points.size()];
      if (!view.Faces(a.normal)) continue;
      const bool lead = a.kind != PointKind::kCut || b.kind != PointKind::kCut;
      if (lead == leads) path += fmt::format("M{} L{} ", view.At(a.position), view.At(b.position));
    }
  }
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\"/>\n", path,
                     leads ? "#d60" : "#06c");
}

std::string Svg(const Picture& picture) {
  const View view(picture.mesh, picture.eye);
  size_t points = 0;
  std::string starts;
  for (const Pass& pass : picture.toolpath.passes) {
    points += pass.points.size();
    if (!view.Faces(pass.points[0].normal)) continue;
    const std::string at = view.At(pass.points[0].position);
    const size_t comma = at.find(',');
    starts +=
        fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"2.5\"/>", at.substr(0, comma), at.substr(comma + 1));
  }
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"600\" height=\"{0:.0f}\" viewBox=\"0 0 600 "
             "{0:.0f}\" "
             "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"600\" height=\"{0:.0f}\" "
             "fill=\"#fff\"/>\n"
             "<text x=\"20\" y=\"22\">{1}: {2} passes, {3} points</text>\n",
             view.height(), picture.name, picture.toolpath.passes.size(), points) +
         Outline(picture.mesh, view) + Lines(picture, view, false) + Lines(picture, view, true) +
         fmt::format("<g fill=\"#c00\">{}</g>\n</svg>\n", starts);
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: strategy_pictures FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  for (const millpose::Picture& picture : millpose::Pictures())
    std::ofstream(folder / (picture.name + ".svg")) << millpose::Svg(picture);
  return 0;
}
