// SPDX-License-Identifier: GPL-3.0-or-later
// From the axes of a joint chain to the lengths, signs and offsets of the closed form (docs/urdf.md).
#include "base/error.hpp"
#include "base/random.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/joint_chain.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kRightAngle = 1e-3;  // rad: what is further off is another kind of arm, not rounding
constexpr int kProofPoses = 500;

/// An axis at joint angles 0: a point on it and its unit direction, in S.
struct Axis {
  Vector3d point, direction;
};

/// Points of two lines that are nearest to each other; the lines are not parallel.
std::pair<Vector3d, Vector3d> Nearest(const Axis& a, const Axis& b) {
  const Vector3d between = b.point - a.point;
  const double c = a.direction.dot(b.direction), s2 = 1 - c * c;
  const double along_a = (between.dot(a.direction) - c * between.dot(b.direction)) / s2;
  const double along_b = (c * between.dot(a.direction) - between.dot(b.direction)) / s2;
  return {a.point + along_a * a.direction, b.point + along_b * b.direction};
}

/// A length to 1e-11 mm: products of a URDF's rounded rotations leave less than that.
double Length(double mm) { return std::round(mm * 1e11) / 1e11 + 0.0; }
/// An angle in rad that is a whole number of 1e-6 degrees where it is nearly that.
double Offset(double y, double x) {
  const double degrees = RadToDeg(Atan2(y, x));
  const double rounded = std::round(degrees * 1e6) / 1e6;  // most are whole quarter turns
  return DegToRad(std::abs(degrees - rounded) < 1e-12 ? rounded : degrees) + 0.0;
}

Vector3d Across(const Vector3d& v, const Vector3d& unit) { return v - v.dot(unit) * unit; }

double SignOf(const Vector3d& a, const Vector3d& b) { return a.dot(b) < 0 ? -1 : 1; }

/// The unit vector across `axis` (unit) nearest to `wanted`, or to another when that is parallel.
Vector3d CrossDirection(const Vector3d& axis, const Vector3d& wanted, const Vector3d& otherwise) {
  const Vector3d across = Across(wanted, axis);
  return (across.norm() > 0.1 ? across : Across(otherwise, axis)).normalized();
}

class Derivation {
 public:
  Derivation(const JointChain& chain, double tolerance, const std::string& file, const std::string& key)
      : chain_(chain), tolerance_(tolerance), file_(file), key_(key) {
    const std::array<Pose, 8> frames = ChainFrames(chain, Joints::Zero());
    for (size_t i = 0; i < 6; ++i) {
      axes_[i] = {frames[i + 1].translation(), frames[i + 1].linear() * chain.joints[i].axis};
    }
    X_SE_ = frames[7];
  }

  DerivedArm Derive() {
    if (std::abs(Dot(3, 4)) > 0.99) derived_.arm.family = ArmFamily::kParallelAxes;
    CheckDirections();
    FindWrist();
    ThrowProblems();
    FillBase();
    FillArm();
    FillForearm();
    FillWrist();
    for (Eigen::Index i = 0; i < 6; ++i) {
      const JointChain::Joint& joint = chain_.joints[static_cast<size_t>(i)];
      derived_.arm.lower[i] = joint.lower;
      derived_.arm.upper[i] = joint.upper;
      derived_.arm.speed[i] = joint.speed;
    }
    Prove();
    ThrowProblems();
    return derived_;
  }

 private:
  void Refuse(std::string message) { problems_.push_back({{file_}, std::move(message)}); }
  void ThrowProblems() {
    if (!problems_.empty()) throw InputError(std::move(problems_));
  }
  /// What the tolerance is, and by how much a misfit is above it.
  std::string Allowed(double misfit) const {
    return fmt::format("allowed by {}: {:.4g} mm, which is {:.4g} mm less", key_, tolerance_,
                       misfit - tolerance_);
  }
  const std::string& Name(int axis) const { return chain_.joints[static_cast<size_t>(axis - 1)].name; }
  const Axis& At(int axis) const { return axes_[static_cast<size_t>(axis - 1)]; }
  double Dot(int a, int b) const { return At(a).direction.dot(At(b).direction); }

  bool Parallel() const { return derived_.arm.family == ArmFamily::kParallelAxes; }

  /// Refuses an angle, given by its sine, that should be 0 where axes a and b are `wanted`.
  void CheckAngle(int a, int b, double sine, const char* wanted) {
    const double off = Asin(std::min(1.0, sine));
    if (off <= kRightAngle) return;
    const char* why =
        a < 4 ? "" : ". Hollow wrists with oblique axes, as of painting arms, cannot be solved here";
    Refuse(fmt::format("axes {} ({}) and {} ({}) must be {} for the closed form; they are {:.4g}° off{}", a,
                       Name(a), b, Name(b), wanted, RadToDeg(off), why));
  }

  void CheckDirections() {
    for (const auto& [a, b] : {std::pair(1, 2), std::pair(3, 4), std::pair(4, 5), std::pair(5, 6)})
      if (a != 3 || !Parallel()) CheckAngle(a, b, std::abs(Dot(a, b)), "at right angles");
    for (const auto& [a, b] : {std::pair(2, 3), std::pair(3, 4)})
      if (a != 3 || Parallel()) CheckAngle(a, b, At(a).direction.cross(At(b).direction).norm(), "parallel");
  }

  void FindWrist() {
    if (std::abs(Dot(4, 5)) > 0.99 || std::abs(Dot(5, 6)) > 0.99) return;  // refused already
    if (Parallel()) return FindParallelWrist();
    FindSphericalWrist();
  }

  /// Axis 5 meets axis 4 in one point and axis 6 in another, the wrist centre.
  void FindParallelWrist() {
    std::tie(on_4_, wrist_) = Nearest(At(4), At(5));
    const auto [near_6, on_6] = Nearest(At(5), At(6));
    const double misses[] = {(on_4_ - wrist_).norm(), (near_6 - on_6).norm()};
    for (const int axis : {4, 5}) {
      const double miss = misses[axis - 4];
      if (miss <= tolerance_) continue;
      Refuse(
          fmt::format("axes {} ({}) and {} ({}) miss each other by {:.4g} mm: no closed form, though axes 2, "
                      "3 and 4 are parallel; {}",
                      axis, Name(axis), axis + 1, Name(axis + 1), miss, Allowed(miss)));
    }
    wrist_ = (near_6 + on_6) / 2;
  }

  /// Where axes 4 and 6 meet axis 5, whatever the angles are.
  void FindSphericalWrist() {
    const auto [on_4, near_4] = Nearest(At(4), At(5));
    const auto [near_6, on_6] = Nearest(At(5), At(6));
    wrist_ = (on_4 + near_4 + near_6 + on_6) / 4;
    const double miss = std::max({(on_4 - near_4).norm(), (on_6 - near_6).norm(), (near_4 - near_6).norm()});
    if (miss > tolerance_) {
      Refuse(fmt::format(
          "no spherical wrist: axes 4, 5 and 6 ({}, {}, {}) miss one point by {:.4g} mm; {}. "
          "Poses are solved in closed form, which needs the three wrist axes to meet in one point; where "
          "the wrist has an offset (painting arms, FANUC CRX) it goes only where axes 2, 3 and 4 are "
          "parallel (UR)",
          Name(4), Name(5), Name(6), miss, Allowed(miss)));
    }
  }

  /// B: z along axis 1, the origin on it nearest to S's, x as near to S's x as that allows.
  void FillBase() {
    up_ = At(1).direction.z() < -1e-9 ? Vector3d(-At(1).direction) : At(1).direction;
    const Vector3d x = CrossDirection(up_, Vector3d::UnitX(), Vector3d::UnitZ());
    derived_.X_SB.linear().col(0) = x;
    derived_.X_SB.linear().col(1) = up_.cross(x);
    derived_.X_SB.linear().col(2) = up_;
    derived_.X_SB.translation() = Across(At(1).point, up_);
    derived_.arm.sign[0] = SignOf(At(1).direction, up_);
  }

  void FillArm() {
    Arm& arm = derived_.arm;
    // y of the turned frame 1, along axis 2, such that the shoulder lies in front.
    side_ = At(2).direction;
    const Vector3d shoulder = At(2).point - derived_.X_SB.translation();
    if (shoulder.dot(side_.cross(up_)) < -1e-9) side_ = -side_;
    side_ = Across(side_, up_).normalized();
    const Vector3d front = side_.cross(up_);
    const Vector3d bx = derived_.X_SB.linear().col(0), by = derived_.X_SB.linear().col(1);
    arm.offset[0] = Offset(front.dot(by), front.dot(bx));
    arm.d1 = Length(shoulder.dot(up_));
    arm.a1 = Length(shoulder.dot(front));

    const Vector3d upper = Across(At(3).point - At(2).point, side_);
    arm.a2 = Length(upper.norm());
    if (arm.a2 <= tolerance_) Refuse("axes 2 and 3 are one line: the arm cannot bend");
    arm.sign[1] = SignOf(At(2).direction, side_);
    arm.sign[2] = SignOf(At(3).direction, side_);
    arm.offset[1] = Offset(-upper.dot(up_), upper.dot(front));

    const double beside = (wrist_ - derived_.X_SB.translation()).dot(side_);
    arm.dy = std::abs(beside) > tolerance_ ? Length(beside) : 0;
  }

  /// `along_` and `x4_`: x of frames 3 and 4; axis 4 lies along the second.
  void FillForearm() {
    Arm& arm = derived_.arm;
    if (Parallel()) {
      const Vector3d forearm = Across(on_4_ - At(3).point, side_);
      along_ = forearm.normalized();
      x4_ = side_;
      arm.d4 = Length(forearm.norm());
    } else {
      const Vector3d forearm = Across(wrist_ - At(3).point, side_);
      along_ = Across(At(4).direction, side_).normalized();
      if (forearm.dot(along_) < -1e-9) along_ = -along_;
      x4_ = along_;
      arm.d4 = Length(forearm.dot(along_));
      arm.dz = Length(forearm.dot(along_.cross(side_)));
    }
    arm.sign[3] = SignOf(At(4).direction, x4_);
    if (Hypot(arm.d4, arm.dz) <= tolerance_)
      Refuse(Parallel() ? "axes 3 and 4 are one line: the arm has no forearm"
                        : "the wrist lies on axis 3: the arm has no forearm");
    // q2 + q3 at angles 0, less q2.
    const SineCosine second = SinCos(arm.offset[1]);
    const double s = -along_.dot(up_), c = along_.dot(side_.cross(up_));
    arm.offset[2] = Offset(s * second.cos - c * second.sin, c * second.cos + s * second.sin);
  }

  /// y of frame 4, along axis 5; fills what depends on joint 4.
  Vector3d FillFourth() {
    Arm& arm = derived_.arm;
    Vector3d y4 = At(5).direction;
    if (Parallel()) {
      // Such that the wrist centre lies on its negative side; without an angle q4 that is −along_.
      if ((wrist_ - on_4_).dot(y4) > 1e-9) y4 = -y4;
      y4 = Across(y4, side_).normalized();
      arm.d5 = Length((on_4_ - wrist_).dot(y4));
      arm.offset[3] = Offset(-y4.dot(side_.cross(along_)), -y4.dot(along_));
      return y4;
    }
    // Such that offset 4 lies in (−90°, 90°].
    const Vector3d z3 = along_.cross(side_);
    if (y4.dot(side_) < -1e-9 || (std::abs(y4.dot(side_)) <= 1e-9 && y4.dot(z3) < 0)) y4 = -y4;
    y4 = Across(y4, along_).normalized();
    arm.offset[3] = Offset(y4.dot(z3), y4.dot(side_));
    return y4;
  }

  void FillWrist() {
    Arm& arm = derived_.arm;
    const Vector3d y4 = FillFourth();
    arm.sign[4] = SignOf(At(5).direction, y4);
    const Vector3d z4 = x4_.cross(y4);

    // x of frame 6, along axis 6, towards the flange.
    Vector3d out = At(6).direction;
    if (out.dot(X_SE_.translation() - wrist_) < -1e-9) out = -out;
    out = Across(out, y4).normalized();
    arm.sign[5] = SignOf(At(6).direction, out);
    arm.d6 = Length(out.dot(X_SE_.translation() - wrist_));
    arm.offset[4] = Offset(-out.dot(z4), out.dot(x4_));

    // F: z outwards, x as near to E's as that allows; in R5 at angle 0 the axes are out, y4, z5.
    const Vector3d x_F = CrossDirection(out, X_SE_.linear().col(0), X_SE_.linear().col(1));
    const Vector3d z5 = out.cross(y4);
    arm.offset[5] = Offset(x_F.dot(y4), -x_F.dot(z5));
    const Pose X_SF = derived_.X_SB * ForwardFlange(arm, Joints::Zero());
    derived_.X_FE = X_SF.inverse(Eigen::Isometry) * X_SE_;
    Snap(derived_.X_SB);
    Snap(derived_.X_FE);
  }

  /// Where a pose is the identity but for rounding, it is the identity.
  static void Snap(Pose& X) {
    if ((X.linear() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-14) X.linear().setIdentity();
    for (double& value : X.translation()) value = Length(value);
  }

  void Prove() {
    if (!problems_.empty()) return;
    RandomStream random(1, 0);
    for (int k = 0; k < kProofPoses; ++k) {
      Joints angles;
      for (double& angle : angles) angle = random.Uniform(-kPi, kPi);
      const Pose of_chain = ChainFrames(chain_, angles)[7];
      const Pose of_arm = derived_.X_SB * ForwardFlange(derived_.arm, angles) * derived_.X_FE;
      // A turned frame shows at a tool of 500 mm.
      const double off = (of_chain.matrix() - of_arm.matrix()).topRightCorner<3, 1>().norm() +
                         500 * (of_chain.linear() - of_arm.linear()).norm();
      derived_.deviation = std::max(derived_.deviation, off);
    }
    if (derived_.deviation > tolerance_) {
      Refuse(fmt::format(
          "the closed form and the joints of the file differ by up to {:.4g} mm over random poses; {}",
          derived_.deviation, Allowed(derived_.deviation)));
    }
  }

  const JointChain& chain_;
  double tolerance_;
  const std::string& file_;
  const std::string& key_;
  std::array<Axis, 6> axes_;
  Pose X_SE_;
  Vector3d wrist_ = Vector3d::Zero(), on_4_ = Vector3d::Zero(), up_, side_, along_, x4_;
  DerivedArm derived_;
  std::vector<Problem> problems_;
};

}  // namespace

DerivedArm DeriveArm(const JointChain& chain, double tolerance, const std::string& file,
                     const std::string& key) {
  return Derivation(chain, tolerance, file, key).Derive();
}

}  // namespace millpose
