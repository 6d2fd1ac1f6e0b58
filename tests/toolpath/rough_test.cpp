// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough.hpp"

#include "base/error.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/tier.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/rough_counter.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct RoughCase {
  std::string name;
  std::vector<CountedBlock> part;  ///< the first one is the base plate
  Vector2d lower, upper;           ///< of the stock
  double top = 0;
  CutterShape cutter{6, 0, 30};
  bool centre_cutting = false;
  bool climb = true;
  double engagement = DegToRad(70);
  double share_left = 0.005;  ///< of what is reachable; up to three quarters of a cell along walls
};

constexpr double kFloor = -5;  // of all parts and of the stock, mm
constexpr double kRoughFeed = 10;

// A base plate that its frame makes a pocket of, with an island in it.
RoughCase Pocket() {
  return {"pocket",
          {{{0, 0}, {90, 70}, 0},
           {{0, 0}, {90, 8}, 16},
           {{0, 62}, {90, 70}, 16},
           {{0, 8}, {8, 62}, 16},
           {{82, 8}, {90, 62}, 16},
           {{38, 28}, {56, 44}, 10}},
          {0, 0},
          {90, 70},
          18};
}

// A block with a step on a plate, open on all sides.
RoughCase Open() {
  return {"open",
          {{{0, 0}, {70, 60}, 0}, {{20, 15}, {50, 45}, 8}, {{20, 15}, {35, 45}, 14}},
          {-4, -5},
          {74, 66},
          16};
}

// A slot a little wider than the cutter, open at one end.
RoughCase Slot() {
  RoughCase slot{
      "slot",
      {{{0, 0}, {60, 40}, 0}, {{0, 0}, {60, 11}, 10}, {{0, 29}, {60, 40}, 10}, {{52, 11}, {60, 29}, 10}},
      {0, 0},
      {60, 40},
      10};
  slot.share_left = 0.01;
  return slot;
}

// The first two in the quick tier, where other tests hold the volume of the open block.
std::vector<RoughCase> RoughCases() {
  std::vector<RoughCase> cases{Pocket(), Slot(), Open()};
  RoughCase bull = Pocket();
  bull.name = "bull-nose, conventional";
  bull.cutter = {6, 1, 30};
  bull.climb = false;
  RoughCase wide = Pocket();
  wide.name = "half a slot";
  wide.engagement = DegToRad(90);
  cases.push_back(bull);
  cases.push_back(wide);
  cases.resize(static_cast<size_t>(OfTier(2, 5)));
  return cases;
}

Mesh MeshOf(const std::vector<CountedBlock>& part) {
  Triangles all;
  for (const CountedBlock& block : part)
    Append(all, BoxShape({block.lower.x(), block.lower.y(), kFloor},
                         {block.upper.x(), block.upper.y(), block.top}));
  return Mesh(all);
}

/// Lines along one of the axes.
StandingColumns ColumnsOf(const RoughCase& given, int along) {
  constexpr double kSpacing = 0.25;
  const Vector3d lower(given.lower.x(), given.lower.y(), kFloor),
      upper(given.upper.x(), given.upper.y(), given.top);
  StandingColumns columns{kSpacing};
  const int first = (along + 1) % 3, second = (along + 2) % 3;
  for (double a = lower[first] + kSpacing / 2; a < upper[first]; a += kSpacing)
    for (double b = lower[second] + kSpacing / 2; b < upper[second]; b += kSpacing) {
      Vector3d low = lower, high = upper;
      low[first] = high[first] = a;
      low[second] = high[second] = b;
      columns.columns.push_back({low, high});
    }
  return columns;
}

constexpr double kAllowance = 0.5;

ToolpathOptions Roughing(const RoughCase& given) {
  Rough rough;
  rough.allowance = kAllowance;
  rough.per_layer = 6;
  rough.max_engagement = given.engagement;
  rough.climb = given.climb;
  rough.bottom = kAllowance;
  ToolpathOptions options;
  options.strategy = std::make_shared<Rough>(rough);
  options.cutter = given.cutter;
  options.centre_cutting = given.centre_cutting;
  options.max_ramp = DegToRad(5);
  options.feed_rate = kRoughFeed;
  options.plunge_feed = 2;
  options.retract_feed = 50;
  options.spacing = 10;
  options.chord_tolerance = 0.05;
  options.tool_axis = {AxisRule::kFixed, Vector3d::Zero(), Vector3d::UnitZ()};
  return options;
}

LaidPath RoughLaid(const RoughCase& given, const ToolpathOptions& options, int threads = 2, int along = 2) {
  const StandingColumns columns = ColumnsOf(given, along);
  return options.strategy->Make({MeshOf(given.part), options, {}, &columns, threads}, {});
}

RoughCounter Counted(const RoughCase& given, const Toolpath& toolpath) {
  RoughCounter counter(given.lower, given.upper, given.top, 0.125, given.part,
                       {given.cutter.radius, given.cutter.corner_radius, kAllowance, kRoughFeed});
  counter.Mill(toolpath);
  return counter;
}

/// The pocket's path by its own options, laid once for all tests.
const LaidPath& PocketLaid() {
  static const LaidPath laid = RoughLaid(Pocket(), Roughing(Pocket()));
  return laid;
}

size_t RoughPointCount(const Toolpath& toolpath) {
  size_t count = 0;
  for (const Pass& pass : toolpath.passes) count += pass.points.size();
  return count;
}

// Against the independent count: nothing of the allowance is cut, all that the cutter reaches is, the
// engagement stays near its bound, nothing is plunged into and nothing cut on ways in the air.
TEST(Rough, TakesOffAllThatItReachesWithinItsEngagement) {
  for (const RoughCase& given : RoughCases()) {
    SCOPED_TRACE(given.name);
    const LaidPath laid = given.name == "pocket" ? PocketLaid() : RoughLaid(given, Roughing(given));
    EXPECT_TRUE(laid.findings.empty()) << laid.findings.front();
    const RoughCounter counter = Counted(given, laid.toolpath);
    const double reachable = counter.Reachable();
    EXPECT_LE(counter.DeepestGouge(), 0.05);
    EXPECT_NEAR(counter.Removed(), reachable, given.share_left * reachable);
    EXPECT_LE(counter.Engagement(), 1.15 * given.engagement);
    EXPECT_GT(counter.Engagement(), 0.8 * given.engagement);
    EXPECT_LE(counter.DeepestPlunge(), 0.05);
    EXPECT_LE(counter.SteepestEntry(), std::tan(DegToRad(3)) + 1e-9);
    // What a corner radius leaves beside its floor is met by its rim.
    EXPECT_LE(counter.EngagementInTheAir(), DegToRad(given.cutter.corner_radius > 0 ? 10 : 2));
    RecordProperty(given.name + " points", static_cast<int>(RoughPointCount(laid.toolpath)));
    RecordProperty(given.name + " passes", static_cast<int>(laid.toolpath.passes.size()));
    RecordProperty(given.name + " engagement", std::to_string(RadToDeg(counter.Engagement())));
    RecordProperty(given.name + " removed", std::to_string(counter.Removed() / reachable));
    RecordProperty(given.name + " gouge", std::to_string(counter.DeepestGouge()));
    RecordProperty(given.name + " air", std::to_string(RadToDeg(counter.EngagementInTheAir())));
  }
}

// Lines across the tool axis tell the same of a box as lines along it.
TEST(Rough, KnowsStockWhateverItsLinesRunAlong) {
  const RoughCase given = Open();
  const RoughCounter counter = Counted(given, RoughLaid(given, Roughing(given), 2, 0).toolpath);
  const double reachable = counter.Reachable();
  EXPECT_NEAR(counter.Removed(), reachable, 0.005 * reachable);
  EXPECT_LE(counter.DeepestGouge(), 0.05);
}

// Part, stock and axis turned together: what is milled turns with them.
TEST(Rough, MillsAlongItsAxis) {
  const RoughCase given = OfTier(0, 1) == 0 ? Slot() : Pocket();
  const Eigen::Isometry3d X(Eigen::Translation3d(10, -7, 30) *
                            Eigen::AngleAxisd(0.7, Vector3d(0.3, 0.9, -0.2).normalized()));
  ToolpathOptions options = Roughing(given);
  options.tool_axis.direction = X.linear() * Vector3d::UnitZ();
  Rough rough = dynamic_cast<const Rough&>(*options.strategy);
  rough.bottom = *rough.bottom + options.tool_axis.direction.dot(X.translation());
  options.strategy = std::make_shared<Rough>(rough);
  StandingColumns columns = ColumnsOf(given, 2);
  for (auto& [low, high] : columns.columns) low = X * low, high = X * high;
  const Mesh mesh(Moved(MeshOf(given.part).triangles(), X));
  const LaidPath laid = options.strategy->Make({mesh, options, {}, &columns, 2}, {});
  const RoughCounter counter = Counted(given, Transformed(laid.toolpath, X.inverse()));
  const double reachable = counter.Reachable();
  EXPECT_NEAR(counter.Removed(), reachable, given.share_left * reachable);
  EXPECT_LE(counter.DeepestGouge(), 0.05);
  for (const Pass& pass : laid.toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      EXPECT_LT((point.tool_axis - options.tool_axis.direction).norm(), 1e-12);
      EXPECT_LT(std::abs(point.feed.dot(point.normal)), 1e-9);
      EXPECT_NEAR(point.feed.norm(), 1, 1e-9);
    }
}

TEST(Rough, IsTheSameForAnyNumberOfThreads) {
  const RoughCase given = Pocket();
  const Toolpath one = RoughLaid(given, Roughing(given), 1).toolpath;
  const Toolpath& many = PocketLaid().toolpath;  // by two
  ASSERT_EQ(one.passes.size(), many.passes.size());
  for (size_t i = 0; i < one.passes.size(); ++i) {
    ASSERT_EQ(one.passes[i].points.size(), many.passes[i].points.size());
    for (size_t k = 0; k < one.passes[i].points.size(); ++k) {
      EXPECT_EQ(one.passes[i].points[k].position, many.passes[i].points[k].position);
      EXPECT_EQ(one.passes[i].points[k].feed, many.passes[i].points[k].feed);
    }
  }
}

// A finer path has the same places and more between them.
TEST(Rough, PartsCutEachStep) {
  const RoughCase given = Slot();
  ToolpathOptions options = Roughing(given);
  const Toolpath coarse = RoughLaid(given, options).toolpath;
  options.parts = 2;
  const Toolpath fine = RoughLaid(given, options).toolpath;
  ASSERT_EQ(coarse.passes.size(), fine.passes.size());
  for (size_t i = 0; i < coarse.passes.size(); ++i) {
    ASSERT_EQ(2 * coarse.passes[i].points.size() - 1, fine.passes[i].points.size());
    for (size_t k = 0; k < coarse.passes[i].points.size(); ++k)
      EXPECT_LT((coarse.passes[i].points[k].position - fine.passes[i].points[2 * k].position).norm(), 1e-9);
  }
}

/// What a counter has left as stock.
StandingColumns ColumnsOf(const RoughCounter& counter) {
  StandingColumns columns{counter.cell()};
  counter.ForEachCell([&](const Vector2d& p, double height) {
    columns.columns.push_back({Vector3d(p.x(), p.y(), kFloor), Vector3d(p.x(), p.y(), height)});
  });
  return columns;
}

double RoughLength(const Toolpath& toolpath) {
  double length = 0;
  for (const Pass& pass : toolpath.passes) length += pass.points.back().arc_length;
  return length;
}

// A smaller cutter after a larger one goes where that has left something, and no way along the walls.
TEST(Rough, TakesOffWhatALargerCutterHasLeft) {
  const RoughCase large = Pocket();
  RoughCase small = large;
  small.cutter.radius = 3;
  const RoughCounter before = Counted(large, PocketLaid().toolpath);
  ToolpathOptions options = Roughing(small);
  const double whole = RoughLength(RoughLaid(small, options).toolpath);
  Rough rough = dynamic_cast<const Rough&>(*options.strategy);
  rough.thicker_than = 0.4;
  options.strategy = std::make_shared<Rough>(rough);
  const StandingColumns left = ColumnsOf(before);
  const LaidPath laid = options.strategy->Make({MeshOf(small.part), options, {}, &left, 2}, {});
  EXPECT_LT(RoughLength(laid.toolpath), 0.3 * whole);
  RoughCounter counter = before;
  counter.Change({small.cutter.radius, 0, kAllowance, kRoughFeed});
  counter.Mill(laid.toolpath);
  EXPECT_LE(counter.DeepestGouge(), 0.05);
  EXPECT_LE(counter.Engagement(), 1.15 * small.engagement);
  const double reachable = counter.Reachable();
  EXPECT_NEAR(counter.Removed(), reachable, 0.005 * reachable);
  EXPECT_GT(reachable - before.Removed(), 0.006 * reachable) << "or there was nothing to do";
}

// A hole that the cutter fits into without room for a helix or ramp stays, and is told of.
TEST(Rough, TellsOfWhatItCannotEnter) {
  RoughCase given = Pocket();
  const double side = 2 * given.cutter.radius + 2 * kAllowance + 1;
  given.part = {{{0, 0}, {60, 60}, 0},
                {{0, 0}, {20, 60}, 12},
                {{20 + side, 0}, {60, 60}, 12},
                {{20, 0}, {20 + side, 20}, 12},
                {{20, 20 + side}, {20 + side, 60}, 12}};
  given.upper = {60, 60};
  given.top = 12.4;  // less than an allowance: all else is done
  const std::string refusal = RefusalOf([&] { RoughLaid(given, Roughing(given)); });
  EXPECT_NE(refusal.find("nothing to take off"), std::string::npos) << refusal;
  given.top = 14;
  const LaidPath laid = RoughLaid(given, Roughing(given));
  ASSERT_FALSE(laid.findings.empty());
  EXPECT_NE(laid.findings.front().find("no room for a helix or ramp"), std::string::npos)
      << laid.findings.front();
  EXPECT_LE(Counted(given, laid.toolpath).DeepestPlunge(), 0.05);
}

TEST(Rough, RefusesWhatItCannotKeep) {
  const RoughCase given = Pocket();
  const auto refusal = [&](auto change) {
    ToolpathOptions options = Roughing(given);
    Rough rough = dynamic_cast<const Rough&>(*options.strategy);
    change(options, rough);
    options.strategy = std::make_shared<Rough>(rough);
    return RefusalOf([&] { RoughLaid(given, options); });
  };
  EXPECT_NE(refusal([](ToolpathOptions& o, Rough&) { o.tool_axis = {}; }).find("toolpath.tool_axis"),
            std::string::npos);
  EXPECT_NE(refusal([](ToolpathOptions& o, Rough&) { o.cutter.corner_radius = 6; }).find("corner radius"),
            std::string::npos);
  EXPECT_NE(refusal([](ToolpathOptions&, Rough& r) { r.ramp = 0.2; }).find("toolpath.rough.ramp_deg"),
            std::string::npos);
  EXPECT_NE(refusal([](ToolpathOptions&, Rough& r) { r.per_layer = 31; }).find("toolpath.rough.per_layer_mm"),
            std::string::npos);
  EXPECT_NE(refusal([](ToolpathOptions&, Rough& r) { r.bottom = 20; }).find("nothing to take off"),
            std::string::npos);
  EXPECT_NE(refusal([](ToolpathOptions& o, Rough&) { o.budget.most = 100; }).find("allowed: at most 100"),
            std::string::npos);
}

}  // namespace
}  // namespace millpose
