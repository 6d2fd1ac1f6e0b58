// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/pose_stiffness.hpp"

#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Joints RegularJoints(const Arm& arm, RandomStream& stream) {
  while (true) {
    const Joints q = RandomJoints(stream);
    const SingularityDistance distance = DistanceToSingularity(arm, q);
    if (distance.elbow > 0.2 && distance.wrist > 0.2 && distance.shoulder > 200) return q;
  }
}

/// The best of `value` over unit vectors: random directions, then small steps that only go up.
template <class Value>
double Polish(RandomStream& stream, int samples, const Value& value) {
  Vector3d best = RandomUnit(stream);
  for (int k = 0; k < samples; ++k) {
    const Vector3d direction = RandomUnit(stream);
    if (value(direction) > value(best)) best = direction;
  }
  for (double step = 0.1; step > 1e-9; step *= 0.7) {
    for (int k = 0; k < 60; ++k) {
      const Vector3d near = (best + step * RandomUnit(stream)).normalized();
      if (value(near) > value(best)) best = near;
    }
  }
  return value(best);
}

TEST(PoseStiffness, EllipsoidAgreesWithSampledDirections) {
  const Arm arm = Kr500R2830();
  RandomStream stream(1, 0);
  for (int k = 0; k < 3; ++k) {
    const Joints q = RegularJoints(arm, stream);
    const PoseStiffness at = EvaluatePose(arm, q, {-250, 31, 250}, RandomUnit(stream), 1000);
    EXPECT_LT((at.origin - ForwardFlange(arm, q) * Vector3d(-250, 31, 250)).norm(), 1e-9);
    const Matrix3d c = at.C.topLeftCorner<3, 3>();
    const int samples = k == 0 ? 1000000 : 20000;  // a million once
    EXPECT_NEAR(Polish(stream, samples, [&](const Vector3d& u) { return (c * u).norm(); }) / at.lambda[0], 1,
                1e-9);
    EXPECT_NEAR(-Polish(stream, samples, [&](const Vector3d& u) { return -(c * u).norm(); }) / at.lambda[2],
                1, 1e-9);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT((c * at.directions.col(i) - at.lambda[i] * at.directions.col(i)).norm(), 1e-15);
    EXPECT_NEAR(at.lambda.prod() / c.determinant(), 1, 1e-9);
  }
}

TEST(PoseStiffness, SectionAgreesWithDirectionsInThePlane) {
  const Arm arm = Kr500R2830();
  RandomStream stream(2, 0);
  for (int k = 0; k < 20; ++k) {
    const Vector3d n = RandomUnit(stream);
    const PoseStiffness at = EvaluatePose(arm, RegularJoints(arm, stream), {-250, 31, 250}, n, 1000);
    ASSERT_TRUE(at.indices.has_value());
    const Matrix3d inverse = at.C.topLeftCorner<3, 3>().inverse();
    const auto radius = [&](const Vector3d& u) { return 1 / (inverse * u).norm(); };
    const auto in_plane = [&](const Vector3d& u) { return (u - n.dot(u) * n).normalized(); };
    const double longest = Polish(stream, 2000, [&](const Vector3d& u) { return radius(in_plane(u)); });
    const double shortest = -Polish(stream, 2000, [&](const Vector3d& u) { return -radius(in_plane(u)); });
    EXPECT_NEAR(longest / at.indices->lambda_t1, 1, 1e-9);
    EXPECT_NEAR(shortest / at.indices->lambda_t2, 1, 1e-9);
    EXPECT_NEAR(radius(n) / at.indices->lambda_n, 1, 1e-9);
    EXPECT_NEAR(radius(at.t1_direction) / at.indices->lambda_t1, 1, 1e-9);
    EXPECT_NEAR(radius(at.t2_direction) / at.indices->lambda_t2, 1, 1e-9);
    EXPECT_NEAR(n.dot(at.t1_direction), 0, 1e-12);
  }
}

TEST(PoseStiffness, StiffnessInvertsTheComplianceUnlessSingular) {
  const Arm arm = Kr500R2830();
  RandomStream stream(3, 0);
  const PoseStiffness at =
      EvaluatePose(arm, RegularJoints(arm, stream), {-250, 0, 250}, Vector3d::UnitX(), 1000);
  ASSERT_TRUE(at.K.has_value());
  Matrix6 expected = Matrix6::Identity();
  const Matrix6 product = at.C * *at.K;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(product(i, j) * (i < 3 ? 1 : 1000) / (j < 3 ? 1 : 1000), expected(i, j), 1e-9);
  const PoseStiffness singular =
      EvaluatePose(arm, Degrees(0, -90, 90, 0, 0, 0), {-250, 0, 250}, Vector3d::UnitX(), 1000);
  EXPECT_FALSE(singular.K.has_value());
  EXPECT_LT(singular.dexterity, 1e-9);
}

/// Rotation vector of a small rotation.
Vector3d RotationVector(const Matrix3d& R) {
  return 0.5 * Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
}

/// The tip's pose in B when every element has given way by `twists` (in its own frame): rigid parts, elastic
/// hinges.
Pose Deformed(const Arm& arm, const Joints& q, const Vector3d& p_FT,
              const std::vector<SeriesCompliance>& elements,
              const std::vector<Eigen::Matrix<double, 6, 1>>& twists) {
  const std::array<Pose, 7> frames = LinkFrames(arm, q);
  Pose moved = Pose::Identity();  // elements are sorted from the base outwards
  for (size_t i = 0; i < elements.size(); ++i) {
    const Pose X_BK = frames[elements[i].link] * elements[i].X_LK;
    Pose small = Pose::Identity();
    small.translation() = twists[i].head<3>();
    const double angle = twists[i].tail<3>().norm();
    if (angle > 0) small.linear() = Eigen::AngleAxisd(angle, twists[i].tail<3>() / angle).toRotationMatrix();
    moved = moved * X_BK * small * X_BK.inverse();
  }
  return moved * frames[6] * Eigen::Translation3d(p_FT);
}

/// Elements at random frames on these links, without a compliance yet.
std::vector<SeriesCompliance> RandomElements(const std::vector<int>& links, RandomStream& stream) {
  std::vector<SeriesCompliance> elements(links.size());
  for (size_t i = 0; i < links.size(); ++i) {
    elements[i].link = links[i];
    elements[i].X_LK =
        Eigen::Translation3d(100 * RandomUnit(stream)) * Eigen::AngleAxisd(1.0, RandomUnit(stream));
  }
  return elements;
}

TEST(Series, AgreesWithAnElastostaticSolveByDifferences) {
  const Arm arm = Kr500R2830();
  const Vector3d p_FT(-250, 31, 250);
  RandomStream stream(4, 0);
  for (int k = 0; k < 20; ++k) {
    const Joints q = RegularJoints(arm, stream);
    std::vector<SeriesCompliance> elements = RandomElements({0, 2, 4, 6}, stream);
    for (SeriesCompliance& element : elements) {
      Matrix6 root;
      for (double& value : root.reshaped()) value = stream.Normal();
      Eigen::Matrix<double, 6, 1> scale;
      scale << Vector3d::Constant(1e-2), Vector3d::Constant(2e-5);
      element.C = scale.asDiagonal() * (root * root.transpose()) * scale.asDiagonal();
    }
    Eigen::Matrix<double, 6, 1> wrench;
    wrench << RandomUnit(stream), 300 * RandomUnit(stream);
    const double load = 1e-3;
    // Each element sees the wrench reduced to its own frame, from statics alone.
    const std::array<Pose, 7> frames = LinkFrames(arm, q);
    const Vector3d tip = frames[6] * p_FT;
    std::vector<Eigen::Matrix<double, 6, 1>> twists;
    for (const SeriesCompliance& element : elements) {
      const Pose X_BK = frames[element.link] * element.X_LK;
      const Vector3d force = X_BK.linear().transpose() * wrench.head<3>();
      const Vector3d moment =
          X_BK.linear().transpose() * (wrench.tail<3>() + (tip - X_BK.translation()).cross(wrench.head<3>()));
      Eigen::Matrix<double, 6, 1> local;
      local << force, moment;
      twists.push_back(load * element.C * local);
    }
    const std::vector<Eigen::Matrix<double, 6, 1>> none(elements.size(), Eigen::Matrix<double, 6, 1>::Zero());
    const Pose before = Deformed(arm, q, p_FT, elements, none),
               after = Deformed(arm, q, p_FT, elements, twists);
    Eigen::Matrix<double, 6, 1> moved;
    moved << after.translation() - before.translation(),
        RotationVector(after.linear() * before.linear().transpose());
    const Eigen::Matrix<double, 6, 1> predicted = load * SeriesComplianceAt(arm, q, p_FT, elements) * wrench;
    EXPECT_LT((moved - predicted).head<3>().norm(), 1e-4 * predicted.head<3>().norm());
    EXPECT_LT((moved - predicted).tail<3>().norm(), 1e-4 * predicted.tail<3>().norm());
  }
}

TEST(Series, JointsAndElementsTogetherMinimiseTheEnergy) {
  // Give x of all joints and elements that minimises ½xᵀKx − w·u(x), with du/dx from differences of the
  // deformed arm alone: no Jacobian, no adjoint, no statics.
  const Arm arm = Kr500R2830();
  const Vector3d p_FT(-250, 31, 250);
  RandomStream stream(6, 0);
  for (int k = 0; k < 10; ++k) {
    const Joints q = RegularJoints(arm, stream);
    std::vector<SeriesCompliance> elements = RandomElements({0, 1, 3, 5, 6}, stream);
    for (SeriesCompliance& element : elements) {
      element.C.diagonal() << 1e-5, 2e-5, 3e-5, 1e-11, 2e-11, 3e-11;
    }
    const auto n = static_cast<Eigen::Index>(6 + 6 * elements.size());
    const auto tip = [&](const Eigen::VectorXd& x) {
      std::vector<Eigen::Matrix<double, 6, 1>> twists;
      for (Eigen::Index i = 6; i < n; i += 6) twists.push_back(x.segment<6>(i));
      const Pose joints = ForwardFlange(arm, q + x.head<6>()) * ForwardFlange(arm, q).inverse();
      return joints * Deformed(arm, q, p_FT, elements, twists);
    };
    Eigen::MatrixXd G(6, n);
    Eigen::VectorXd compliance(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool translation = i >= 6 && i % 6 < 3;
      const double h = translation ? 1e-3 : 1e-6;
      const Pose before = tip(-h * Eigen::VectorXd::Unit(n, i)), after = tip(h * Eigen::VectorXd::Unit(n, i));
      G.col(i) << (after.translation() - before.translation()) / (2 * h),
          RotationVector(after.linear() * before.linear().transpose()) / (2 * h);
      compliance[i] = i < 6 ? 1 / arm.stiffness[i] : elements[static_cast<size_t>(i) / 6 - 1].C(i % 6, i % 6);
    }
    const Matrix6 C = EvaluatePose(arm, q, p_FT, Vector3d::UnitX(), 1000, elements).C;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Matrix<double, 6, 1> w = Eigen::Matrix<double, 6, 1>::Unit(i);
      const Eigen::VectorXd x = compliance.cwiseProduct(G.transpose() * w);
      const Eigen::Matrix<double, 6, 1> u = G * x;
      EXPECT_LT((C.col(i) - u).head<3>().norm(), 1e-6 * u.head<3>().norm());
      EXPECT_LT((C.col(i) - u).tail<3>().norm(), 1e-6 * u.tail<3>().norm());
    }
  }
}

TEST(Gravity, TorquesAreTheGradientOfThePotential) {
  const Arm arm = Kr500R2830();
  const std::vector<LinkMass> masses{{"upper arm", 2, 400, {600, 0, 30}},
                                     {"forearm", 3, 500, {200, 10, 0}},
                                     {"hand", 5, 90, {50, 0, 5}},
                                     {"spindle", 6, 120, {-40, 20, 150}}};
  const Vector3d gravity(0, 0, -9810);
  const auto potential = [&](const Joints& q) {  // N·mm
    double sum = 0;
    const std::array<Pose, 7> frames = LinkFrames(arm, q);
    for (const LinkMass& body : masses)
      sum -= 1e-3 * body.mass * gravity.dot(frames[body.link] * body.centre);
    return sum;
  };
  RandomStream stream(5, 0);
  for (int k = 0; k < 50; ++k) {
    const Joints q = RandomJoints(stream);
    const Joints torques = GravityTorques(arm, q, masses, {}, gravity);
    for (int i = 0; i < 6; ++i) {
      const Joints step = 1e-6 * Joints::Unit(i);
      EXPECT_NEAR(torques[i], -(potential(q + step) - potential(q - step)) / 2e-6, 1e-2);
    }
  }
}

TEST(Gravity, CounterbalanceCarriesTheArmAndTheReferenceHidesItself) {
  const Arm arm = Kr500R2830();
  const Vector3d gravity(0, 0, -9810), p_FT(-250, 0, 250);
  const Joints upright = Degrees(0, -90, 90, 0, 45, 0), forward = Degrees(0, -45, 60, 0, 45, 0);
  // One mass on the upper arm's axis is carried wholly by the matching counterbalance.
  const std::vector<LinkMass> masses{{"upper arm", 2, 400, {650, 0, 0}}};
  const Counterbalance exact{400 * 9.81 * 650, DegToRad(-90)};
  EXPECT_GT(GravityTorques(arm, forward, masses, {}, gravity)[1], 1e6);
  EXPECT_NEAR(GravityTorques(arm, forward, masses, exact, gravity)[1], 0, 1e-6);
  EXPECT_EQ(GravityDeflection(arm, upright, upright, p_FT, masses, {}, gravity).norm(), 0);
  EXPECT_LT(GravityDeflection(arm, forward, upright, p_FT, masses, {}, gravity).z(), 0);
}

TEST(Gravity, CounterbalanceActsInTheArmsOwnSigns) {
  for (const Arm& arm : AllArms()) {  // one of them counts A2 the other way, with an offset
    const Counterbalance device{4e6, 0.3};
    const auto potential = [&](double A2) {  // of a torque −T·sin(q2 − zero) on the inner angle
      return -device.torque * std::cos(arm.sign[1] * A2 + arm.offset[1] - device.zero);
    };
    for (double A2 = -2; A2 < 2; A2 += 0.37) {
      Joints q = Joints::Zero();
      q[1] = A2;
      EXPECT_NEAR(GravityTorques(arm, q, {}, device, {0, 0, -9810})[1],
                  -(potential(A2 + 1e-5) - potential(A2 - 1e-5)) / 2e-5, 1e-2);
    }
  }
}

TEST(PoseStiffness, DirectionsAreGivenWithTheirLargestComponentPositive) {
  const Arm arm = Kr500R2830();
  RandomStream stream(8, 0);
  for (int k = 0; k < 20; ++k) {
    const PoseStiffness at =
        EvaluatePose(arm, RegularJoints(arm, stream), {-250, 31, 250}, RandomUnit(stream), 1000);
    for (const Vector3d& direction : {Vector3d(at.directions.col(0)), Vector3d(at.directions.col(1)),
                                      Vector3d(at.directions.col(2)), at.t1_direction, at.t2_direction})
      EXPECT_EQ(direction.maxCoeff(), direction.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace millpose
