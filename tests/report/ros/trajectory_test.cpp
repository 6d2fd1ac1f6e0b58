// SPDX-License-Identifier: GPL-3.0-or-later
// The run of a program as instants joined by cubics, against the time law that it comes from.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <set>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"
#include "report/ros/trajectory_files.hpp"
#include "tests/program/sample_plan.hpp"
#include "tests/program/station_plan.hpp"

namespace millpose {
namespace {

using Instants = std::vector<TrajectoryInstant>;
constexpr double kTolerance = 0.02;  // mm

struct TimedProgram {
  std::string name;
  PlanResult plan;
  MotionProgram program;
  TimeOptions times;
};

std::vector<TimedProgram> Programs() {
  std::vector<TimedProgram> programs;
  const auto add = [&](const std::string& name, PlanResult plan, const MotionOptions& options,
                       const TimeOptions& times) {
    MotionProgram program = MakeMotionProgram(plan, options);
    programs.push_back({name, std::move(plan), std::move(program), times});
  };
  add("passes and a ring", SamplePlan(), SampleFeeds(), {});
  add("half speed", SamplePlan({.tilt_deg = 20}), SampleFeeds(),
      {.way_speed_share = 0.5, .orientation_speed = 0.5});
  add("dwells", SamplePlan({.points = 3, .spacing = 30}), SampleFeeds(), {});
  MotionProgram& waits = programs.back().program;
  for (size_t i = waits.motions.size(); i-- > 1;)  // at the ends of cuts
    if (waits.motions[i].exact && waits.motions[i].point >= 0) {
      ProgramEvent wait{};
      wait.kind = ProgramEvent::Kind::kDwell, wait.before_motion = i + 1, wait.value = 0.75;
      waits.events.insert(std::ranges::upper_bound(waits.events, i + 1, {}, &ProgramEvent::before_motion),
                          wait);
    }
  for (const char* axes : {"rail", "table", "both"}) {
    add(std::string("stations of ") + axes, StationPlan(axes), SampleFeeds(), {});
    add(std::string("rides on ") + axes, RidePlan(axes), SampleFeeds(), {});
  }
  return programs;
}

/// Where the law has all axes at a time, and the tip on the part.
struct OnLaw {
  explicit OnLaw(const TimedProgram& timed)
      : of(timed), laws(TimeMotions(of.program, of.plan.arm, of.times)), dwells(Dwells(of.program)) {}

  std::pair<size_t, double> ShareAt(double time) const {
    double start = 0;
    for (size_t i = 0; i < laws.size(); ++i) {
      const double end = start + laws[i].duration;
      if (time < end) return {i, laws[i].Share(time - start)};
      start = end + dwells[i];
      if (time < start) return {i, 1};
    }
    return {laws.size() - 1, 1};
  }
  Joints JointsAt(double time) const {
    const auto [i, share] = ShareAt(time);
    return JointsOf(of.program, of.plan.arm, i, share);
  }
  ExternalPosition ExternalsAt(double time) const {
    const auto [i, share] = ShareAt(time);
    return ExternalOf(of.program, i, share);
  }
  double End() const {
    double end = 0;
    for (size_t i = 0; i < laws.size(); ++i) end += laws[i].duration + dwells[i];
    return end;
  }

  const TimedProgram& of;  // which outlives this
  std::vector<TimeLaw> laws;
  std::vector<double> dwells;
};

Eigen::Vector3d TipOnPart(const TimedProgram& of, const Joints& q, const ExternalPosition& external) {
  const Pose X_WB = external.empty() ? of.plan.X_WB : BaseFromPartAtZero(of.plan, external);
  return X_WB * ForwardFlange(of.plan.arm, q) * of.plan.X_FT.translation();
}
Eigen::Vector3d TipOnPart(const TimedProgram& of, const Eigen::VectorXd& position) {
  return TipOnPart(of, position.head<6>(), ExternalPosition(position.begin() + 6, position.end()));
}

TEST(RosTrajectory, RunsFromRestAtHomeToRestAtHomeInTheProgramsTime) {
  for (const TimedProgram& of : Programs()) {
    const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
    ASSERT_GT(run.size(), 10u);
    EXPECT_EQ(run.front().time, 0);
    EXPECT_NEAR(run.back().time, OnLaw(of).End(), 1e-9) << of.name;
    for (const TrajectoryInstant* end : {&run.front(), &run.back()}) {
      EXPECT_TRUE(end->rate.isZero(0)) << of.name;
      EXPECT_EQ(Joints(end->position.head<6>()), of.plan.home);
    }
    for (size_t i = 1; i < run.size(); ++i)
      ASSERT_GT(std::llround(run[i].time * 1e9), std::llround(run[i - 1].time * 1e9)) << of.name << " " << i;
  }
}

TEST(RosTrajectory, EveryInstantStandsOnTheLawAndEveryPlannedPointIsOne) {
  for (const TimedProgram& of : Programs()) {
    const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
    const OnLaw law(of);
    for (const TrajectoryInstant& at : run) {
      ASSERT_LT((at.position.head<6>() - law.JointsAt(at.time)).cwiseAbs().maxCoeff(), 1e-8)
          << of.name << " " << at.time;
      const ExternalPosition external = law.ExternalsAt(at.time);
      ASSERT_EQ(external.size() + 6, static_cast<size_t>(at.position.size()));
      for (size_t k = 0; k < external.size(); ++k)
        ASSERT_NEAR(at.position[6 + static_cast<Eigen::Index>(k)], external[k], 1e-6) << of.name;
    }
    size_t points = 0;
    for (const PassResult& pass : of.plan.passes)
      for (size_t k = 0; k < pass.points.size(); ++k) {
        const PlannedPoint& point = pass.points[k];
        const bool there = std::ranges::any_of(run, [&](const TrajectoryInstant& at) {
          const Motion& motion = of.program.motions[at.motion];
          return at.at_end && motion.pass == pass.pass && motion.point == static_cast<int>(k) &&
                 (at.position.head<6>() - point.q).cwiseAbs().maxCoeff() < 1e-12;
        });
        EXPECT_TRUE(there) << of.name << " " << pass.pass << " " << k;
        points += there;
      }
    EXPECT_GT(points, 7u);
  }
}

// What a controller makes of it: the tip leaves the program's path, at the time when it should be there, by
// no more than the tolerance; joint motions are met exactly.
TEST(RosTrajectory, CubicsBetweenStayOnThePath) {
  double largest = 0;
  for (const TimedProgram& of : Programs())
    for (const double tolerance : {kTolerance, 0.3}) {
      const Instants run = SampleRun(of.program, of.plan.arm, of.times, tolerance);
      const OnLaw law(of);
      for (size_t i = 1; i < run.size(); ++i)
        for (int k = 1; k < 10; ++k) {
          const double time = run[i - 1].time + (run[i].time - run[i - 1].time) * k / 10;
          const Eigen::VectorXd between = PositionBetween(run[i - 1], run[i], time);
          const double off =
              (TipOnPart(of, between) - TipOnPart(of, law.JointsAt(time), law.ExternalsAt(time))).norm();
          ASSERT_LT(off, tolerance) << of.name << " at " << time;
          if (of.program.motions[run[i].motion].type == MotionType::kJoint) {
            ASSERT_LT(off, 1e-6) << of.name << " at " << time;
          }
          if (tolerance > kTolerance) largest = std::max(largest, off);
        }
      // No more instants than that takes.
      EXPECT_LT(run.size(), 40 * of.program.motions.size()) << of.name;
    }
  EXPECT_GT(largest, 0.02);  // a larger tolerance is used
}

TEST(RosTrajectory, RatesAreTheDifferencesOfPositions) {
  for (const TimedProgram& of : Programs()) {
    const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
    const OnLaw law(of);
    size_t looked = 0;
    for (size_t i = 1; i + 1 < run.size(); ++i) {
      // Within a motion: by the law on both sides. At corners rates jump in it.
      if (run[i].at_end || run[i + 1].motion != run[i].motion || run[i - 1].motion != run[i].motion) continue;
      constexpr double kStep = 1e-6;
      const Joints rate =
          (law.JointsAt(run[i].time + kStep) - law.JointsAt(run[i].time - kStep)) / (2 * kStep);
      EXPECT_LT((rate - run[i].rate.head<6>()).cwiseAbs().maxCoeff(), 1e-4) << of.name << " " << run[i].time;
      ++looked;
    }
    EXPECT_GT(looked, 4u) << of.name;
    for (size_t i = 1; i < run.size(); ++i) {  // everywhere: by the cubic, from both sides
      const double h = 1e-4 * (run[i].time - run[i - 1].time);
      const Eigen::VectorXd end =
          (run[i].position - PositionBetween(run[i - 1], run[i], run[i].time - h)) / h;
      EXPECT_LT((end - run[i].rate).cwiseAbs().maxCoeff(),
                1e-3 * (1 + run[i].rate.cwiseAbs().maxCoeff() + run[i - 1].rate.cwiseAbs().maxCoeff()));
    }
  }
}

TEST(RosTrajectory, StopsWhereTheProgramStops) {
  for (const TimedProgram& of : Programs()) {
    const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
    const std::vector<double> dwells = Dwells(of.program);
    size_t stops = 0, waits = 0, passed = 0;
    if (of.name == "dwells") {
      EXPECT_GT(std::ranges::max(dwells), 0);
    }
    for (size_t i = 0; i < run.size(); ++i) {
      if (!run[i].at_end) continue;
      const bool still = run[i].rate.isZero(1e-12);
      if (of.program.motions[run[i].motion].exact || dwells[run[i].motion] > 0) {
        EXPECT_TRUE(still) << of.name << " " << run[i].time;
        ++stops;
      } else {
        passed += !still;
      }
      if (i > 0 && run[i].position == run[i - 1].position) {
        EXPECT_NEAR(run[i].time - run[i - 1].time, dwells[run[i].motion], 1e-9);
        ++waits;
      }
    }
    EXPECT_GT(stops, 5u) << of.name;
    EXPECT_GT(passed, 3u) << of.name;
    EXPECT_EQ(waits, static_cast<size_t>(std::ranges::count_if(dwells, [](double s) { return s > 0; })))
        << of.name;
  }
}

TEST(RosTrajectory, KeepsLimitsAndSaysWhereItCannot) {
  for (const TimedProgram& of : Programs()) {
    const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
    EXPECT_TRUE(BeyondLimits(run, of.program, of.plan.arm).empty()) << of.name;
    const RunLoads loads = LoadsOf(run, of.plan.arm, of.plan.external_axes);
    EXPECT_LE(loads.speed.share, 1 + 1e-9) << of.name;
    EXPECT_GT(loads.speed.share, 0.1) << of.name;
    // Ways between cuts speed up as fast as they may.
    EXPECT_GT(loads.acceleration.share, 1 - 1e-6) << of.name;
  }
  TimedProgram of = Programs().front();
  for (Motion& motion : of.program.motions)
    if (motion.feed > 0) motion.feed = 20000;
  std::vector<std::string> beyond =
      BeyondLimits(SampleRun(of.program, of.plan.arm, of.times, kTolerance), of.program, of.plan.arm);
  ASSERT_FALSE(beyond.empty());
  EXPECT_NE(beyond.front().find("would have to go at"), std::string::npos) << beyond.front();
  EXPECT_NE(beyond.front().find("pass"), std::string::npos) << beyond.front();

  of = Programs().front();
  Arm narrow = of.plan.arm;
  const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
  const auto third = [](const TrajectoryInstant& at) { return at.position[2]; };
  narrow.upper[2] = third(*std::ranges::max_element(run, {}, third)) - 0.001;
  CoupledLimit limit;
  limit.factors << 0, 1, 1, 0, 0, 0;
  limit.at_most = -0.4;
  narrow.coupled_limits = {limit};
  beyond = BeyondLimits(run, of.program, narrow);
  ASSERT_EQ(beyond.size(), 2u);
  EXPECT_NE((beyond[0] + beyond[1]).find("A3 stands at"), std::string::npos);
  EXPECT_NE((beyond[0] + beyond[1]).find("A2 + A3 ="), std::string::npos);
}

RosNames NamesOf(const PlanResult& plan) {
  Cell cell;
  cell.external_axes = plan.external_axes;
  return NamesFor(cell);
}

TEST(RosTrajectory, YamlIsTheMessageAndCsvTheSame) {
  for (const TimedProgram& of : Programs()) {
    const Instants run = SampleRun(of.program, of.plan.arm, of.times, kTolerance);
    const RosNames names = NamesOf(of.plan);
    const std::string text = TrajectoryYaml(run, of.plan.external_axes, names, {"one", "two"});
    EXPECT_TRUE(text.starts_with("# one\n# two\nheader:")) << text.substr(0, 40);
    const YAML::Node message = YAML::Load(text);
    EXPECT_EQ(message.size(), 3u);
    EXPECT_EQ(message["header"]["frame_id"].as<std::string>(), "world");
    EXPECT_EQ(message["joint_names"].as<std::vector<std::string>>(), names.joints);
    ASSERT_EQ(message["points"].size(), run.size());
    const std::string csv = TrajectoryTable(run, of.plan, of.program, names);
    std::vector<std::string> lines;
    for (size_t at = 0, end = 0; (end = csv.find('\n', at)) != std::string::npos; at = end + 1)
      lines.push_back(csv.substr(at, end - at));
    ASSERT_EQ(lines.size(), run.size() + 1);
    std::set<std::string> parts;
    for (size_t i = 0; i < run.size(); ++i) {
      const YAML::Node point = message["points"][i];
      const auto positions = point["positions"].as<std::vector<double>>(),
                 velocities = point["velocities"].as<std::vector<double>>();
      ASSERT_EQ(positions.size(), names.joints.size());
      ASSERT_EQ(velocities.size(), names.joints.size());
      for (size_t k = 0; k < positions.size(); ++k) {
        const double unit = k >= 6 && of.plan.external_axes[k - 6].kind == AxisKind::kLinear ? 1000 : 1;
        EXPECT_DOUBLE_EQ(positions[k] * unit, run[i].position[static_cast<Eigen::Index>(k)]);
        EXPECT_DOUBLE_EQ(velocities[k] * unit, run[i].rate[static_cast<Eigen::Index>(k)]);
      }
      const auto nanoseconds = point["time_from_start"]["nanosec"].as<long long>();
      EXPECT_GE(nanoseconds, 0);
      EXPECT_LT(nanoseconds, 1'000'000'000);
      EXPECT_EQ(point["time_from_start"]["sec"].as<long long>() * 1'000'000'000 + nanoseconds,
                std::llround(run[i].time * 1e9));
      std::vector<std::string> cells{""};
      for (const char c : lines[i + 1]) c == ',' ? cells.emplace_back() : cells.back() += c, void();
      ASSERT_EQ(cells.size(), 1 + 2 * names.joints.size() + 3) << lines[i + 1];
      EXPECT_NEAR(std::stod(cells[0]), run[i].time, 1e-9);
      for (size_t k = 0; k < positions.size(); ++k) {
        EXPECT_EQ(std::stod(cells[1 + k]), positions[k]);
        EXPECT_EQ(std::stod(cells[1 + positions.size() + k]), velocities[k]);
      }
      parts.insert(cells[cells.size() - 3]);
    }
    for (const char* part : {"way", "approach", "cut", "retract"})
      EXPECT_TRUE(parts.contains(part)) << of.name << " " << part;
    EXPECT_EQ(parts.contains("external"), of.name.starts_with("stations") || of.name.starts_with("rides"))
        << of.name;
  }
}

TEST(RosTrajectory, ColumnsNameTheirUnits) {
  const PlanResult plan = StationPlan("both");
  const std::string csv = TrajectoryTable({}, plan, MakeMotionProgram(plan, SampleFeeds()), NamesOf(plan));
  EXPECT_EQ(csv,
            "t_s,joint_1_rad,joint_2_rad,joint_3_rad,joint_4_rad,joint_5_rad,joint_6_rad,rail_m,table_rad,"
            "joint_1_rad_s,"
            "joint_2_rad_s,joint_3_rad_s,joint_4_rad_s,joint_5_rad_s,joint_6_rad_s,rail_m_s,table_rad_s,part,"
            "pass,point\n");
}

}  // namespace
}  // namespace millpose
