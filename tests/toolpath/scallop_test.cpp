// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/scallop.hpp"

#include "geometry/mesh/mesh.hpp"
#include "tests/base/tier.hpp"
#include "tests/toolpath/vault.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

constexpr double kSphereRadius = 200;

// How far a place is from what a cutter takes off that is led along y: from the rounded disc and all that is
// above it. A convex set, so the distance along y has one least value, found by halving thirds.
bool IsTaken(const CutterShape& cutter, const MillingPoint& tool, const Eigen::Vector3d& place) {
  const double r = cutter.corner_radius;
  const auto distance = [&](double y) {
    const Eigen::Vector3d d(place.x() - tool.position.x(), y, place.z() - tool.position.z());
    const double z = d.dot(tool.tool_axis), rho = (d - z * tool.tool_axis).norm();
    return std::hypot(std::max(0.0, rho - (cutter.radius - r)), std::max(0.0, r - z)) - r;
  };
  double low = -3 * cutter.radius, high = 3 * cutter.radius;
  for (int i = 0; i < 45; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
  }
  return distance((low + high) / 2) <= 1e-9;
}

// What is left standing on a ray out of the surface: up to where the lower of the nearest passes took it.
double LeftStanding(const CutterShape& cutter, const std::vector<MillingPoint>& tools, double curvature,
                    double angle) {
  const double side = curvature > 0 ? 1 : -1;
  const Eigen::Vector3d radial(std::cos(angle), 0, std::sin(angle)), surface = kSphereRadius * radial;
  double left = 2;
  for (const MillingPoint& tool : tools) {
    double low = -0.01, high = left;
    if (!IsTaken(cutter, tool, surface + side * high * radial)) continue;
    while (high - low > 1e-5) {
      const double middle = (low + high) / 2;
      (IsTaken(cutter, tool, surface + side * middle * radial) ? high : low) = middle;
    }
    left = high;
  }
  return left;
}

// The height whose step-over is the given one, by the formula.
double HeightOf(const Scallops& scallops, double stepover, double curvature) {
  double low = 1e-5, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (scallops.Stepover(middle, curvature) < stepover ? low : high) = middle;
  }
  return high;
}

struct Case {
  CutterShape cutter;
  double lead_deg, tilt_deg, curvature;
};

// Passes along y over a vault; what neighbouring ones leave is looked for in `rays` between them.
void ExpectScallops(const Case& given, double wanted, Direction direction, int gaps, int rays) {
  ToolpathOptions options;
  With<ParallelPlanes>(options).normal = Eigen::Vector3d::UnitZ();
  options.stepover = 16;
  options.scallop = wanted;
  options.cutter = given.cutter;
  options.lead = DegToRad(given.lead_deg);
  options.tilt = DegToRad(given.tilt_deg);
  options.direction = direction;
  const Mesh mesh = SoundMesh(Vault(kSphereRadius, 700, given.curvature > 0));
  std::vector<MillingPoint> tools;
  std::vector<double> angles;  // of the contacts
  for (const Pass& pass : MakeToolpath(mesh, options, {}).passes) {
    tools.push_back(pass.points[pass.points.size() / 2]);
    const Eigen::Vector3d& normal = tools.back().normal;
    angles.push_back(std::atan2(normal.z(), normal.x()) + (given.curvature > 0 ? 0 : kPi));
  }
  const Scallops scallops(given.cutter, options.lead, options.tilt, false);
  const bool alternating = direction == Direction::kZigzag && given.tilt_deg != 0;
  const double widest =
      Scallops(given.cutter, options.lead, options.tilt, alternating).Stepover(wanted, given.curvature);
  const size_t count = tools.size(), every = std::max<size_t>(1, count / static_cast<size_t>(gaps));
  double highest = 0;
  for (size_t i = 2; i + 3 < count; i += i % 2 == 0 ? 1 : every / 2 * 2 + 1) {  // two after each other
    const double laid = kSphereRadius * std::abs(angles[i + 1] - angles[i]);
    EXPECT_LE(laid, std::min(widest, options.stepover) * 1.002);
    double left = 0;
    for (int k = 0; k <= rays; ++k)
      left =
          std::max(left, LeftStanding(given.cutter, {tools.begin() + i - 1, tools.begin() + i + 3},
                                      given.curvature, angles[i] + (angles[i + 1] - angles[i]) * k / rays));
    if (!alternating) {
      const double predicted = HeightOf(scallops, laid, given.curvature);
      EXPECT_NEAR(left, predicted, 0.05 * predicted) << i;
    }
    highest = std::max(highest, left);
  }
  EXPECT_LE(highest, 1.02 * wanted);
  // The number of passes is rounded up: the step-over loses up to one part in their number, the height two.
  EXPECT_GE(highest, (0.97 - 2.0 / static_cast<double>(count)) * wanted);
  if (count > 80 && widest < options.stepover) {
    EXPECT_GE(highest, 0.95 * wanted) << count;
  }
}

TEST(Scallops, StandAsHighAsPredictedOnConvexAndConcaveVaults) {
  const CutterShape ball{8, 8, 30}, bull{8, 2, 30}, flat{8, 0, 30};
  for (const double wanted : {0.02, 0.1})
    for (const Case& given : std::initializer_list<Case>{{ball, 0, 0, 1 / kSphereRadius},
                                                         {bull, 0, 0, 1 / kSphereRadius},
                                                         {flat, 0, 0, 1 / kSphereRadius},
                                                         {ball, 0, 0, -1 / kSphereRadius},
                                                         {ball, 8, 5, 1 / kSphereRadius},
                                                         {bull, 6, 0, 1 / kSphereRadius},
                                                         {bull, 6, 4, -1 / kSphereRadius},
                                                         {flat, 5, 0, 1 / kSphereRadius},
                                                         {flat, 8, 0, -1 / kSphereRadius},
                                                         {flat, 6, 3, 1 / kSphereRadius}}) {
      SCOPED_TRACE(fmt::format("r {} lead {} tilt {} curvature {} H {}", given.cutter.corner_radius,
                               given.lead_deg, given.tilt_deg, given.curvature, wanted));
      ExpectScallops(given, wanted, Direction::kOneWay, OfTier(2, 4), 60);
    }
}

TEST(Scallops, OfATiltedCutterBackAndForthAreNotHigherThanWanted) {
  ExpectScallops({{8, 0, 30}, 6, 3, 1 / kSphereRadius}, 0.05, Direction::kZigzag, 8, 60);
}

TEST(Scallops, AgreeWithTheFormulas) {
  const auto stepover = [](const CutterShape& cutter, double lead, double height, double curvature) {
    return Scallops(cutter, lead, 0, false).Stepover(height, curvature);
  };
  // Ball of radius R on a flat: s = 2 √(2 R h − h²).
  const double height = 0.05;
  EXPECT_NEAR(stepover({8, 8, 30}, 0, height, 0), 2 * std::sqrt(2 * 8 * height - height * height), 1e-6);
  // Ball over convex and concave cylinders of radius ρ: the law of cosines in the triangle of axis, centre,
  // cusp.
  for (const double rho : {100.0, -100.0}) {
    const double cosine =
        (std::pow(rho + 8, 2) + std::pow(rho + height, 2) - 64) / (2 * (rho + 8) * (rho + height));
    EXPECT_NEAR(stepover({8, 8, 30}, 0, height, 1 / rho), 2 * std::abs(rho) * std::acos(cosine), 1e-5);
  }
  // A flat cutter leaves nothing on a flat while its discs meet; on a convex cylinder s = 2 ρ acos(ρ ÷ (ρ +
  // h)).
  EXPECT_NEAR(stepover({8, 0, 30}, 0, height, 0), 16, 1e-6);
  EXPECT_NEAR(stepover({8, 0, 30}, 0, height, 1 / 100.0), 200 * std::acos(100 / (100 + height)), 1e-5);
  // Leaning forward, its outline is an ellipse with half-axes R and R sin(lead): s = 2 R √(1 − (1 − h ÷ b)²).
  const double b = 8 * std::sin(0.1);
  EXPECT_NEAR(stepover({8, 0, 30}, 0.1, height, 0), 16 * std::sqrt(1 - std::pow(1 - height / b, 2)), 1e-5);
}

}  // namespace
}  // namespace millpose
