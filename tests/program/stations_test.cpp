// SPDX-License-Identifier: GPL-3.0-or-later
// Programs with external axes: what their texts say, by plain arithmetic; written, read and written again.
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/external_axes.hpp"
#include "program/krl/krl.hpp"
#include "program/make_timeline.hpp"
#include "program/scanner.hpp"
#include "tests/program/interpreter.hpp"
#include "tests/program/program_lines.hpp"
#include "tests/program/station_plan.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct StationCase {
  std::string variant, axes;
  bool coupled;
};

class Stations : public testing::TestWithParam<StationCase> {
 protected:
  PlanResult plan = StationPlan(GetParam().axes);
  MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  StationPost post{GetParam().variant, plan, GetParam().coupled};
  ProgramFiles files = post.Write(program, plan.arm);

  std::string Text() const { return files.rbegin()->second; }
  MotionProgram Read() const { return post.post->Read(files, plan.arm, post.settings); }
};

std::vector<StationCase> StationCases() {
  std::vector<StationCase> cases;
  for (const char* variant : {"krl", "sinumerik", "linuxcnc", "linuxcnc_cartesian"})
    for (const char* axes : {"rail", "table", "both"})
      for (const bool coupled : {true, false})
        if (!coupled || variant != std::string("linuxcnc")) cases.push_back({variant, axes, coupled});
  return cases;
}
INSTANTIATE_TEST_SUITE_P(All, Stations, testing::ValuesIn(StationCases()), [](const auto& c) {
  return c.param.variant + "_" + c.param.axes + (c.param.coupled ? "_coupled" : "_alone");
});

TEST(StationMotions, TheArmStandsAtHomeWhereTheExternalAxesMove) {
  const PlanResult plan = StationPlan("both");
  const MotionProgram program = MakeMotionProgram(plan);
  ASSERT_TRUE(IsWellFormed(program));
  int moves = 0;
  for (size_t i = 1; i < program.motions.size(); ++i) {
    const Motion& motion = program.motions[i];
    if (motion.pass >= 0) {
      EXPECT_EQ(motion.external, plan.passes[static_cast<size_t>(motion.pass)].external);
    }
    if (!MovesExternal(program, i)) continue;
    ++moves;
    EXPECT_EQ(motion.type, MotionType::kJoint);
    EXPECT_EQ(motion.q, plan.home);
    EXPECT_EQ(program.motions[i - 1].q, plan.home);
    EXPECT_TRUE(motion.exact && program.motions[i - 1].exact);
  }
  EXPECT_EQ(moves, 3);
  EXPECT_EQ(program.motions.front().external, ExternalPosition({0, 0}));
  EXPECT_EQ(program.motions.back().external, ExternalPosition({0, 0}));
  // The spindle stands still meanwhile.
  std::vector<ProgramEvent::Kind> spindle;
  for (const ProgramEvent& event : program.events)
    if (event.kind == ProgramEvent::Kind::kSpindleOn || event.kind == ProgramEvent::Kind::kSpindleOff)
      spindle.push_back(event.kind);
  using enum ProgramEvent::Kind;
  EXPECT_EQ(spindle, (std::vector{kSpindleOn, kSpindleOff, kSpindleOn, kSpindleOff}));
}

TEST(StationMotions, TakeTheTimeOfTheSlowestAxis) {
  const PlanResult plan = StationPlan("rail");
  const MotionProgram program = MakeMotionProgram(plan);
  const std::vector<TimeLaw> laws = TimeMotions(program, plan.arm, {.way_speed_share = 0.5});
  for (size_t i = 1; i < laws.size(); ++i) {
    if (!MovesExternal(program, i)) continue;
    const double way = std::abs(program.motions[i].external[0] - program.motions[i - 1].external[0]);
    // 500 mm/s² up to 500 mm/s: 500 mm of ramps, so none of these ways reaches it.
    EXPECT_NEAR(laws[i].duration, 2 * std::sqrt(way / 500), 1e-12) << i;
  }
}

TEST(StationMotions, TrajectoryAndTimelineFollowRailAndTable) {
  const PlanResult plan = StationPlan("both");
  const MotionProgram program = MakeMotionProgram(plan);
  const StationPost post("krl", plan, true);
  const std::string csv =
      TrajectoryCsv(program, plan.arm, plan.X_WB, ExternalColumns(post.settings), {}, 0.05);
  EXPECT_TRUE(csv.starts_with("t_s,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,e1_mm,e2_deg,x_mm"))
      << csv.substr(0, 90);
  std::set<std::string> rails;
  for (const std::string_view line : SplitLines(csv)) {
    double v[17] = {};
    const std::string text(line);
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &v[0], &v[1], &v[2],
                    &v[3], &v[4], &v[5], &v[6], &v[7], &v[8], &v[9], &v[10], &v[11]) != 12)
      continue;
    Joints q;
    for (int k = 0; k < 6; ++k) q[k] = v[1 + k] * kRadPerDeg;
    // The base runs with the rail, the table turns the part alone.
    const Vector3d tip =
        (plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT).translation() + v[7] * Vector3d::UnitY();
    EXPECT_LT((tip - Vector3d(v[9], v[10], v[11])).norm(), 1e-3);
    rails.insert(fmt::format("{:.0f}", v[7]));
  }
  EXPECT_GT(rails.size(), 20u) << "it runs, it does not leap";

  int moving = 0;
  for (const RunInstant& instant : MakeTimeline(plan, {}, {})) {
    ASSERT_EQ(instant.external.size(), 2u);
    moving += instant.stretch == RunPart::kExternal;
    const Vector3d tip = (plan.X_WB * ForwardFlange(plan.arm, instant.q) * plan.X_FT).translation() +
                         instant.external[0] * Vector3d::UnitY();
    EXPECT_LT((tip - instant.tip).norm(), 1e-6);
  }
  EXPECT_GT(moving, 20);
}

TEST_P(Stations, WritesTheSameAgainAfterReading) {
  const MotionProgram read = Read();
  EXPECT_EQ(post.Write(read, plan.arm), files);
  if (ControllerOf(GetParam().variant) == "linuxcnc") return;  // has more motions
  ASSERT_EQ(read.motions.size(), program.motions.size());
  for (size_t i = 0; i < read.motions.size(); ++i) {
    const Motion &given = program.motions[i], &motion = read.motions[i];
    for (size_t k = 0; k < plan.external_axes.size(); ++k)
      EXPECT_NEAR(motion.external[k], given.external[k], 1e-4) << motion.line;
    if (motion.q) continue;
    const Pose wanted = *FrameOf(program, given) * given.X_PT, written = *FrameOf(read, motion) * motion.X_PT;
    EXPECT_LT((wanted.translation() - written.translation()).norm(), 0.002) << motion.line;
  }
}

Matrix3d Turn(int axis, double degrees) {
  return Eigen::AngleAxisd(degrees * kRadPerDeg, Vector3d::Unit(axis)).toRotationMatrix();
}

/// Where KUKA's frames put the tips of a text's LINs in the cell: numbers of the text and of the machine
/// data.
class KrlByHand {
 public:
  KrlByHand(const PlanResult& plan, bool coupled)
      : plan_(plan), numbers_(KrlNumbers(plan, coupled)), coupled_(coupled) {}

  std::vector<Vector3d> Tips(const std::string& text) {
    for (const std::string_view line : SplitLines(text)) Line(std::string(line));
    return tips_;
  }

 private:
  void Line(const std::string& line) {
    double v[6] = {}, e[2] = {};
    const size_t brace = line.find("{X "), frame = line.find("{FRAME: X ");
    const char* fields = "%lf,Y %lf,Z %lf,A %lf,B %lf,C %lf";
    if (line.starts_with("$BASE")) {
      const size_t at = frame != std::string::npos ? frame + 10 : brace + 3;
      if (std::sscanf(line.c_str() + at, fields, &v[0], &v[1], &v[2], &v[3], &v[4], &v[5]) != 6)
        throw std::logic_error(line);
      place_ = {v[0], v[1], v[2]};
      turn_ = Turn(2, v[3]) * Turn(1, v[4]) * Turn(0, v[5]);
      on_table_ = frame == std::string::npos;
    } else if (line.starts_with("PTP {A1")) {
      words_.clear();
    } else if (line.starts_with("LIN {") || line.starts_with("PTP {")) {
      const size_t external = line.find(",E1 ");
      for (size_t at = 5; at < std::min(external, line.find('}'));) {
        const size_t end = std::min(line.find(',', at), line.find('}', at));
        words_[line[at]] = std::atof(line.c_str() + at + 2);
        at = end + 1;
      }
      if (line.starts_with("PTP {")) return;
      ASSERT_NE(external, std::string::npos) << line;
      const int count = std::sscanf(line.c_str() + external, ",E1 %lf,E2 %lf", &e[0], &e[1]);
      ASSERT_EQ(count, static_cast<int>(plan_.external_axes.size())) << line;
      ASSERT_TRUE(words_.contains('X') && words_.contains('Y') && words_.contains('Z')) << line;
      Tip(Vector3d(words_['X'], words_['Y'], words_['Z']), e);
    }
  }

  void Tip(const Vector3d& target, const double* e) {
    const bool rail = plan_.external_axes.front().name == "rail",
               table = plan_.external_axes.size() > (rail ? 1u : 0u);
    Vector3d tip = place_ + turn_ * target;
    EXPECT_EQ(on_table_, coupled_ && table);
    if (on_table_) tip = numbers_.root + Turn(2, e[rail ? 1 : 0]) * (Vector3d(0, 0, 40) + tip);
    // $WORLD in the cell: it stands, or it rides on a rail that is not coupled.
    Vector3d world = plan_.X_WB.translation() - numbers_.ersysroot - numbers_.carriage;
    if (rail && !coupled_) world += e[0] * Vector3d::UnitY();
    tips_.push_back(world + tip);
  }

  const PlanResult& plan_;
  const KrlCellNumbers numbers_;
  const bool coupled_;
  Vector3d place_;
  Matrix3d turn_;
  bool on_table_ = false;
  std::map<char, double> words_;  // of the last pose: what a target does not name stays
  std::vector<Vector3d> tips_;
};

TEST_P(Stations, KrlPutsTheTipOnThePart) {
  if (GetParam().variant != "krl") return;
  const std::vector<Vector3d> tips = KrlByHand(plan, GetParam().coupled).Tips(Text());
  size_t k = 0;
  for (const Motion& motion : program.motions) {
    if (motion.type != MotionType::kLinear) continue;
    // Where the arm is, in the cell.
    const double rail = plan.external_axes.front().name == "rail" ? motion.external[0] : 0;
    const Vector3d tip =
        (plan.X_WB * ForwardFlange(plan.arm, *motion.q) * plan.X_FT).translation() + rail * Vector3d::UnitY();
    ASSERT_LT(k, tips.size());
    EXPECT_LT((tips[k++] - tip).norm(), 0.002);
  }
  EXPECT_EQ(k, tips.size());
}

TEST_P(Stations, AFrameIsStatedAnewWhereACoupledAxisDoesNotCarryIt) {
  const std::string& variant = GetParam().variant;
  if (variant == "linuxcnc" || variant == "linuxcnc_cartesian") return;
  size_t count = 0;
  const std::string whole = Text();
  for (const std::string_view line : SplitLines(whole))
    count += line.starts_with(variant == "krl" ? "$BASE = " : "$P_UIFR[");
  EXPECT_EQ(count, GetParam().coupled ? 1u : 3u);
}

TEST_P(Stations, TheInterpreterAccepts) {
  if (ControllerOf(GetParam().variant) != "linuxcnc") return;
  ExpectInterpreted(Text(), Read());
}

TEST(StationPosts, RefuseCellsWhoseAxesTheyDoNotName) {
  const PlanResult plan = StationPlan("both");
  StationPost post("krl", plan, true);
  EXPECT_EQ(WhyNotWithAxes(post.settings, "krl"), "");
  EXPECT_EQ(post.post->WhyNotIn(post.settings), "");
  PostSettings settings = post.settings;
  settings.controller_axes.pop_back();
  EXPECT_NE(WhyNotWithAxes(settings, "krl").find("the cell's axis 'table' is missing"), std::string::npos);
  settings.controller_axes.push_back({"E2", "tabel", {}, 0, true});
  EXPECT_NE(WhyNotWithAxes(settings, "krl").find("did you mean table?"), std::string::npos);
  settings.controller_axes.back().axis = "rail";
  EXPECT_NE(WhyNotWithAxes(settings, "krl").find("given twice"), std::string::npos);
}

TEST(StationPosts, KrlAsksForWhatACoupledAxisNeeds) {
  const PlanResult plan = StationPlan("both");
  const StationPost whole("krl", plan, true);
  const KrlOptions options = dynamic_cast<const KrlPost&>(*whole.post).options();
  const auto why = [&](const std::function<void(KrlOptions&, PostSettings&)>& change) {
    KrlOptions changed = options;
    PostSettings settings = whole.settings;
    change(changed, settings);
    return KrlPost(changed).WhyNotIn(settings);
  };
  EXPECT_EQ(why([](KrlOptions&, PostSettings&) {}), "");
  const auto contains = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  contains(why([](KrlOptions& o, PostSettings&) { o.ersysroot.reset(); }), "ersysroot: is missing");
  contains(why([](KrlOptions& o, PostSettings&) { o.external_base.reset(); }), "external_base: is missing");
  contains(why([](KrlOptions&, PostSettings& s) { s.controller_axes[0].coupled = false; }),
           "ersysroot: 0 of");
  contains(why([](KrlOptions&, PostSettings& s) { s.controller_axes[1].coupled = false; }),
           "external_base: has no effect");
  contains(why([](KrlOptions& o, PostSettings&) { o.base_number = 3; }), "base_number: one frame");
  contains(why([](KrlOptions& o, PostSettings&) { o.ersysroot->direction = FrameAxis::kMinusY; }),
           "makes 180.0 deg with direction -y");
}

}  // namespace
}  // namespace millpose
