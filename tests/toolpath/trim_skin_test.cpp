// SPDX-License-Identifier: GPL-3.0-or-later
// Trims of windows in curved skins: known lengths, steps and turns of the tool axis.
#include "base/random.hpp"
#include "base/rotation.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/skins.hpp"
#include "toolpath/strategies/trim.hpp"
#include "toolpath/strategies/trim_distance.hpp"
#include "toolpath/strategies/trim_offset.hpp"

namespace millpose {
namespace {

constexpr double kCutter = 10;       // mm, radius
constexpr double kTolerance = 0.02;  // mm, of chords

ToolpathOptions WindowTrim() {
  Trim trim;
  trim.border = TrimBorder{Eigen::Vector3d(-90, 0, 0), {}};
  trim.through = 8;
  trim.overcut = 1;
  trim.overlap = 0;
  ToolpathOptions options;
  options.strategy = std::make_shared<Trim>(trim);
  options.cutter = {kCutter, 0, 40};
  options.feed_rate = 10;
  options.spacing = 25;
  options.chord_tolerance = kTolerance;
  return options;
}

std::vector<Skin> Skins() {
  std::vector<Skin> skins;
  for (const double corner : {0.0, 5.0, 20.0}) {
    skins.push_back({.form = SkinForm::kFlat, .corner = corner});
    for (const double radius : {1500.0, 15000.0})
      skins.push_back({.form = SkinForm::kCylinder, .radius = radius, .corner = corner});
    skins.push_back({.form = SkinForm::kSphere, .radius = 1500, .corner = corner});
  }
  return skins;
}

std::string Told(const Skin& skin) {
  const char* const forms[] = {"flat", "cylinder", "sphere"};
  return fmt::format("{} of {} mm, corners of {} mm", forms[static_cast<int>(skin.form)], skin.radius,
                     skin.corner);
}

double Between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

// The cut alone: where the lead-in ends and all that follows.
std::vector<MillingPoint> CutOf(const LaidPath& laid) {
  std::vector<MillingPoint> cut;
  const std::vector<MillingPoint>& points = laid.toolpath.passes.at(0).points;
  for (size_t i = 1; i < points.size(); ++i) {
    if (points[i].kind != PointKind::kCut) continue;
    if (cut.empty()) cut.push_back(points[i - 1]);
    cut.push_back(points[i]);
  }
  return cut;
}

TEST(TrimSkin, AWindowIsOneClosedWayOfTheDevelopmentsLength) {
  for (const Skin& skin : Skins()) {
    SCOPED_TRACE(Told(skin));
    const Mesh mesh = SoundMesh(SkinShape(skin));
    const ToolpathOptions options = WindowTrim();
    const LaidPath laid = options.strategy->Make({mesh, options, {}}, {});
    ASSERT_EQ(laid.toolpath.passes.size(), 1);
    EXPECT_EQ(laid.findings.size(), skin.corner < kCutter ? 4 : 0);
    const std::vector<MillingPoint> cut = CutOf(laid);
    double length = 0;  // in the surface
    for (size_t i = 1; i < cut.size(); ++i)
      length +=
          (cut[i].position + 9 * cut[i].tool_axis - cut[i - 1].position - 9 * cut[i - 1].tool_axis).norm();
    const double round = std::max(skin.corner, kCutter);
    const double known = 2 * (skin.width + skin.height) - 8 * round + 2 * kPi * (round - kCutter);
    // A sphere has no development: over it both sides are longer by the share (90 / 1500)² / 6 and the like.
    EXPECT_NEAR(length, known, skin.form == SkinForm::kSphere ? 0.003 * known : 0.15);
    EXPECT_LT((cut.front().position - cut.back().position).norm(), 1e-9) << "closed";
  }
}

TEST(TrimSkin, TheCutterKeepsItsRadiusFromTheBorder) {
  for (const Skin& skin : Skins()) {
    SCOPED_TRACE(Told(skin));
    const Mesh mesh = SoundMesh(SkinShape(skin));
    const ToolpathOptions options = WindowTrim();
    const StrategyInputs inputs{mesh, options, {}};
    const auto& trim = dynamic_cast<const Trim&>(*options.strategy);
    const ContourDistance border(ContourOf(trim, inputs), 60);
    const std::vector<MillingPoint> cut = CutOf(trim.Make(inputs, {}));
    double least = 1e9, most = 0;
    for (size_t i = 1; i < cut.size(); ++i)
      for (int k = 0; k < 20; ++k) {
        const double share = k / 20.0;
        const Eigen::Vector3d at = cut[i - 1].position + share * (cut[i].position - cut[i - 1].position);
        const Eigen::Vector3d axis =
            (cut[i - 1].tool_axis + share * (cut[i].tool_axis - cut[i - 1].tool_axis)).normalized();
        least = std::min(least, border.At(at, axis));
        most = std::max(most, border.At(at, axis));
      }
    // As deep as the tip, where the axis leans between two parts of the border that see it differently.
    EXPECT_GT(least, kCutter - kTolerance);
    EXPECT_LT(most, kCutter + kTolerance);
  }
}

TEST(TrimSkin, StepsAreShortAtCornersOnlyAndTheAxisTurnsEvenly) {
  for (const Skin& skin : Skins()) {
    SCOPED_TRACE(Told(skin));
    const Mesh mesh = SoundMesh(SkinShape(skin));
    const ToolpathOptions options = WindowTrim();
    const std::vector<MillingPoint> points =
        options.strategy->Make({mesh, options, {}}, {}).toolpath.passes.at(0).points;
    double shortest = 1e9, turns = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      const double step = (points[i].position - points[i - 1].position).norm();
      shortest = std::min(shortest, step);
      turns = std::max(turns, Between(points[i].tool_axis, points[i - 1].tool_axis) / step);
    }
    EXPECT_GT(shortest, 0.1);
    EXPECT_LT(turns, 0.1) << "degrees per mm; the skin itself turns by 0.04 at most";
  }
}

TEST(TrimSkin, TheAxisIsTheSkinsNormalButAtCornersAndSaysByHowMuch) {
  for (const Skin& skin : Skins()) {
    SCOPED_TRACE(Told(skin));
    const Mesh mesh = SoundMesh(SkinShape(skin));
    const ToolpathOptions options = WindowTrim();
    const LaidPath laid = options.strategy->Make({mesh, options, {}}, {});
    double most = 0;
    for (const MillingPoint& point : CutOf(laid)) {
      const Eigen::Vector3d place = point.position + 9 * point.tool_axis;
      Eigen::Vector3d foot = place - kCutter * point.normal;  // beside one of both sides at least
      foot = mesh.Closest(foot).position;
      const double corner = std::min(std::abs(std::abs(place.x()) - 80), std::abs(std::abs(place.y()) - 80));
      const bool at_corner = std::abs(std::abs(place.x()) - std::abs(place.y())) < 2 * kCutter && corner < 20;
      const double off = Between(point.tool_axis, SkinNormal(skin, foot));
      most = std::max(most, off);
      if (!at_corner) {
        EXPECT_LT(off, 0.02) << place.transpose();
      }
    }
    EXPECT_LT(most, 0.45);
    const bool told = std::ranges::any_of(
        laid.notes, [](const std::string& note) { return note.find("leans by up to") != std::string::npos; });
    EXPECT_EQ(told, skin.form != SkinForm::kFlat && (skin.radius < 10000 || skin.corner < kCutter));
  }
}

// A closed line with corners, notches and bays, some narrower than the cutter.
Contour AnyContour(const Skin& skin, RandomStream& random) {
  const int count = 12 + random.Below(80);
  const double rough = random.Uniform(0, 0.35), lobes = 2 + random.Below(5), deep = random.Uniform(0, 0.5);
  Contour contour;
  contour.closed = true;
  for (int i = 0; i < count; ++i) {
    const double at = 2 * kPi * i / count;
    const double r = 70 * (1 + deep * std::cos(lobes * at)) * (1 + random.Uniform(-rough, rough));
    const Eigen::Vector3d place = OnSkin(skin, {r * std::cos(at), r * std::sin(at)});
    contour.points.push_back({place, SkinNormal(skin, place)});
  }
  if (random.Below(2) == 0) std::ranges::reverse(contour.points);
  return contour;
}

// The length of all places that are moved aside from the contour by the distance and come nowhere nearer,
// found by looking at each.
double FittingLength(const Contour& contour, double distance) {
  const ContourDistance near(contour, 3 * distance);
  double length = 0;
  const auto add = [&](int steps, const auto& node_at) {
    for (int k = 0; k < steps; ++k) {
      const OffsetNode a = node_at(static_cast<double>(k) / steps), b = node_at((k + 1.0) / steps);
      const OffsetNode middle = node_at((k + 0.5) / steps);
      if (near.At(middle.place, middle.axis) > distance - 2e-3) length += (b.place - a.place).norm();
    }
  };
  const size_t count = contour.points.size();
  for (size_t i = 0; i < count; ++i) {
    const ContourPoint &before = contour.points[(i + count - 1) % count], &at = contour.points[i],
                       &to = contour.To(i);
    const auto left = [](const Eigen::Vector3d& axis, const Eigen::Vector3d& along) -> Eigen::Vector3d {
      return axis.cross(along).normalized();
    };
    add(static_cast<int>((to.place - at.place).norm() / 0.05) + 1, [&](double share) -> OffsetNode {
      const Eigen::Vector3d axis = (at.axis + share * (to.axis - at.axis)).normalized();
      return {at.place + share * (to.place - at.place) + distance * left(axis, to.place - at.place), axis};
    });
    const Eigen::Vector3d in = left(at.axis, at.place - before.place),
                          out = left(at.axis, to.place - at.place);
    const double turn = std::atan2(in.cross(out).dot(at.axis), in.dot(out));
    if (turn >= 0) continue;
    add(static_cast<int>(-turn * distance / 0.05) + 1, [&](double share) -> OffsetNode {
      return {at.place + distance * (RotationAbout(at.axis, turn * share) * in), at.axis};
    });
  }
  return length;
}

TEST(TrimSkin, OfAnyContourAllThatFitsIsOnTheWay) {
  constexpr double kDistance = 8;
  for (int number = 0; number < 60; ++number) {
    RandomStream random(7, static_cast<uint64_t>(number));
    const SkinForm forms[] = {SkinForm::kFlat, SkinForm::kCylinder, SkinForm::kSphere};
    const Skin skin{.form = forms[number % 3], .radius = random.Uniform(300, 3000)};
    SCOPED_TRACE(fmt::format("contour {}, {}", number, Told(skin)));
    const Contour contour = AnyContour(skin, random);
    const Offset offset = OffsetOf(contour, {kDistance, 0.01, DegToRad(30), kDistance, 5}, {});
    const ContourDistance near(contour, 3 * kDistance);
    double length = 0, least = 1e9, most = 0;
    for (const OffsetPath& path : offset.paths) {
      EXPECT_TRUE(path.closed);
      for (size_t i = 0; i < path.Segments(); ++i) {
        length += (path.To(i).place - path.From(i).place).norm();
        const double at = near.At(path.From(i).place, path.From(i).axis);
        least = std::min(least, at);
        most = std::max(most, at);
      }
    }
    const double fitting = FittingLength(contour, kDistance);
    EXPECT_NEAR(length, fitting, 0.005 * fitting + 1) << offset.paths.size() << " ways";
    if (offset.paths.empty()) continue;
    EXPECT_GT(least, kDistance - 0.01);
    EXPECT_LT(most, kDistance + 0.01);
  }
}

}  // namespace
}  // namespace millpose
