// SPDX-License-Identifier: GPL-3.0-or-later
// Generated parts, in any direction, with every strategy that suits them: no step is short but at corners,
// and the tool axis turns no faster than the surface does.
#include "base/random.hpp"
#include "base/rotation.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/skins.hpp"
#include "tests/toolpath/step_census.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/strategies/trim.hpp"

namespace millpose {
namespace {

constexpr int kParts = 20;

struct Made {
  std::string name;
  Triangles part;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();     // the part's own z, as it lies
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // its own origin
  std::vector<std::string> strategies;
};

Eigen::Vector3d AnyDirection(RandomStream& random) {
  return Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
}

Made PartOf(int number) {
  RandomStream random(39, static_cast<uint64_t>(number));
  const int facets = 40 + random.Below(120);
  Made made;
  switch (number % 5) {
    case 0:
      made = {fmt::format("cylinder in {} facets", facets),
              CylinderShape(random.Uniform(60, 200), 80, facets, 3),
              {},
              {},
              {"parallel_planes", "rings"}};
      break;
    case 1:
      made = {fmt::format("barrel in {} facets", facets),
              LatheShape({{90, 0}, {103, 20}, {110, 45}, {112, 70}, {108, 100}}, facets),
              {},
              {},
              {"parallel_planes", "rings", "contours"}};
      break;
    case 2:
      made = {
          "sphere", SphereShape(random.Uniform(80, 150), 20 + random.Below(20)), {}, {}, {"parallel_planes"}};
      break;
    case 3: {
      const SkinForm forms[] = {SkinForm::kFlat, SkinForm::kCylinder, SkinForm::kSphere};
      const double corners[] = {0, 5, 9.9, 10, 10.3, 20};
      Skin skin{.form = forms[random.Below(3)],
                .radius = random.Uniform(400, 3000),
                .corner = corners[random.Below(6)]};
      skin.width = random.Uniform(100, 200);
      skin.edge = random.Uniform(4, 40);
      skin.facet = DegToRad(random.Uniform(1, 12));
      made = {fmt::format("skin with a window of {:.1f} mm, corners of {} mm", skin.width, skin.corner),
              SkinShape(skin),
              {},
              {},
              {"parallel_planes", "contours", "trim"}};
      break;
    }
    default:
      made = {"plate",
              PlateShape(12, 10, 9.7, {{{{4 * 9.7, 3 * 9.7}, {7 * 9.7, 6 * 9.7}}}}),
              {},
              {},
              {"parallel_planes", "contours", "pad", "trim"}};
  }
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = RotationAbout(AnyDirection(random), random.Uniform(0, 6));
  X.translation() = 300 * AnyDirection(random);
  made.part = Moved(made.part, X);
  made.up = X.linear().col(2);
  made.middle = X.translation();
  return made;
}

ToolpathOptions OptionsOf(const Made& made, const std::string& strategy, RandomStream& random) {
  ToolpathOptions options;
  options.cutter = {10, 0, 40};
  options.stepover = random.Uniform(6, 20);
  options.spacing = random.Uniform(3, 25);
  options.rotation_reference = made.up.unitOrthogonal();
  options.feed_rate = 10;
  Choose(options, strategy);
  if (strategy == "parallel_planes") With<ParallelPlanes>(options).normal = AnyDirection(random);
  if (strategy == "pad") With<Pad>(options).along = made.up.unitOrthogonal();
  if (strategy == "rings") {
    With<Rings>(options).axis_direction = made.up;
    With<Rings>(options).axis_point = made.middle;
  }
  if (strategy == "trim") {
    Trim& trim = With<Trim>(options);
    trim.border = TrimBorder{made.part.vertices.front(), {}};
    trim.through = 6;
    trim.overcut = 1;
    trim.per_depth = 4;
  }
  return options;
}

TEST(EvenSteps, OnGeneratedPartsNoStepIsShortButAtCornersAndTheAxisTurnsAsTheSurfaceDoes) {
  StepCensus sum;
  for (int number = 0; number < kParts; ++number) {
    const Made made = PartOf(number);
    const Mesh mesh = SoundMesh(made.part);
    RandomStream random(40, static_cast<uint64_t>(number));
    for (const std::string& strategy : made.strategies) {
      SCOPED_TRACE(fmt::format("part {}, {}, {}", number, made.name, strategy));
      const ToolpathOptions options = OptionsOf(made, strategy, random);
      const StepCensus census = CensusOf(options.strategy->Make({mesh, options, {}}, {}).toolpath, &mesh);
      for (size_t i = 0; i < sum.steps.size(); ++i) sum.steps[i] += census.steps[i];
      for (size_t i = 0; i < sum.turns.size(); ++i) sum.turns[i] += census.turns[i];
      EXPECT_TRUE(census.uneven.empty())
          << census.uneven.size()
          << " places, the first: " << fmt::format("{}", fmt::join(census.uneven, "\n"));
    }
  }
  RecordProperty("census", ToText(sum));
  fmt::print("{}\n", ToText(sum));
}

}  // namespace
}  // namespace millpose
