// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/linuxcnc.hpp"

#include <cassert>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/sections.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

constexpr int kAngleDecimals = 6;
constexpr int kDeepest = 12;  // halvings of one line
// X, Y, Z that move by less than this (degrees; 0.001 mm at 3 m) are held, so that F counts along A, B, C.
constexpr double kStandstill = 2e-5;

/// A joint position of the text: degrees as rounded there.
Joints AsWritten(const AxisConvention& axes, const Joints& q) {
  Joints angles = ToController(axes, q) * kDegPerRad;
  for (double& angle : angles) angle = Rounded(angle, kAngleDecimals);
  return angles;
}

class LinuxCncWriter {
 public:
  LinuxCncWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings)
      : program_(program),
        arm_(arm),
        settings_(settings),
        X_FT_(program.X_FT.value_or(settings.X_FT)),
        templates_(LinuxCncTexts(), settings.texts, settings.tool_name) {}

  ProgramFiles Write() {
    Head();
    Walk(program_, {[&] { Begin(); }, [&](const ProgramEvent& event) { Event(event); },
                    [&](size_t i) { AddMotion(program_.motions[i]); }});
    for (const std::string& line : templates_.Lines("footer")) Line(line);
    Line("M2");
    return {{LegalName(program_.name, 64, 1) + ".ngc", text_}};
  }

 private:
  void Line(const std::string& line) { text_ += line + "\n"; }

  void Head() {
    Line("; written by millpose for LinuxCNC; X Y Z A B C are the joints 1 to 6, degrees");
    for (const auto& [key, value] : program_.header) Line(fmt::format("; {}: {}", key, value));
    Line("G21 G90 G17 G40 G49 G94");
    for (const std::string& line : templates_.Lines("header")) Line(line);
    for (const std::string& line : templates_.Lines("tool_change")) Line(line);
  }

  /// States every modal setting again, so that a section can be entered.
  void Begin() {
    exact_.reset();
    inverse_time_.reset();
  }

  void AddMotion(const Motion& motion) {
    if (motion.type == MotionType::kLinear) {
      const Motion& before = *(&motion - 1);
      const double share = LinearDuration(before, motion);
      AddLine(before.X_PT, *before.q, motion.X_PT, *motion.q, share, motion.exact, 0);
    } else if (motion.duration > 0) {
      AddTimed(*motion.q, motion.duration, motion.exact);
    } else {
      PathMode(motion.exact);
      const Joints angles = AsWritten(settings_.axes, *motion.q);
      Line("G0 " + Words(angles));
      last_ = angles;
    }
  }

  /// s; by the feed, or, for a motion that only turns, at half of the axes' largest speeds.
  double LinearDuration(const Motion& from, const Motion& to) const {
    const double length = (to.X_PT.translation() - from.X_PT.translation()).norm();
    const double turning = ((*to.q - *from.q).cwiseAbs().cwiseQuotient(arm_.speed)).maxCoeff() * 2;
    return std::max(length / to.feed, turning);
  }

  /// A straight line of the tip from joints q0 to q1, halved until the joint motions between stay near it.
  void AddLine(const Pose& X0, const Joints& q0, const Pose& X1, const Joints& q1, double duration,
               bool exact, int depth) {
    Pose middle = Pose::Identity();
    middle.translation() = (X0.translation() + X1.translation()) / 2;
    // Half-way of the shortest turn: the normalised sum of the two quaternions.
    const Eigen::Quaterniond first(X0.linear()), second(X1.linear());
    const double side = first.dot(second) < 0 ? -1 : 1;
    middle.linear() =
        Eigen::Quaterniond(first.coeffs() + side * second.coeffs()).normalized().toRotationMatrix();
    const Joints halfway = (q0 + q1) / 2;
    const Pose reached = program_.X_BP->inverse() * ForwardFlange(arm_, halfway) * X_FT_;
    const double off = (reached.translation() - middle.translation()).norm();
    const double turned = AngleBetween(reached.linear(), middle.linear());
    const auto q_middle =
        InverseNear(arm_, *program_.X_BP * middle * X_FT_.inverse(), Status(arm_, q1), halfway);
    // Where the arm changes its branch half-way no joint motion follows the line; read-back says so.
    const bool near = off <= kHalfwayDeviation && turned <= kHalfwayAngle;
    if (near || depth == kDeepest || !q_middle) {
      AddTimed(q1, duration, exact);
      return;
    }
    AddLine(X0, q0, middle, *q_middle, duration / 2, false, depth + 1);
    AddLine(middle, *q_middle, X1, q1, duration / 2, exact, depth + 1);
  }

  void AddTimed(const Joints& q, double duration, bool exact) {
    PathMode(exact);
    Joints angles = AsWritten(settings_.axes, q);
    if ((angles - last_).head<3>().norm() < kStandstill) angles.head<3>() = last_.head<3>();
    const double length = FeedLength(last_, angles);
    if (length == 0) return;
    // G93 floors the speed along that length; slower motions state the speed itself.
    const double per_minute = length / duration * 60;
    const bool inverse = per_minute > kInverseTimeFloor;
    if (inverse_time_ != inverse) Line(inverse ? "G93" : "G94");
    inverse_time_ = inverse;
    Line(fmt::format("G1 {} F{}", Words(angles), inverse ? Fixed(60 / duration, 6) : Fixed(per_minute, 9)));
    last_ = angles;
  }

  static std::string Words(const Joints& angles) {
    std::string words;
    for (int i = 0; i < 6; ++i)
      words += fmt::format("{}{}{}", i ? " " : "", "XYZABC"[i], Fixed(angles[i], kAngleDecimals));
    return words;
  }

  void PathMode(bool exact) {
    if (exact_ == exact) return;
    exact_ = exact;
    Line(exact ? "G61.1" : fmt::format("G64 P{} Q0", Fixed(BlendDegrees(settings_.blend, arm_, X_FT_), 6)));
  }

  void Event(const ProgramEvent& event) {
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) Line("; " + place);
    if (event.kind == ProgramEvent::Kind::kPassEnd) Line("; END OF " + place);
    for (const std::string& line : templates_.Lines(event)) Line(line);
  }

  const MotionProgram& program_;
  const Arm& arm_;
  const PostSettings& settings_;
  Pose X_FT_;
  Templates templates_;
  std::string text_;
  Joints last_ = Joints::Zero();  // degrees, as written
  std::optional<bool> inverse_time_;
  std::optional<bool> exact_;
};

}  // namespace

std::map<std::string, std::string> LinuxCncTexts() {
  return {{"spindle_on", "S{rpm} M3"}, {"spindle_off", "M5"}};
}

double BlendDegrees(double blend, const Arm& arm, const Pose& X_FT) {
  const double reach = arm.a1 + arm.a2 + std::hypot(arm.d4, arm.dz) + arm.d6 + X_FT.translation().norm();
  return blend / reach * kDegPerRad;
}

double FeedLength(const Joints& from, const Joints& to) {
  const double xyz = (to - from).head<3>().norm();
  return xyz > 0 ? xyz : (to - from).tail<3>().norm();
}

ProgramFiles LinuxCncPost::Write(const MotionProgram& program, const Arm& arm,
                                 const PostSettings& settings) const {
  assert(IsWellFormed(program));
  return LinuxCncWriter(program, arm, settings).Write();
}

}  // namespace millpose
