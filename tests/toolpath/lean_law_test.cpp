// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/lean_law.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/vault.hpp"
#include "toolpath/deepest_gouge.hpp"
#include "toolpath/strategies/scallop.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

const Vector3d kContact(3, -4, 0), kNormal = Vector3d::UnitZ(), kFeed = Vector3d::UnitX();

bool Admits(const LeanRules& rules, double lead_deg, double tilt_deg) {
  return LeanBound(rules, kContact, kNormal, kFeed)
      .Admits(AxisOf({DegToRad(lead_deg), DegToRad(tilt_deg)}, kNormal, kFeed));
}

/// The largest angle that `admits`, deg.
double Largest(const std::function<bool(double)>& admits) {
  double low = 0.01, high = 10;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (admits(middle) ? low : high) = middle;
  }
  return low;
}

// A flat end on a flat, D 20, 8 mm between passes, 0.02 mm allowed. Leaning forward it leaves R·sin λ·(1 −
// √(1 − (ae/D)²)), leaning sideways steps of ae·tan τ.
TEST(LeanBound, OfAFlatEndIsWhatTheOutlineLeaves) {
  LeanRules rules{.cutter = {10, 0, 40}, .stepover = 8, .scallop = 0.02, .surface = nullptr};
  rules.lead = DegToRad(0.2);
  const double lead = Largest([&](double angle) { return Admits(rules, angle, 0); });
  EXPECT_NEAR(10 * std::sin(DegToRad(lead)) * (1 - std::sqrt(1 - 0.16)), 0.02, 1e-6);
  EXPECT_NEAR(lead, 1.4, 0.05);

  rules.lead = 0;
  rules.tilt = DegToRad(0.05);
  const double tilt = Largest([&](double angle) { return Admits(rules, 0, angle); });
  EXPECT_NEAR(8 * std::tan(DegToRad(tilt)), 0.02, 1e-6);
  EXPECT_NEAR(tilt, 0.14, 0.005);
  EXPECT_FALSE(Admits(rules, 0, -0.05)) << "the neighbour's side stays uncut";
  rules.back_and_forth = true;
  EXPECT_TRUE(Admits(rules, 0, 0.05)) << "the tool path is laid so";
  EXPECT_FALSE(Admits(rules, 0, 0.06)) << "every other gap stays uncut";
  EXPECT_FALSE(Admits(rules, 0, -0.05));
  EXPECT_TRUE(Admits(rules, 0.2, 0));
  rules.back_and_forth = false;

  const double both = DegToRad(0.97);
  double height = 0.02;
  while (Scallops({10, 0, 40}, both, both, false).Stepover(height, 0) < 8) height += 1e-5;
  EXPECT_NEAR(height, 0.042, 0.0005);
}

// Leading by 3° a flat end reaches less than the step-over. Where passes are laid by the scallop they are as
// near as it reaches, else as far apart as the job says.
TEST(LeanBound, HoldsForPassesAsTheyAreLaid) {
  LeanRules rules{.cutter = {10, 0, 40}, .stepover = 8, .scallop = 0.02, .surface = nullptr};
  rules.lead = DegToRad(3);
  ASSERT_LT(Scallops(rules.cutter, rules.lead, 0, false).Stepover(rules.scallop, 0), rules.stepover);
  for (const bool by_scallop : {false, true}) {
    rules.by_scallop = by_scallop;
    EXPECT_TRUE(Admits(rules, 3, 0));
    EXPECT_EQ(Admits(rules, 2.9, 0), by_scallop);
    EXPECT_FALSE(Admits(rules, 3.1, 0));
    EXPECT_TRUE(Admits(rules, 1.3, 0));
    const double most = Largest([&](double lead) { return lead < 2.99 && Admits(rules, lead, 0); });
    EXPECT_NEAR(most, by_scallop ? 2.99 : 1.372, 0.01);
  }
}

// Against the outline's own way to the height, found by bisection.
TEST(LeanBound, AdmitsWhatReachesAsFarAsTheNominalLean) {
  RandomStream random(16, 0);
  int admitted = 0, refused = 0;
  for (int k = 0; k < 400; ++k) {
    const double radius = random.Uniform(4, 12), corner = random.Uniform() < 0.3 ? 0.0 : random.Uniform(0, 1);
    const CutterShape cutter{radius, corner * radius, 40};
    const double curvature = random.Uniform() < 0.3 ? 0.0 : random.Uniform(-1, 1) / 150;
    const bool zigzag = random.Uniform() < 0.5;
    const double height = random.Uniform(0.01, 0.1);
    const double lead = random.Uniform(0.002, 0.2), tilt = random.Uniform(-0.05, 0.05);
    const Scallops outline(cutter, lead, tilt, zigzag);
    const auto [left, right] = outline.Reaches(height, curvature);
    EXPECT_NEAR(left + right, outline.Stepover(height, curvature), 1e-9);
    for (const double share : {0.98, 1.02}) {
      const bool covers = outline.Covers(height, curvature, share * left, share * right);
      EXPECT_EQ(covers, share < 1) << k << " r " << cutter.corner_radius << " of " << radius << " at "
                                   << curvature;
      (covers ? admitted : refused) += 1;
    }
  }
  EXPECT_GT(admitted, 300);
  EXPECT_GT(refused, 300);
}

TEST(LeanBound, OfABallIsItsCuttingSpeed) {
  LeanRules rules{
      .cutter = {8, 8, 40}, .lead = DegToRad(5), .stepover = 3, .min_speed_share = 0.3, .surface = nullptr};
  EXPECT_TRUE(Admits(rules, 5, 0));
  const double least = RadToDeg(std::asin(0.3 * std::sin(DegToRad(5))));
  EXPECT_TRUE(Admits(rules, least + 1e-4, 0));
  EXPECT_FALSE(Admits(rules, least - 1e-4, 0));
  EXPECT_FALSE(Admits(rules, 0, 0));
  EXPECT_TRUE(Admits(rules, 0, -3));
  EXPECT_TRUE(Admits(rules, -9, 9));
  rules.lead = 0;  // at the nominal lean the speed is 0: no bound
  EXPECT_TRUE(Admits(rules, 0, 0));
}

TEST(Leans, AreReadFromTheAxisThatTheyMake) {
  RandomStream random(17, 0);
  for (int k = 0; k < 200; ++k) {
    const Vector3d normal = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const Vector3d feed = normal.unitOrthogonal();
    const Leans made{random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const Vector3d axis = AxisOf(made, normal, feed);
    const Leans read = LeansOf(axis, normal, feed);
    EXPECT_NEAR(read.lead, made.lead, 1e-12);
    EXPECT_NEAR(read.tilt, made.tilt, 1e-12);
    // Towards the feed, and to its right seen against the normal.
    EXPECT_EQ(axis.dot(feed) > 0, made.lead > 0);
    EXPECT_EQ(axis.dot(feed.cross(normal)) > 0, made.tilt > 0);
  }
}

// The same depth as the gouge check's own, from a part that stands elsewhere; and between two stances what
// neither shows.
TEST(LeanSurface, SeesThePartWhereItStands) {
  const Mesh mesh = SoundMesh(Vault(200, 300, true));
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
  X_WP.rotate(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  X_WP.pretranslate(Vector3d(900, -300, 400));
  const CutterShape cutter{8, 8, 40};
  const LeanSurface surface(mesh, CornerNormals(mesh, DegToRad(30)), X_WP, cutter, 0.02);
  RandomStream random(18, 0);
  int deep = 0;
  for (int k = 0; k < 60; ++k) {
    const double angle = random.Uniform(0.5, 1.1);
    const Vector3d normal(std::cos(angle), 0, std::sin(angle)),
        contact = random.Uniform(199, 200.5) * normal + random.Uniform(20, 80) * Vector3d::UnitY();
    const Vector3d axis =
        AxisOf({random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3)}, normal, Vector3d::UnitY());
    const Vector3d tip = TipAtContact(cutter, contact, normal, axis);
    const double depth = DeepestGouge(mesh, cutter, tip, axis, 0.02).depth;
    EXPECT_NEAR(surface.Gouge(X_WP * tip, X_WP.linear() * axis), depth, 2e-3);
    deep += depth > 0;
    EXPECT_NEAR(surface.Bend(X_WP * (200 * normal + 50 * Vector3d::UnitY()), X_WP.linear() * normal,
                             X_WP.linear() * Vector3d::UnitY()),
                1 / 200.0, 1e-4);
  }
  EXPECT_GT(deep, 10);
  EXPECT_LT(deep, 50);
  // Over the crown from one flank to the other, in a straight line.
  const auto radial = [](double angle) { return Vector3d(std::cos(angle), 0, std::sin(angle)); };
  const auto at = [&](double angle) {
    return Vector3d(X_WP * (200.5 * radial(angle) + 50 * Vector3d::UnitY()));
  };
  const Vector3d up = X_WP.linear() * radial(0.8);
  EXPECT_EQ(surface.Gouge(at(0.6), up), 0);
  EXPECT_EQ(surface.Gouge(at(1.0), up), 0);
  EXPECT_GT(surface.GougeBetween(at(0.6), up, at(1.0), up), 1);
}

}  // namespace
}  // namespace millpose
