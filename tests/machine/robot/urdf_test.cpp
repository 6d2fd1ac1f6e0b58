// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/urdf.hpp"

#include <ctime>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "machine/robot/joint_chain.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/robot/urdf_text.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The same joints for Orocos KDL, in metres.
KDL::Chain KdlChain(const Spec& spec) {
  const auto frame = [](const Vector3d& xyz, const Vector3d& rpy) {
    return KDL::Frame(KDL::Rotation::RPY(rpy[0], rpy[1], rpy[2]), KDL::Vector(xyz[0], xyz[1], xyz[2]));
  };
  KDL::Chain chain;
  for (const SpecJoint& joint : spec.joints) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(joint.xyz, joint.rpy)));
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Vector::Zero(), KDL::Vector(joint.axis[0], joint.axis[1], joint.axis[2]),
                                KDL::Joint::RotAxis),
                     KDL::Frame::Identity()));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(spec.flange_xyz, spec.flange_rpy)));
  return chain;
}

Vector3d RollPitchYaw(const Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
          std::atan2(R(1, 0), R(0, 0))};
}

Matrix3d RandomRotation(RandomStream& random) {
  return Eigen::Quaterniond{random.Normal(), random.Normal(), random.Normal(), random.Normal()}
      .normalized()
      .toRotationMatrix();
}

/// Joints that move as `arm` does, with frames turned and shifted along their axes at random, on a base S and
/// with a flange E that are not the arm's. `miss`: axis 6 moved aside by that much, mm.
Spec TurnedAbout(const Arm& arm, RandomStream& random, double miss = 0) {
  constexpr std::array<int, 6> kColumn{2, 1, 1, 0, 1, 2};
  Pose X_SB = Pose::Identity();
  X_SB.linear() = RandomRotation(random);
  X_SB.translation() = 300 * Vector3d{random.Normal(), random.Normal(), random.Normal()};
  const std::array<Pose, 7> frames = LinkFrames(arm, Joints::Zero());
  Spec spec;
  Pose before = Pose::Identity();
  Vector3d aside = Vector3d::Zero();
  for (int i = 0; i < 6; ++i) {
    Pose X_SL = X_SB * frames[i + 1];
    const Vector3d axis = arm.sign[i] * X_SL.linear().col(kColumn[i]);
    if (i == 5) aside += miss * axis.cross((X_SB * frames[5]).linear().col(1));
    X_SL.translation() += aside + random.Uniform(-400, 400) * axis;
    X_SL.linear() = RandomRotation(random);
    const Pose step = before.inverse() * X_SL;
    spec.joints[i] = {step.translation() / 1000, RollPitchYaw(step.linear()),
                      X_SL.linear().transpose() * axis};
    before = X_SL;
  }
  Pose X_SE = X_SB * frames[6];
  X_SE.translation() += 100 * Vector3d{random.Normal(), random.Normal(), random.Normal()};
  X_SE.linear() = RandomRotation(random);
  const Pose step = before.inverse() * X_SE;
  spec.flange_xyz = step.translation() / 1000;
  spec.flange_rpy = RollPitchYaw(step.linear());
  return spec;
}

Arm RandomArm(RandomStream& random) {
  std::array<double, 6> sign;
  for (double& s : sign) s = random.Uniform(-1, 1) < 0 ? -1 : 1;
  const std::array<double, 6> lengths{random.Uniform(-200, 900), random.Uniform(-300, 500),
                                      random.Uniform(300, 1300), random.Uniform(-900, 1000),
                                      random.Uniform(-300, 300), random.Uniform(-200, 300)};
  Arm arm = MakeArm("random", lengths[0], lengths[1], lengths[2], lengths[3], lengths[4], lengths[5], sign);
  for (double& offset : arm.offset) offset = random.Uniform(-kPi, kPi);
  return arm;
}

/// A random arm whose wrist lies beside axis 1, every second one with parallel axes.
Arm RandomArmBeside(int k, RandomStream& random) {
  Arm arm = RandomArm(random);
  arm.dy = random.Uniform(-200, 200);
  if (k % 2 == 0) return arm;
  arm.family = ArmFamily::kParallelAxes;
  arm.dz = 0;
  arm.d5 = random.Uniform(-200, 200);
  return arm;
}

std::string ErrorOf(const std::string& urdf, const std::string& base = "l0",
                    const std::string& flange = "l7") {
  return RefusalOf(
      [&] { DeriveArm(FindChain(ReadUrdf(urdf, "own.urdf"), base, flange).chain, 0.01, "own.urdf"); });
}

/// Compares with KDL in mm and checks that the closed-form inverse leads back.
void ExpectSame(const Spec& spec, const DerivedArm& derived, RandomStream& random, int poses) {
  const KDL::Chain chain = KdlChain(spec);
  KDL::ChainFkSolverPos_recursive forward(chain);
  for (int k = 0; k < poses; ++k) {
    const Joints angles = RandomJoints(random);
    KDL::JntArray q(6);
    q.data = angles;
    KDL::Frame frame;
    ASSERT_EQ(forward.JntToCart(q, frame), 0);
    const Pose X_BF = ForwardFlange(derived.arm, angles);
    const Pose X_SE = derived.X_SB * X_BF * derived.X_FE;
    for (int row = 0; row < 3; ++row) {
      ASSERT_NEAR(X_SE.translation()[row], 1000 * frame.p[row], 1e-9);
      for (int column = 0; column < 3; ++column)
        ASSERT_NEAR(X_SE.linear()(row, column), frame.M(row, column), 1e-12);
    }
    const InverseResult inverse = Inverse(derived.arm, X_BF);
    double nearest = 10;
    for (int s = 0; s < inverse.count; ++s) {
      const ArmSolution& solution = inverse.solutions[s];
      const Pose again = ForwardFlange(derived.arm, solution.q);
      ASSERT_LT((again.translation() - X_BF.translation()).norm(), 1e-6);
      nearest = std::min(nearest, (solution.q - angles).cwiseAbs().maxCoeff());
    }
    ASSERT_LT(nearest, 1e-6);
  }
}

TEST(Urdf, ArmsTurnedAboutMoveAsInKdl) {
  RandomStream random(11, 0);
  for (int k = 0; k < 200; ++k) {
    const Spec spec = TurnedAbout(RandomArm(random), random);
    const DerivedArm derived = Derive(UrdfOf(spec));
    EXPECT_LT(derived.deviation, 1e-8);
    ExpectSame(spec, derived, random, 20);
  }
}

TEST(Urdf, ArmsBesideAxis1AndWithParallelAxesMoveAsInKdl) {
  RandomStream random(18, 0);
  for (int k = 0; k < 100; ++k) {
    const Arm arm = RandomArmBeside(k, random);
    const Spec spec = TurnedAbout(arm, random);
    const DerivedArm derived = Derive(UrdfOf(spec));
    EXPECT_EQ(derived.arm.family, arm.family);
    EXPECT_NEAR(std::abs(derived.arm.dy), std::abs(arm.dy), 1e-9);
    EXPECT_NEAR(derived.arm.d5, std::abs(arm.d5), 1e-9);
    EXPECT_LT(derived.deviation, 1e-8);
    ExpectSame(spec, derived, random, 20);
  }
}

/// Frames as in the URDFs of Universal Robots: every joint about its own z, the base turned by half a turn.
Spec UniversalRobotsStyle() {
  const Vector3d z(0, 0, 1), none = Vector3d::Zero();
  const double quarter = kPi / 2;
  Spec spec;
  spec.joints = {{{{0, 0, 0.1807}, {0, 0, kPi}, z},
                  {none, {quarter, 0, 0}, z},
                  {{-0.6127, 0, 0}, none, z},
                  {{-0.57155, 0, 0.17415}, none, z},
                  {{0, -0.11985, 0}, {quarter, 0, 0}, z},
                  {{0, 0.11655, 0}, {quarter, kPi, kPi}, z}}};
  return spec;
}

TEST(Urdf, AUrHasTheLengthsOfItsTable) {
  RandomStream random(19, 0);
  const Spec spec = UniversalRobotsStyle();
  const DerivedArm derived = Derive(UrdfOf(spec));
  const Arm& arm = derived.arm;
  EXPECT_EQ(arm.family, ArmFamily::kParallelAxes);
  const double found[] = {arm.d1, arm.a1, std::abs(arm.dy), arm.a2, arm.d4, arm.dz, arm.d5, arm.d6};
  const double table[] = {180.7, 0, 174.15, 612.7, 571.55, 0, 119.85, 116.55};
  for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(found[i], table[i], 1e-9) << i;
  ExpectSame(spec, derived, random, 200);
  // What the cell of the project states is the same arm, in the base that the controller has.
  for (int k = 0; k < 50; ++k) {
    const Joints q = RandomJoints(random);
    Pose X_SB = Pose::Identity();
    X_SB.linear() = Eigen::Vector3d(-1, -1, 1).asDiagonal();
    const Pose of_cell = X_SB * ForwardFlange(Ur10e(), q);
    const Pose of_file = derived.X_SB * ForwardFlange(arm, q) * derived.X_FE;
    EXPECT_LT((of_cell.matrix() - of_file.matrix()).norm(), 1e-9);
  }
}

TEST(Urdf, AWristBesideAxis1IsTakenAsItIs) {
  // Frames as in the URDF of a Doosan M1013, whose right angles are rounded to 1.571: taken for what they
  // are. Written with more digits they would be a calibrated arm's.
  const Vector3d z(0, 0, 1), none = Vector3d::Zero();
  const auto with = [&](double quarter) {
    Spec spec;
    spec.joints = {{{{0, 0, 0.1525}, none, z},
                    {{0, 0.0345, 0}, {0, -quarter, -quarter}, z},
                    {{0.62, 0, 0}, {0, 0, quarter}, z},
                    {{0, -0.559, 0}, {quarter, 0, 0}, z},
                    {none, {-quarter, 0, 0}, z},
                    {{0, -0.121, 0}, {quarter, 0, 0}, z}}};
    return UrdfOf(spec);
  };
  const DerivedArm rounded = Derive(with(1.571));
  EXPECT_EQ(rounded.arm.family, ArmFamily::kSphericalWrist);
  EXPECT_NEAR(std::abs(rounded.arm.dy), 34.5, 1e-9);
  EXPECT_NEAR(rounded.arm.a2, 620, 1e-9);
  const std::string measured = with(1.57100123);
  const DerivedArm derived = Derive(measured, 2);
  EXPECT_NEAR(std::abs(derived.arm.dy), 34.5, 0.5);
  EXPECT_NEAR(derived.arm.a2, 620, 0.5);
  EXPECT_LT(derived.deviation, 1.5);
  EXPECT_NE(ErrorOf(measured).find("allowed by arm.urdf.tolerance_mm: 0.01 mm"), std::string::npos);
}

TEST(Urdf, OwnFileIsDerivedWithItsLengths) {
  const std::string file = std::string(SourceDir()) + "/tests/machine/robot/turned_about.urdf";
  const ChainOfLinks found = FindChain(ReadUrdf(ReadFile(file), file), "base_link", "tool0");
  const DerivedArm derived = DeriveArm(found.chain, 0.01, file);
  EXPECT_EQ(derived.X_SB.matrix(), Pose::Identity().matrix());
  EXPECT_EQ(derived.X_FE.matrix(), Pose::Identity().matrix());
  const Arm& arm = derived.arm;
  EXPECT_EQ((std::array<double, 6>{arm.d1, arm.a1, arm.a2, arm.d4, arm.dz, arm.d6}),
            (std::array<double, 6>{450, 200, 800, 700, 60, 120}));
  EXPECT_EQ(arm.sign, (std::array<double, 6>{-1, -1, 1, 1, -1, -1}));
  // At angles 0 the upper arm stands upright, the forearm lies forward, the flange looks down.
  EXPECT_LT((arm.offset - Degrees(90, -90, 90, 0, 90, 0)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(arm.lower[1], -1.5);
  EXPECT_EQ(arm.speed[5], 4);
}

TEST(Urdf, RefusesWhatHasNoClosedForm) {
  RandomStream random(12, 0);
  const Arm arm = Kr500R2830();
  EXPECT_EQ(ErrorOf(UrdfOf(TurnedAbout(arm, random))), "accepted");
  const std::string miss = ErrorOf(UrdfOf(TurnedAbout(arm, random, 20)));
  EXPECT_NE(miss.find("no spherical wrist"), std::string::npos) << miss;
  EXPECT_NE(
      miss.find("miss one point by 20 mm; allowed by arm.urdf.tolerance_mm: 0.01 mm, which is 19.99 mm less"),
      std::string::npos)
      << miss;
  EXPECT_NE(miss.find("only where axes 2, 3 and 4 are parallel"), std::string::npos) << miss;

  const std::string offset = ErrorOf(UrdfOf(TurnedAbout(Ur10e(), random, 20)));
  EXPECT_NE(offset.find("axes 5 (j5) and 6 (j6) miss each other by 20 mm"), std::string::npos) << offset;
  Spec bent = UniversalRobotsStyle();
  bent.joints[3].rpy[0] = 0.1;
  const std::string ur = ErrorOf(UrdfOf(bent));
  EXPECT_NE(ur.find("axes 3 (j3) and 4 (j4) must be parallel for the closed form; they are 5.73° off"),
            std::string::npos)
      << ur;
  // A wrist whose axes are oblique, as hollow ones of painting arms.
  Spec oblique = TurnedAbout(arm, random);
  oblique.joints[4].axis = (oblique.joints[4].axis + Vector3d(0.3, 0.4, -0.2)).normalized();
  EXPECT_NE(ErrorOf(UrdfOf(oblique)).find("must be at right angles"), std::string::npos);
}

TEST(Urdf, RoundedAnglesAreToldAndBounded) {
  RandomStream random(13, 0);
  Spec spec = TurnedAbout(Kr500R2830(), random);
  spec.joints[3].rpy[0] += 2e-6;  // a URDF that says 1.5708
  const DerivedArm derived = Derive(UrdfOf(spec), 0.05);
  EXPECT_GT(derived.deviation, 1e-4);
  spec.joints[3].rpy[0] += 5e-4;
  EXPECT_NE(ErrorOf(UrdfOf(spec)).find("own.urdf"), std::string::npos);
}

TEST(Urdf, ErrorsHaveTheirLine) {
  RandomStream random(14, 0);
  const std::string good = UrdfOf(TurnedAbout(Kr500R2830(), random));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const auto expect = [](const std::string& error, const std::string& part) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  expect(ErrorOf("<robot><link name='a'>"), "own.urdf:1: not XML");
  expect(ErrorOf("<car/>"), "no element <robot>");
  expect(ErrorOf(with("<parent link=\"l2\"/>", "<parent link=\"l22\"/>")),
         "own.urdf:15: joint 'j3': there is no link 'l22'; nearest: l2");
  expect(ErrorOf(with("velocity=\"2\"", "velocity=\"fast\"")), "own.urdf:12: <limit> velocity: given 'fast'");
  expect(ErrorOf(with("upper=\"1\"", "upper=\"-4\"")), "lower -3 must be below upper -4");
  expect(ErrorOf(with("<link name=\"l3\"/>", "<link name=\"l2\"/>")), "two links 'l2'");
  expect(ErrorOf(with("xyz=\"", "xyz=\"1 ")), "allowed: three numbers");
  expect(ErrorOf(with("type=\"revolute\"", "type=\"fixed\"")),
         "5 joints move between 'l0' and 'l7' (j2, j3, j4, j5, j6); allowed: arms with six");
  expect(ErrorOf(with("type=\"revolute\"", "type=\"prismatic\"")),
         "own.urdf:11: joint 'j1': allowed between");
  expect(ErrorOf(good, "l0", "l8"), "flange_link: given 'l8'; allowed: l0, l1");
  expect(ErrorOf(good, "l7", "l0"), "no joints lead from link 'l7' to link 'l0'");
  expect(ErrorOf(with("<limit lower", "<mimic joint=\"j2\"/><limit lower")),
         "own.urdf:11: joint 'j1' mimics another");
  expect(ErrorOf(with("<axis xyz=\"", "<axis xyz=\"0 0 0\" was=\"")), "<axis> xyz: allowed: not all zero");
  expect(ErrorOf(with("<link name=\"l3\"/>",
                      "<link name=\"l3\"><collision><geometry><cone/></geometry></collision></link>")),
         "own.urdf:6: <geometry>: given <cone>");
}

TEST(Urdf, WhatHangsBesideTheChainIsFixedToItsParentWithAWarning) {
  RandomStream random(16, 0);
  std::string text = UrdfOf(TurnedAbout(Kr500R2830(), random));
  const std::string beside = R"(<link name="rod"/><link name="piston"/><link name="finger"/>
<joint name="rod_joint" type="revolute"><parent link="l2"/><child link="rod"/><origin xyz="0.1 0 0"/>
<axis xyz="0 0 1"/><limit lower="0.5" upper="1" velocity="1"/><mimic joint="j2"/></joint>
<joint name="piston_joint" type="prismatic"><parent link="rod"/><child link="piston"/><origin xyz="0 0.2 0"/>
<axis xyz="0 1 0"/><limit lower="0" upper="1" velocity="1"/></joint>
<joint name="finger_joint" type="continuous"><parent link="l7"/><child link="finger"/><axis xyz="0 0 1"/></joint>
)";
  text.insert(text.rfind("</robot>"), beside);
  // Exporters give fixed joints an axis without a length.
  const size_t fixed = text.find("type=\"fixed\">") + 13;
  text.insert(fixed, "<axis xyz=\"0 0 0\"/>");
  const ChainOfLinks found = FindChain(ReadUrdf(text, "own.urdf"), "l0", "l7");
  ASSERT_EQ(found.warnings.size(), 3u);
  EXPECT_EQ(
      found.warnings[0].substr(found.warnings[0].find(": ") + 2),
      "joint 'rod_joint' (mimic) moves link 'rod' off the chain from base to flange: the link is taken as "
      "fixed to 'l2', and where it moves to is not checked");
  const auto link = [&](const std::string& name) {
    return *std::ranges::find_if(found.links, [&](const AttachedLink& l) { return l.link.name == name; });
  };
  EXPECT_EQ(link("rod").moves_with, 2);
  EXPECT_EQ(link("piston").moves_with, 2);
  EXPECT_EQ(link("finger").moves_with, 6);
  // The rod is at its lower limit, 0.5 rad.
  const Vector3d piston = Vector3d(100, 0, 0) + 200 * Vector3d(-std::sin(0.5), std::cos(0.5), 0);
  EXPECT_LT((link("piston").X_ML.translation() - piston).norm(), 1e-9);
  // The chain is what it was.
  EXPECT_LT(DeriveArm(found.chain, 1e-6, "own.urdf").deviation, 1e-6);
}

TEST(Urdf, LinksHangOnTheJointThatMovesThem) {
  const std::string text = R"(<robot name="r"><link name="world"/><link name="l0"/><link name="cover"/>
)" + [] {
    RandomStream random(15, 0);
    const std::string own = UrdfOf(TurnedAbout(Kr500R2830(), random));
    return own.substr(own.find("<link name=\"l1\"/>"),
                      own.rfind("</robot>") - own.find("<link name=\"l1\"/>"));
  }() + R"(
<joint name="w" type="fixed"><parent link="world"/><child link="l0"/><origin xyz="1 0 0"/></joint>
<joint name="c" type="fixed"><parent link="l3"/><child link="cover"/><origin xyz="0 0.5 0"/></joint>
</robot>)";
  const ChainOfLinks found = FindChain(ReadUrdf(text, "own.urdf"), "l0", "l7");
  ASSERT_EQ(found.links.size(), 10u);
  EXPECT_EQ(found.links[0].moves_with, 0);
  EXPECT_EQ(found.links[0].X_ML.translation(), Vector3d(-1000, 0, 0));
  EXPECT_EQ(found.links[2].link.name, "cover");
  EXPECT_EQ(found.links[2].moves_with, 3);
  EXPECT_EQ(found.links[2].X_ML.translation(), Vector3d(0, 500, 0));
  EXPECT_EQ(found.links.back().moves_with, 6);
}

// Quadratic in the links once: a chain of 20,000 fixed ones took minutes.
TEST(Urdf, MoreLinksThanAnyArmHasAreRefused) {
  std::string text = "<robot name=\"r\"><link name=\"l0\"/>";
  for (int i = 1; i <= 20000; ++i)
    text += fmt::format(
        "<link name=\"l{0}\"/><joint name=\"j{0}\" type=\"fixed\"><parent link=\"l{1}\"/>"
        "<child link=\"l{0}\"/></joint>",
        i, i - 1);
  const std::clock_t start = std::clock();
  try {
    ReadUrdf(text + "</robot>", "r.urdf");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("more than 1000 links; allowed: at most 1000"),
              std::string::npos);
  }
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5);
}

}  // namespace
}  // namespace millpose
