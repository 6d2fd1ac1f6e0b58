// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/process_force.hpp"

#include <set>

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"
#include "toolpath/engagement/cutting_material.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Cut SomeCut(MillingSide side) {
  Cut cut;
  cut.material = {"linear", 800, 0,
                  ""};  // m_c = 0: force proportional to chip thickness, with closed integrals
  cut.diameter = 20;
  cut.teeth = 3;
  cut.depth = 2;
  cut.width = 10;
  cut.feed_per_tooth = 0.1;
  cut.side = side;
  cut.radial_ratio = 0.3;
  cut.axial_ratio = -0.1;
  return cut;
}

TEST(ProcessForce, AgreesWithAltintasClosedForm) {
  // Manufacturing Automation, 2nd ed., eq. 2.79 for forces proportional to the chip thickness.
  for (const MillingSide side : {MillingSide::kUp, MillingSide::kDown, MillingSide::kSlot}) {
    const Cut cut = SomeCut(side);
    const double start = side == MillingSide::kDown ? kPi / 2 : 0,
                 end = side == MillingSide::kUp ? kPi / 2 : kPi;
    const double K = cut.material.kc11, a = cut.depth, c = cut.feed_per_tooth, N = cut.teeth,
                 r = cut.radial_ratio;
    const auto x = [&](double p) {
      return N * a * c / (8 * kPi) * (K * std::cos(2 * p) - r * K * (2 * p - std::sin(2 * p)));
    };
    const auto y = [&](double p) {
      return N * a * c / (8 * kPi) * (K * (2 * p - std::sin(2 * p)) + r * K * std::cos(2 * p));
    };
    const auto z = [&](double p) { return N * a * c / (2 * kPi) * (-cut.axial_ratio * K * std::cos(p)); };
    const CuttingForce found = MeanCuttingForce(cut);
    EXPECT_NEAR(found.mean.x(), x(end) - x(start), 1e-5);
    EXPECT_NEAR(found.mean.y(), y(end) - y(start), 1e-5);
    EXPECT_NEAR(found.mean.z(), z(end) - z(start), 1e-5);
    EXPECT_NEAR(found.engaged, N * (end - start) / (2 * kPi), 1e-12);
    EXPECT_GT(found.peak, found.mean.norm());
  }
}

TEST(ProcessForce, GrowsWithDepthAndLessThanProportionallyWithFeed) {
  Cut cut = SomeCut(MillingSide::kDown);
  cut.material = CuttingMaterials().front();
  const double one = MeanCuttingForce(cut).mean.norm();
  cut.depth *= 2;
  EXPECT_NEAR(MeanCuttingForce(cut).mean.norm() / one, 2, 1e-9);
  cut.depth /= 2;
  cut.feed_per_tooth *= 2;
  EXPECT_NEAR(MeanCuttingForce(cut).mean.norm() / one, std::pow(2, 0.75), 1e-9);
}

TEST(ProcessForce, SlottingWithOneToothHasItsPeakInTheChip) {
  Cut cut = SomeCut(MillingSide::kSlot);
  cut.teeth = 1;
  cut.radial_ratio = cut.axial_ratio = 0;
  EXPECT_NEAR(MeanCuttingForce(cut).peak, 800 * 2 * 0.1, 1e-3);
}

TEST(PredictedDeflection, SplitsTheVectorWithoutLoss) {
  RandomStream stream(1, 0);
  for (int k = 0; k < 100; ++k) {
    const auto unit = [&] { return RandomUnit(stream); };
    const Vector3d n = unit(), feed = n.cross(unit()).normalized();
    Matrix3d root;
    for (double& value : root.reshaped()) value = stream.Normal();
    const Matrix3d c = 1e-4 * root * root.transpose();
    const Vector3d force(30, -50, 10);
    const PredictedDeflection d = PredictDeflection(c, force, n, feed);
    const Vector3d whole = c * force;
    EXPECT_NEAR(d.length, whole.norm(), 1e-15);
    EXPECT_NEAR(d.normal * d.normal + d.feed * d.feed + d.across * d.across, whole.squaredNorm(), 1e-15);
    EXPECT_NEAR(d.normal, n.dot(whole), 1e-15);
    EXPECT_NEAR(d.feed, feed.dot(whole), 1e-15);
  }
}

TEST(OverFace, TellsLevelFromVariationAndStep) {
  std::vector<FacePoint> points;
  for (int pass = 0; pass < 5; ++pass)
    for (int i = 0; i < 9; ++i) points.push_back({Vector3d(10 * i, 20 * pass, 0), pass, 0.08 + 1e-4 * i});
  const auto tilted = OverFace(points);
  ASSERT_TRUE(tilted.has_value());
  EXPECT_NEAR(tilted->level, 0.0804, 1e-12);
  EXPECT_NEAR(tilted->variation, 0, 1e-12);  // a tilt is a plane, too
  EXPECT_NEAR(tilted->largest_step, 0, 1e-12);
  for (FacePoint& point : points)
    if (point.pass % 2 == 1) point.deflection += 0.01;
  const auto stepped = OverFace(points);
  EXPECT_NEAR(stepped->largest_step, 0.01, 1e-12);
  EXPECT_NEAR(stepped->variation, 0.01, 1e-3);
  EXPECT_FALSE(OverFace({points[0], points[1]}).has_value());
}

TEST(OverFace, StepsAreThoseOfANaiveSearchForTheNearestPointOfAnotherPass) {
  RandomStream stream(7, 1);
  for (int run = 0; run < 20; ++run) {
    std::vector<FacePoint> points;
    for (int i = 0; i < 200; ++i)
      points.push_back({Vector3d(stream.Uniform(0, 100), stream.Uniform(0, 900), stream.Uniform(0, 5)),
                        stream.Below(8), stream.Normal()});
    double largest = 0;
    for (const FacePoint& here : points) {
      const FacePoint* nearest = nullptr;
      for (const FacePoint& other : points)
        if (other.pass != here.pass && (!nearest || (other.position - here.position).norm() <
                                                        (nearest->position - here.position).norm()))
          nearest = &other;
      largest = std::max(largest, std::abs(nearest->deflection - here.deflection));
    }
    EXPECT_EQ(OverFace(points)->largest_step, largest);
  }
}

TEST(OverFace, APassCutByAHoleHasItsNeighboursBesideItNotBeyondTheHole) {
  // Passes 1 and 2 lie in one line left and right of a hole; the face bends along that line.
  std::vector<FacePoint> points;
  for (const auto& [pass, first, last, y] : {std::tuple{0, 0, 20, 0.0}, std::tuple{1, 0, 8, 5.0},
                                             std::tuple{2, 12, 20, 5.0}, std::tuple{3, 0, 20, 10.0}})
    for (int i = first; i <= last; ++i) points.push_back({Vector3d(10 * i, y, 0), pass, 1e-4 * i * i});
  EXPECT_EQ(OverFace(points)->largest_step, 0.0);
}

TEST(ProcessForce, PeakIsTheLargestSumOverAllTeeth) {
  for (const int teeth : {1, 3, 5}) {
    Cut cut = SomeCut(MillingSide::kSlot);
    cut.teeth = teeth;
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
      Vector3d sum = Vector3d::Zero();
      for (int tooth = 0; tooth < teeth; ++tooth) {
        const double phi = 2 * kPi * (i / 20000.0 + tooth) / teeth;
        if (phi > kPi) continue;
        const double t = 800 * 2 * 0.1 * std::sin(phi);
        sum += t * Vector3d(-std::cos(phi) - 0.3 * std::sin(phi), std::sin(phi) - 0.3 * std::cos(phi), -0.1);
      }
      largest = std::max(largest, sum.norm());
    }
    EXPECT_NEAR(MeanCuttingForce(cut).peak / largest, 1, 1e-4) << teeth;
  }
}

TEST(CuttingMaterials, EveryNameAndAliasIsThereOnce) {
  std::set<std::string> keys;
  for (const CuttingMaterial& known : CuttingMaterials())
    EXPECT_TRUE(keys.insert(MaterialKey(known.name)).second) << known.name;
  for (const MaterialAlias& alias : MaterialAliases())
    EXPECT_TRUE(keys.insert(MaterialKey(alias.alias)).second) << alias.alias;
}

TEST(CuttingMaterials, EveryValueHasItsSourceAndIsOneOfMetals) {
  for (const CuttingMaterial& known : CuttingMaterials()) {
    EXPECT_TRUE(known.source.starts_with("ISCAR 2022, group ")) << known.name;
    EXPECT_TRUE(known.kc11 >= 500 && known.kc11 <= 5000) << known.name;
    EXPECT_TRUE(known.mc >= 0.15 && known.mc <= 0.35) << known.name;
  }
}

TEST(CuttingMaterials, AliasesAreFoundHoweverTheyAreWritten) {
  const auto name = [](const std::string& given) {
    const CuttingMaterial* found = FindCuttingMaterial(given);
    return found ? found->name : "";
  };
  for (const CuttingMaterial& known : CuttingMaterials()) EXPECT_EQ(name(known.name), known.name);
  for (const MaterialAlias& alias : MaterialAliases())
    EXPECT_EQ(name(alias.alias), alias.name) << alias.alias;
  EXPECT_EQ(name("6061"), "AlMgSi");
  EXPECT_EQ(name("EN AW-6082"), "AlMgSi");
  EXPECT_EQ(name("7075"), "AlZnMgCu");
  EXPECT_EQ(name("2024"), "AlCuMg");
  EXPECT_EQ(name("316l"), "X2CrNiMo17-12-2");
  EXPECT_EQ(name("1.4404"), "X2CrNiMo17-12-2");
  EXPECT_EQ(name("ti6al4v"), "TiAl6V4");
  EXPECT_EQ(name("Inconel 718"), "Inconel718");
  EXPECT_EQ(name(""), "");
  EXPECT_EQ(name("AlMgS"), "");
}

TEST(CuttingMaterials, WhatIsNotKnownIsToldWithTheNearest) {
  EXPECT_TRUE(UnknownMaterial("6062").ends_with("; nearest: 6060")) << UnknownMaterial("6062");
  EXPECT_TRUE(UnknownMaterial("1.4405").ends_with("; nearest: 1.4401")) << UnknownMaterial("1.4405");
  EXPECT_NE(UnknownMaterial("CFRP").find("composites have no value"), std::string::npos);
}

}  // namespace
}  // namespace millpose
