// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify.hpp"

#include "machine/identification/identify_system.hpp"
#include "machine/stiffness/compliance.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"
#include "tests/paper/paper_data.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// What the model says: displacement and rotation of the measured point.
Eigen::Matrix<double, 6, 1> Predict(const Arm& arm, const LoadCase& load) {
  const Matrix6 at_load = Jacobian(arm, load.q, load.load_point);
  const Matrix6 measured = Jacobian(arm, load.q, load.measured_point);
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << load.force, load.moment;
  const Joints give = (at_load.transpose() * wrench).array() / arm.stiffness.array();
  return measured * give;
}

/// Table 2's poses under loads along four directions at a lever arm.
std::vector<LoadCase> WellPosed(const Arm& arm) {
  std::vector<LoadCase> cases;
  for (const Joints& q : kTable2) {
    for (const Vector3d& direction :
         {Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 1, -1)}) {
      LoadCase load;
      load.q = q;
      load.force = 737.8 * direction.normalized();
      load.load_point = load.measured_point = Vector3d(200, 0, 200);
      load.displacement = Predict(arm, load).head<3>();
      cases.push_back(load);
    }
  }
  return cases;
}

/// Adds noise of that standard deviation, mm, to every coordinate measured.
void AddNoise(double deviation, RandomStream& stream, std::vector<LoadCase>& cases) {
  for (LoadCase& load : cases) load.displacement += deviation * RandomNormal3(stream);
}

TEST(Identify, FindsTheStiffnessOfExactData) {
  const Arm arm = KrQuantecR2700();
  const Identification found = IdentifyJointStiffness(arm, WellPosed(arm), {});
  for (int j = 0; j < 6; ++j) {
    ASSERT_TRUE(found.joints[j].determined) << found.joints[j].reason;
    EXPECT_NEAR(found.joints[j].stiffness / arm.stiffness[j], 1, 1e-9);
  }
  EXPECT_LT(found.rms, 1e-12);
  EXPECT_LT(found.condition, 10);
  EXPECT_EQ(found.poses, 6u);
}

TEST(Identify, UsesRotationsAndWrenchesAwayFromTheMeasuredPoint) {
  const Arm arm = Kr500R2830();
  std::vector<LoadCase> cases = WellPosed(arm);
  for (LoadCase& load : cases) {
    load.measured_point = Vector3d(0, 50, 10);
    load.moment = Vector3d(1e4, -2e4, 3e4);
    const Eigen::Matrix<double, 6, 1> moved = Predict(arm, load);
    load.displacement = moved.head<3>();
    load.rotation = moved.tail<3>();
  }
  const Identification found = IdentifyJointStiffness(arm, cases, {});
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(found.joints[j].stiffness / arm.stiffness[j], 1, 1e-9);
}

TEST(Identify, NinetyFivePercentIntervalsHoldTheTruth) {
  const Arm arm = KrQuantecR2700();
  const std::vector<LoadCase> exact = WellPosed(arm);
  RandomStream stream(1, 0);
  const int runs = 1000;
  std::array<int, 6> inside{};
  for (int run = 0; run < runs; ++run) {
    std::vector<LoadCase> noisy = exact;
    for (LoadCase& load : noisy) load.displacement += 0.01 * RandomNormal3(stream);
    const Identification found = IdentifyJointStiffness(arm, noisy, {});
    for (int j = 0; j < 6; ++j)
      inside[j] += found.joints[j].lower <= arm.stiffness[j] && arm.stiffness[j] <= found.joints[j].upper;
    if (run == 0) {
      EXPECT_NEAR(found.level, 1, 0.3);
    }
  }
  for (int j = 0; j < 6; ++j) {
    EXPECT_GE(inside[j], 0.92 * runs) << j;
    EXPECT_LE(inside[j], 0.98 * runs) << j;
  }
}

TEST(Identify, RefusesNumbersForJointsThatVerticalLoadsAtTheFlangeDoNotReach) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> cases;
  for (const Joints& q : kTable2) {
    LoadCase load;
    load.q = q;
    load.force = Vector3d(0, 0, -737.8);
    load.displacement = Predict(arm, load).head<3>();
    cases.push_back(load);
  }
  const Identification found = IdentifyJointStiffness(arm, cases, {});
  for (int j = 0; j < 6; ++j) {
    const bool blind = j == 0 || j == 5;
    EXPECT_EQ(found.joints[j].determined, !blind) << j << found.joints[j].reason;
    if (blind) {
      EXPECT_EQ(found.joints[j].reason,
                "not observable: no load case puts a torque on it that moves the measured point");
      EXPECT_EQ(found.joints[j].stiffness, 0);
    } else {
      EXPECT_NEAR(found.joints[j].stiffness / arm.stiffness[j], 1, 1e-9);
    }
  }
}

TEST(Identify, RefusesAJointWhoseTorqueIsRoundingAlone) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> cases = WellPosed(arm);
  for (LoadCase& load : cases) {
    load.load_point = load.measured_point = Vector3d(0, 0, 123.4);  // on axis 6: no lever about it
    load.displacement = Predict(arm, load).head<3>();
  }
  const Identification found = IdentifyJointStiffness(arm, cases, {});
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(found.joints[j].stiffness / arm.stiffness[j], 1, 1e-9) << j;
  EXPECT_FALSE(found.joints[5].determined);
  EXPECT_TRUE(found.joints[5].reason.starts_with("not observable: no load case")) << found.joints[5].reason;
}

TEST(Identify, FewNumbersWidenTheIntervalAndCountAgainstTheLevel) {
  // 9 measured numbers, 6 unknown: Student's t for 3 degrees of freedom is 3.182, not 1.96.
  const Arm arm = KrQuantecR2700();
  const std::vector<LoadCase> all = WellPosed(arm);
  RandomStream stream(9, 0);
  double square = 0;
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<LoadCase> cases{all[0], all[5], all[10]};
    AddNoise(1e-5, stream, cases);
    const Identification found = IdentifyJointStiffness(arm, cases, {});
    square += found.level * found.level / kRuns;
    for (const JointEstimate& joint : found.joints) {
      ASSERT_TRUE(joint.determined) << joint.reason;
      const double c = 1 / joint.stiffness;
      EXPECT_NEAR((1 / joint.lower - c) / (joint.deviation * c * c), 3.182, 0.06);
    }
  }
  EXPECT_NEAR(std::sqrt(square), 1e-5 / IdentifyOptions{}.displacement_deviation, 1e-4);
}

TEST(Identify, NamesJointsThatOnlyShowTogether) {
  // With A5 = 0 in every pose, axes 4 and 6 are one line.
  const Arm arm = Kr500R2830();
  std::vector<LoadCase> cases = WellPosed(arm);
  for (LoadCase& load : cases) {
    load.q[4] = 0;
    load.displacement = Predict(arm, load).head<3>();
  }
  const Identification found = IdentifyJointStiffness(arm, cases, {});
  for (const int j : {3, 5})
    EXPECT_EQ(found.joints[j].reason, "not observable: its effect is a combination of other joints'");
  for (const int j : {0, 1, 2, 4}) EXPECT_TRUE(found.joints[j].determined);
}

TEST(Identify, NeverGivesANegativeStiffness) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> cases = WellPosed(arm);
  RandomStream stream(2, 0);
  int refused = 0;
  for (int run = 0; run < 50; ++run) {
    for (LoadCase& load : cases)  // noise as large as the deflections themselves
      load.displacement = Predict(arm, load).head<3>() + 0.5 * RandomNormal3(stream);
    const Identification found = IdentifyJointStiffness(arm, cases, {});
    for (const JointEstimate& joint : found.joints) {
      if (joint.determined) {
        EXPECT_GT(joint.stiffness, 0);
        continue;
      }
      ++refused;
      EXPECT_EQ(joint.reason, "not determined: the data put its compliance at 0 or below");
      EXPECT_GT(joint.lower, 0);
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(Identify, HuberShrugsOffABlunder) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> cases = WellPosed(arm);
  RandomStream stream(3, 0);
  AddNoise(0.005, stream, cases);
  cases[9].displacement += Vector3d(3, -2, 4);
  IdentifyOptions robust;
  robust.robust = true;
  const Identification plain = IdentifyJointStiffness(arm, cases, {}),
                       huber = IdentifyJointStiffness(arm, cases, robust);
  double plain_error = 0, huber_error = 0;
  for (int j = 0; j < 6; ++j) {
    plain_error = std::max(plain_error, std::abs(plain.joints[j].stiffness / arm.stiffness[j] - 1));
    huber_error = std::max(huber_error, std::abs(huber.joints[j].stiffness / arm.stiffness[j] - 1));
  }
  EXPECT_GT(plain_error, 3 * huber_error);
  EXPECT_LT(huber_error, 0.2);
  // The blunder's pose has the largest residual.
  EXPECT_EQ(std::max_element(huber.residuals.begin(), huber.residuals.end()) - huber.residuals.begin(), 9);
  EXPECT_EQ(huber.pose_of_case[9], 2u);
}

TEST(Propose, FewCasesMakeAllJointsObservable) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> candidates = WellPosed(arm);
  for (LoadCase& load : candidates) load.displacement.setZero();
  const std::vector<size_t> few = ProposeLoadCases(arm, candidates, 0, {});
  ASSERT_GE(few.size(), 2u);
  ASSERT_LE(few.size(), 4u);
  const std::vector<size_t> six = ProposeLoadCases(arm, candidates, 6, {});
  ASSERT_EQ(six.size(), 6u);
  EXPECT_TRUE(std::is_sorted(six.begin(), six.end()));
  // Better than every run of six candidates taken as they come, by the determinant of what they tell.
  const auto condition = [&](const std::vector<size_t>& chosen) {
    std::vector<LoadCase> cases;
    for (const size_t i : chosen) cases.push_back(candidates[i]);
    return IdentifyJointStiffness(arm, cases, {}).condition;
  };
  EXPECT_LT(condition(six), condition({0, 1, 2, 3, 4, 5}));
  EXPECT_LT(condition(six), condition({18, 19, 20, 21, 22, 23}));
}

TEST(Identify, SaysWhichPoseChangesAJointMostWhenLeftOut) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> cases = WellPosed(arm);
  RandomStream stream(10, 0);
  AddNoise(0.01, stream, cases);
  const Identification found = IdentifyJointStiffness(arm, cases, {});
  std::array<double, 6> largest{};
  std::array<size_t, 6> most{};
  for (size_t pose = 0; pose < 6; ++pose) {
    std::vector<LoadCase> rest;
    for (const LoadCase& load : cases)
      if (load.q != kTable2[pose]) rest.push_back(load);
    const Identification without = IdentifyJointStiffness(arm, rest, {});
    for (int j = 0; j < 6; ++j) {
      const double change = std::abs(without.joints[j].stiffness / found.joints[j].stiffness - 1);
      if (change > largest[j]) {
        largest[j] = change;
        most[j] = pose;
      }
    }
  }
  for (int j = 0; j < 6; ++j) {
    EXPECT_NEAR(found.joints[j].largest_change / largest[j], 1, 1e-6);
    EXPECT_EQ(found.joints[j].most_influential, most[j]);
  }
}

TEST(Propose, NoExchangeOfOneCandidateTellsMore) {
  const Arm arm = KrQuantecR2700();
  RandomStream stream(11, 0);
  for (int run = 0; run < 10; ++run) {
    std::vector<LoadCase> candidates(25);
    for (LoadCase& load : candidates) {
      load.q = RandomJoints(stream);
      load.force = 700 * RandomUnit(stream);
      load.load_point = load.measured_point = Vector3d(200, 0, 200);
    }
    const auto information = [&](const std::vector<size_t>& chosen) {
      std::vector<LoadCase> cases;
      for (const size_t i : chosen) cases.push_back(candidates[i]);
      const auto L = identify::MakeSystem(arm, cases, {}).L;
      return (L.transpose() * L).determinant();
    };
    const std::vector<size_t> chosen = ProposeLoadCases(arm, candidates, 4, {});
    ASSERT_EQ(chosen.size(), 4u);
    const double best = information(chosen);
    for (size_t slot = 0; slot < 4; ++slot) {
      for (size_t i = 0; i < candidates.size(); ++i) {
        std::vector<size_t> other = chosen;
        other[slot] = i;
        if (std::count(chosen.begin(), chosen.end(), i) == 0) {
          EXPECT_LE(information(other), best * (1 + 1e-6));
        }
      }
    }
  }
}

}  // namespace
}  // namespace millpose
