// SPDX-License-Identifier: GPL-3.0-or-later
// Trims hold their feed: what each controller's cycle leaves of it where the corners of the way are rounded
// within the path tolerance, with a rotation about the tool axis that stays the same.
#include "job/workpiece.hpp"
#include "program/path_speed.hpp"
#include "program/post_entry.hpp"
#include "program/rounding.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/run/pipeline/small_job.hpp"
#include "tests/toolpath/skins.hpp"
#include "toolpath/strategies/trim.hpp"

namespace millpose::test {
namespace {

constexpr double kFeed = 10;  // mm/s

struct Trimmed {
  std::string name;
  LaidPath laid;
};

LaidPath WindowOf(const Skin& skin) {
  Trim trim;
  trim.border = TrimBorder{Eigen::Vector3d(-90, 0, 0), {}};
  trim.through = 8;
  trim.overcut = 1;
  trim.per_depth = 5;
  ToolpathOptions options;
  options.strategy = std::make_shared<Trim>(trim);
  options.cutter = {10, 0, 40};
  options.feed_rate = kFeed;
  options.plunge_feed = kFeed / 3;
  options.spacing = 25;
  options.chord_tolerance = 0.02;
  return trim.Make({SoundMesh(SkinShape(skin)), options, {}}, {});
}

std::vector<Trimmed> Trims() {
  const JobInputs inputs = LoadJobInputs(SamplePath("toolpaths/cabin_trim/job.yaml"));
  std::vector<Trimmed> trims{{"cabin_trim", {}}};
  trims[0].laid.toolpath = MakeJobToolpath(inputs, SampleMesh("cabin_panel"), {}).toolpath;
  for (const double corner : {5.0, 20.0})
    for (const double radius : {1500.0, 15000.0})
      trims.push_back({fmt::format("corners of {} mm in a skin of {} mm", corner, radius),
                       WindowOf({.form = SkinForm::kCylinder, .radius = radius, .corner = corner})});
  return trims;
}

MotionProgram StraightMotions(const Pass& pass) {
  MotionProgram program;
  for (size_t i = 0; i < pass.points.size(); ++i) {
    const MillingPoint& point = pass.points[i];
    Motion motion;
    motion.type = MotionType::kLinear;
    const Eigen::Vector3d across =
        point.tool_axis.cross(pass.rotation_reference.unitOrthogonal()).normalized();
    motion.X_PT.translation() = point.position;
    motion.X_PT.linear() << across, point.tool_axis.cross(across), point.tool_axis;
    motion.feed = point.feed_rate;
    motion.point = static_cast<int>(i);
    program.motions.push_back(motion);
  }
  return program;
}

// Whether a place lies where a finding says that a corner is left standing: within the cutter's diameter of
// it.
bool IsNamed(const LaidPath& laid, const Eigen::Vector3d& place) {
  return std::ranges::any_of(laid.findings, [&](const std::string& finding) {
    double x = 0, y = 0, z = 0;
    const size_t at = finding.find('(');
    return at != std::string::npos && std::sscanf(finding.c_str() + at, "(%lf, %lf, %lf)", &x, &y, &z) == 3 &&
           (place - Eigen::Vector3d(x, y, z)).norm() < 20;
  });
}

TEST(TrimFeed, IsHeldButAtCornersThatAreNamed) {
  ASSERT_GE(Posts().Names().size(), 3);
  for (const Trimmed& trimmed : Trims()) {
    const Pass& pass = trimmed.laid.toolpath.passes.at(0);
    MotionProgram program = StraightMotions(pass);
    ChooseRounding(program, WrittenTolerance({}));
    for (const std::string& name : Posts().Names()) {
      SCOPED_TRACE(trimmed.name + ", " + name);
      const SpeedEstimate estimate = EstimateSpeed(program, MakePost(name)->Dynamics({}));
      size_t slow = 0;
      for (const SlowPlace& place : estimate.places) {
        if (place.speed >= 0.7 * place.feed) continue;
        ++slow;
        EXPECT_TRUE(IsNamed(trimmed.laid, pass.points[place.motion].position))
            << place.speed / place.feed << " of the feed at "
            << pass.points[place.motion].position.transpose();
      }
      // A corner is slow over less than a mm before and behind it.
      EXPECT_LT(2.0 * static_cast<double>(slow), 0.05 * pass.points.back().arc_length);
    }
  }
}

}  // namespace
}  // namespace millpose::test
