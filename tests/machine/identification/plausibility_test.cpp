// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/plausibility.hpp"

#include "machine/identification/identify_system.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"
#include "tests/paper/paper_data.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

const IdentifyOptions kPlain{};

/// Table 2's poses under three loads each, moved as the arm's stiffness says, with 10 µm of noise.
std::vector<LoadCase> Measured(const Arm& arm) {
  IdentifyOptions unweighted;
  unweighted.displacement_deviation = 1;
  RandomStream stream(1, 0);
  std::vector<LoadCase> cases;
  for (const Joints& q : kTable2)
    for (const Vector3d& direction : {Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
      LoadCase load;
      load.q = q;
      load.force = 737.8 * direction;
      load.load_point = load.measured_point = Vector3d(200, 0, 200);
      const identify::System system = identify::MakeSystem(arm, {load}, unweighted);
      load.displacement = system.L * arm.stiffness.cwiseInverse() + 0.01 * RandomNormal3(stream);
      cases.push_back(load);
    }
  return cases;
}

Plausibility JudgeOf(const Arm& arm, const std::vector<LoadCase>& cases,
                     const IdentifyOptions& options = kPlain) {
  return JudgeIdentification(arm, cases, options, IdentifyJointStiffness(arm, cases, options));
}

/// `scale` applied to the cases of poses from `first` on (three cases each).
std::vector<LoadCase> Scaled(std::vector<LoadCase> cases, double force, double displacement, size_t first = 0,
                             size_t last = 6) {
  for (size_t i = 3 * first; i < 3 * last; ++i) {
    cases[i].force *= force;
    cases[i].displacement *= displacement;
  }
  return cases;
}

void ExpectDisbelief(const Plausibility& judged, const std::string& word) {
  EXPECT_FALSE(judged.usable) << word;
  EXPECT_TRUE(
      std::ranges::any_of(judged.findings, [&](const std::string& f) { return f.find(word) != f.npos; }))
      << word << ": " << fmt::format("{}", fmt::join(judged.findings, "; "));
}

TEST(Plausibility, GoodMeasurementsAreBelieved) {
  for (const Arm& arm : {KrQuantecR2700(), Kr500R2830()}) {
    const Plausibility judged = JudgeOf(arm, Measured(arm));
    EXPECT_TRUE(judged.usable);
    EXPECT_TRUE(judged.findings.empty()) << judged.findings.front();
    EXPECT_TRUE(judged.warnings.empty()) << judged.warnings.front();
    EXPECT_TRUE(judged.residual.starts_with("as expected from the stated deviation")) << judged.residual;
  }
}

TEST(Plausibility, MetresAndKilonewtonsAreFoundOutEvenTogether) {
  const Arm arm = KrQuantecR2700();
  const std::vector<LoadCase> good = Measured(arm);
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1, 1e-3)), "largest displacement");
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1e-3, 1)), "largest force");
  const Plausibility both = JudgeOf(arm, Scaled(good, 1e-3, 1e-3));
  ExpectDisbelief(both, "largest displacement");
  ExpectDisbelief(both, "largest force");
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1e3, 1)), "largest force");
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1, 1e3)), "largest displacement");
}

TEST(Plausibility, PosesInOtherUnitsAreNamed) {
  const Arm arm = KrQuantecR2700();
  const std::vector<LoadCase> good = Measured(arm);
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1, 1e-3, 2, 3)), "displacements under their loads of pose 3 ");
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1, 1e-3, 0, 3)),
                  "displacements under their loads of pose 1, 2, 3 ");
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1e-3, 1, 4, 6)), "forces of pose 5, 6 ");
  ExpectDisbelief(JudgeOf(arm, Scaled(good, 1e-3, 1e-3, 1, 2)), "forces of pose 2 ");
}

TEST(Plausibility, StiffnessOfNoJointIsAFinding) {
  Arm soft = KrQuantecR2700(), unusual = KrQuantecR2700();
  soft.stiffness *= 1e-6;
  unusual.stiffness[3] *= 1e-3 * 4;  // 8e3 N·m/rad
  const std::vector<LoadCase> good = Measured(KrQuantecR2700());
  ExpectDisbelief(JudgeOf(soft, Scaled(good, 1e-3, 1e3)), "is no joint's stiffness");
  const Plausibility judged = JudgeOf(unusual, Measured(unusual));
  EXPECT_TRUE(judged.usable);
  ASSERT_EQ(judged.warnings.size(), 1u);
  EXPECT_TRUE(judged.warnings[0].starts_with("A4:")) << judged.warnings[0];
}

TEST(Plausibility, AResidualFarAboveTheStatedDeviationIsAFindingWithWhatItMeans) {
  const Arm arm = KrQuantecR2700();
  IdentifyOptions certain;
  certain.displacement_deviation = 1e-4;  // stated; the noise is a hundred times that
  const Plausibility judged = JudgeOf(arm, Measured(arm), certain);
  EXPECT_TRUE(judged.usable);
  ASSERT_EQ(judged.findings.size(), 1u);
  EXPECT_NE(judged.findings[0].find("times the stated deviation of 0.0001 mm"), std::string::npos);
  EXPECT_NE(judged.findings[0].find("% of the displacements unexplained"), std::string::npos);
}

TEST(Plausibility, TwoPosesAreCounted) {
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> cases = Measured(arm);
  cases = {cases[0], cases[3]};
  const Identification found = IdentifyJointStiffness(arm, cases, {});
  EXPECT_EQ(found.poses, 2u);
  EXPECT_EQ(found.pose_of_case.size(), 2u);
}

}  // namespace
}  // namespace millpose
