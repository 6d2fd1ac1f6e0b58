// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/edge_cut.hpp"

#include <gtest/gtest.h>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

EdgeModel SomeEdge(double corner_radius, double mc = 0.25) {
  EdgeModel model;
  model.material = {"made up", 700, mc, ""};
  model.cutter = {10, corner_radius, 40};
  model.teeth = 4;
  model.radial_ratio = 0.3;
  model.axial_ratio = -0.1;
  return model;
}

CutterStance Upright() { return {Vector3d(3, 4, 5), Vector3d::UnitX(), Vector3d::UnitZ(), 0.05}; }

/// Material of a width on one side: up to `depth` above the tip, where `side` holds for the place to the
/// left.
InMaterial NearestEquivalent(double depth, const std::function<bool(double)>& side) {
  return [=](const Vector3d& place) { return place.z() - 5 <= depth && side(place.y() - 4); };
}

TEST(EdgeCut, ACylinderHasTheClosedFormsForce) {
  const EdgeModel model = SomeEdge(0);
  for (const double width : {1.0, 7.0, 10.0, 16.0}) {
    for (const MillingSide side : {MillingSide::kUp, MillingSide::kDown, MillingSide::kSlot}) {
      Cut cut{model.material, 20, 4, 2, width, 0.05, side, model.radial_ratio, model.axial_ratio};
      const CuttingForce expected = MeanCuttingForce(cut);
      const auto slices = SliceEdge(model.cutter, 2, 0.5);
      const auto arcs = EngagedArcs(slices, Upright(), NearestEquivalent(2, [&](double left) {
                                      return side == MillingSide::kSlot ||
                                             (side == MillingSide::kUp ? left : -left) > 10 - width;
                                    }));
      const Vector3d found = MeanForce(model, slices, Upright(), arcs);
      EXPECT_LT((found - expected.mean).norm(), 4e-3 * expected.mean.norm()) << width;
      EXPECT_NEAR(PeakForce(model, slices, Upright(), arcs, 2000) / expected.peak, 1, 4e-3) << width;
    }
  }
}

/// Area of the cut's section across the feed by the chips: ∫ (feed · normal) dA over the engaged envelope.
double SectionByChips(const std::vector<EdgeSlice>& slices, const CutterStance& stance,
                      const std::vector<EngagedArc>& arcs) {
  const Vector3d left = stance.Across(), ahead = left.cross(stance.axis);
  double area = 0;
  for (const EngagedArc& arc : arcs) {
    const EdgeSlice& slice = slices[arc.slice];
    constexpr int kSteps = 200;
    for (int i = 0; i < kSteps; ++i) {
      const auto [s, c] = SinCos(arc.start + (arc.end - arc.start) * (i + 0.5) / kSteps);
      const Vector3d normal = slice.sin_lead * (s * ahead + c * left) - slice.cos_lead * stance.axis;
      area += stance.feed.dot(normal) * slice.radius * (arc.end - arc.start) / kSteps * slice.length;
    }
  }
  return area;
}

TEST(EdgeCut, ChipsOfAnyCutterAddUpToTheSectionThatIsCut) {
  // In full material below a plane the section is the cutter's outline seen along the feed, up to the plane.
  for (const double corner : {0.0, 3.0, 10.0}) {
    for (const double lead : {0.0, 0.2, -0.2}) {
      const CutterShape cutter{10, corner, 40};
      const CutterStance stance{Vector3d::Zero(), Vector3d::UnitX(),
                                Vector3d(SinCos(lead).sin, 0, SinCos(lead).cos), 0.05};
      const double plane = 2.5;
      const auto slices = SliceEdge(cutter, 30, 0.1);
      const auto arcs = EngagedArcs(slices, stance, [&](const Vector3d& place) { return place.z() < plane; });
      // The outline: for each place to the left the lowest of the cutter's circles.
      double section = 0;
      constexpr int kColumns = 400;
      for (int k = 0; k < kColumns; ++k) {
        const double y = -10 + 20 * (k + 0.5) / kColumns;
        double lowest = plane;
        for (double up = 0; up < 12; up += 0.01) {
          const double below = std::max(0.0, corner - up);
          const double radius = 10 - corner + std::sqrt(corner * corner - below * below);
          if (radius < std::abs(y)) continue;
          const double along = std::sqrt(radius * radius - y * y);
          lowest = std::min(lowest, up * stance.axis.z() - along * std::abs(stance.axis.x()));
        }
        section += (plane - lowest) * 20 / kColumns;
      }
      EXPECT_NEAR(SectionByChips(slices, stance, arcs) / section, 1, 0.02) << corner << ' ' << lead;
    }
  }
}

TEST(EdgeCut, ABallIsPushedUpAndSlicesConverge) {
  EdgeModel model = SomeEdge(10);
  model.axial_ratio = 0;
  const InMaterial shallow = NearestEquivalent(1, [](double) { return true; });
  const auto force = [&](double step) {
    const auto slices = SliceEdge(model.cutter, 1, step);
    return MeanForce(model, slices, Upright(), EngagedArcs(slices, Upright(), shallow));
  };
  const Vector3d coarse = force(0.25), fine = force(0.01);
  EXPECT_LT((coarse - fine).norm(), 0.03 * fine.norm());
  EXPECT_GT(fine.z(), 0);  // the sphere's lowest part slides on what it cuts
  const auto flat = SliceEdge(CutterShape{10, 0, 40}, 1, 0.25);
  EdgeModel cylinder = SomeEdge(0);
  cylinder.axial_ratio = 0;
  EXPECT_EQ(MeanForce(cylinder, flat, Upright(), EngagedArcs(flat, Upright(), shallow)).z(), 0);
}

TEST(EdgeCut, TheFlatCutsWhereTheFeedGoesDownByMoreThanAThousandth) {
  const auto slices = SliceEdge(CutterShape{10, 0, 40}, 1, 0.25);
  const auto flat_cuts = [&](double down) {
    CutterStance stance = Upright();
    stance.feed = Vector3d(1, 0, -down).normalized();
    const auto arcs = EngagedArcs(slices, stance, [](const Vector3d&) { return true; });
    return std::ranges::any_of(arcs, [&](const EngagedArc& arc) { return slices[arc.slice].sin_lead == 0; });
  };
  for (const double down : {-0.1, 0.0, 1e-16, 0.9e-3}) EXPECT_FALSE(flat_cuts(down)) << down;
  for (const double down : {1.1e-3, 0.02}) EXPECT_TRUE(flat_cuts(down)) << down;
}

TEST(EdgeCut, MirroredMaterialMirrorsTheArcs) {
  const CutterShape cutter{10, 3, 40};
  const auto slices = SliceEdge(cutter, 2, 0.5);
  const auto up = EngagedArcs(slices, Upright(), NearestEquivalent(2, [](double left) { return left > 4; }));
  const auto down =
      EngagedArcs(slices, Upright(), NearestEquivalent(2, [](double left) { return left < -4; }));
  ASSERT_EQ(up.size(), down.size());
  ASSERT_FALSE(up.empty());
  for (size_t i = 0; i < up.size(); ++i) {
    EXPECT_NEAR(up[i].start, kPi - down[i].end, 1e-3);
    EXPECT_NEAR(up[i].end, kPi - down[i].start, 1e-3);
  }
}

TEST(CutWidths, MergesWhatSlicesShareAndKeepsApartWhatTheyDoNot) {
  const std::vector<EdgeSlice> slices{{10, 0.5, 1, 1, 0}, {10, 1.5, 1, 1, 0}};
  const auto one = CutWidths(slices, {{0, 0, kPi / 3}, {1, 0, kPi / 2}});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].first, 0, 1e-12);
  EXPECT_NEAR(one[0].second, 10, 1e-12);
  EXPECT_EQ(CutWidths(slices, {{0, 0, 1}, {1, 2, kPi}}).size(), 2u);
}

}  // namespace
}  // namespace millpose
