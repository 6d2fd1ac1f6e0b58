// SPDX-License-Identifier: GPL-3.0-or-later
// Every damage that changes motion, timing or outputs is caught with its line; harmless edits pass.
#include "tests/verify/damage.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "tests/verify/sample_cell.hpp"

namespace millpose {
namespace {

class DamagedProgram : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Post> post = MakePost(GetParam());
  PostSettings settings = SampleSettings(GetParam());
  PlanResult plan = SamplePlan({.wall_turn_deg = -75, .wall_yaw_deg = 12, .tilt_deg = 7});
  MotionProgram program = MakeMotionProgram(plan);
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);
  ProgramFiles files = post->Write(program, plan.arm, settings);
  std::string name = files.rbegin()->first;  // .src comes after .dat
  std::string text = files.rbegin()->second;

  bool Applies(const TextEdit& edit) const {
    const char letter = GetParam() == "krl" ? 'K' : GetParam() == "sinumerik" ? 'S' : 'L';
    return edit.controllers.find(letter) != std::string::npos;
  }

  MotionProgram Read(const std::string& edited) const {
    ProgramFiles other = files;
    other[name] = edited;
    return post->Read(other, plan.arm, settings);
  }

  /// The first line that differs from the written text.
  int FirstChange(const std::string& edited) const {
    int line = 1;
    for (size_t i = 0; i < std::min(text.size(), edited.size()) && text[i] == edited[i]; ++i) {
      if (text[i] == '\n') ++line;
    }
    return line;
  }
};
INSTANTIATE_TEST_SUITE_P(Controllers, DamagedProgram, testing::Values("krl", "sinumerik", "linuxcnc"),
                         [](const auto& controller) { return controller.param; });

/// The targets of a program's motions with feed, as tool poses in the base.
std::vector<Pose> Places(const MotionProgram& program, const PlanResult& plan) {
  std::vector<Pose> places;
  for (const Motion& motion : program.motions) {
    places.push_back(motion.q ? ForwardFlange(plan.arm, *motion.q) * program.X_FT.value_or(plan.X_FT)
                              : program.X_BP.value() * motion.X_PT);
  }
  return places;
}

/// Whether every place of `a` lies on one of the straight lines between places of `b`.
bool Covers(const std::vector<Pose>& b, const std::vector<Pose>& a) {
  return std::all_of(a.begin(), a.end(), [&](const Pose& pose) {
    for (size_t i = 1; i < b.size(); ++i) {
      const Eigen::Vector3d from = b[i - 1].translation(), along = b[i].translation() - from;
      const double squared = along.squaredNorm();
      const double s =
          squared > 0 ? std::clamp((pose.translation() - from).dot(along) / squared, 0.0, 1.0) : 0.0;
      const Eigen::Quaterniond first(b[i - 1].linear()), last(b[i].linear());
      const bool near = (from + s * along - pose.translation()).norm() < 0.02;
      if (near && AngleBetween(first.slerp(s, last).toRotationMatrix(), pose.linear()) < 0.02 * kRadPerDeg)
        return true;
    }
    return false;
  });
}

/// Whether two programs take the same way with the same events, seen without any replay.
bool SameMotions(const MotionProgram& a, const MotionProgram& b, const PlanResult& plan) {
  if (a.motions.size() != b.motions.size()) return false;
  const std::vector<Pose> places = Places(a, plan), others = Places(b, plan);
  for (size_t i = 0; i < a.motions.size(); ++i) {
    const Motion &x = a.motions[i], &y = b.motions[i];
    if (x.type != y.type || x.exact != y.exact || x.q.has_value() != y.q.has_value()) return false;
    if (x.q && (*x.q - *y.q).cwiseAbs().maxCoeff() > 1e-3) return false;
    if (y.feed > x.feed * 1.001 || y.feed < x.feed * 0.5) return false;
    if (y.duration > x.duration * 2 || y.duration < x.duration * 0.999) return false;
  }
  return Covers(places, others) && Covers(others, places);
}

TEST_P(DamagedProgram, IsCaughtWithItsLine) {
  const MotionProgram written = Read(text);
  int kinds = 0;
  for (const TextEdit& damage : Damages()) {
    if (!Applies(damage)) continue;
    const std::optional<std::string> edited = damage.apply(text);
    EXPECT_TRUE(edited) << damage.name << " edits nothing";
    if (!edited) continue;
    ++kinds;
    try {
      const MotionProgram read = Read(*edited);
      const std::vector<Finding> findings = Verify(read, world, &program, options, 2, {});
      if (findings.empty()) {
        EXPECT_TRUE(SameMotions(written, read, plan)) << damage.name << " is not caught";
        continue;
      }
      for (const Finding& finding : findings) {
        EXPECT_EQ(finding.file, name) << damage.name;
        EXPECT_GT(finding.line, 0) << damage.name << ": " << finding.message;
      }
      // Said where it is, or where it first shows: not before the motion that leads to the changed line.
      EXPECT_GE(findings.front().line, FirstChange(*edited) - 4)
          << damage.name << ": " << findings.front().message;
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0) << damage.name;
    }
  }
  EXPECT_GE(kinds, 40);
}

TEST_P(DamagedProgram, HarmlessEditsPass) {
  int kinds = 0;
  for (const TextEdit& edit : HarmlessEdits()) {
    if (!Applies(edit)) continue;
    const std::optional<std::string> edited = edit.apply(text);
    ASSERT_TRUE(edited) << edit.name;
    ++kinds;
    try {
      for (const Finding& finding : Verify(Read(*edited), world, &program, options, 2, {})) {
        ADD_FAILURE() << edit.name << ": " << finding.line << ": " << finding.message;
      }
    } catch (const InputError& error) {
      ADD_FAILURE() << edit.name << ": " << error.what();
    }
  }
  EXPECT_GE(kinds, 10);
}

}  // namespace
}  // namespace millpose
