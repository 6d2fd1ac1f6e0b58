// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/sinumerik.hpp"

#include <cassert>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

constexpr size_t kLongestName = 24;
constexpr int kLengthDecimals = 4;
constexpr int kAngleDecimals = 6;

class SinumerikWriter {
 public:
  SinumerikWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings)
      : program_(program), arm_(arm), settings_(settings), templates_(SinumerikTexts(), settings.texts) {}

  ProgramFiles Write() {
    Head();
    size_t event = 0;
    for (size_t i = 0; i <= program_.motions.size(); ++i) {
      for (; event < program_.events.size() && program_.events[event].before_motion == i; ++event) {
        Event(program_.events[event]);
      }
      if (i < program_.motions.size()) AddMotion(program_.motions[i]);
    }
    Transform(false);
    Line("CYCLE832(0,_OFF,1)");
    Line("M30");
    return {{LegalName(program_.name, kLongestName, 2) + ".mpf", text_}};
  }

 private:
  void Line(const std::string& line) { text_ += line + "\n"; }

  void Head() {
    Line("; written by millpose for SINUMERIK 840D sl with robot transformation; mm, degrees");
    Line(settings_.rotation == "rpy" ? "; orientation rpy: C about Z, B about new Y, A about new X"
                                     : "; orientation euler: A about Z, B about new X, C about new Z");
    for (const auto& [key, value] : program_.header) Line(fmt::format("; {}: {}", key, value));
    Line("G17 G710 G40 G90 G94");
    if (!settings_.tool_name.empty()) {
      Line(fmt::format("T=\"{}\" D1", settings_.tool_name));
      Line("M6");
    }
    if (program_.X_BP) {
      const Eigen::Vector3d p = program_.X_BP->translation();
      const Eigen::Vector3d zyx = AnglesZyx(program_.X_BP->linear()) * kDegPerRad;
      Line(fmt::format("$P_UIFR[1]=CTRANS(X,{},Y,{},Z,{}):CROT(X,{},Y,{},Z,{})",
                       Fixed(p.x(), kLengthDecimals), Fixed(p.y(), kLengthDecimals),
                       Fixed(p.z(), kLengthDecimals), Fixed(zyx[2], kAngleDecimals),
                       Fixed(zyx[1], kAngleDecimals), Fixed(zyx[0], kAngleDecimals)));
    }
    Line("G54");
    Line("ORIWKS");
    Line(fmt::format("CYCLE832({},_FINISH,0.1)", Fixed(settings_.blend, 4)));
    Line("G642");
  }

  void AddMotion(const Motion& motion) {
    if (motion.type == MotionType::kLinear) {
      AddLinear(motion);
    } else if (motion.status) {
      Transform(true);
      Line(fmt::format("G0 {} STAT='B{:03b}' TU='B{:06b}' PTP", Words(motion), *motion.status,
                       TurnOf(motion)));
      cartesian_ = false;
    } else {
      AddJoint(motion);
    }
  }

  void AddLinear(const Motion& motion) {
    Transform(true);
    std::string line = fmt::format("{}G1 {}", motion.exact ? "G9 " : "", Words(motion));
    const std::string feed = Fixed(motion.feed * 60, 4);
    if (feed != feed_) line += " F" + feed;
    feed_ = feed;
    if (!cartesian_) line += " CP";
    cartesian_ = true;
    Line(line);
  }

  void AddJoint(const Motion& motion) {
    Transform(false);
    const Joints angles = ToController(settings_.axes, *motion.q) * kDegPerRad;
    std::string line = "G0";
    for (int i = 0; i < 6; ++i) {
      line += fmt::format(" {}={}", settings_.axis_names[i], Fixed(angles[i], kAngleDecimals));
    }
    Line(line);
  }

  /// Switches the robot transformation: axes are addressed by themselves only without it.
  void Transform(bool on) {
    if (on == transformed_) return;
    Line(on ? "TRAORI" : "TRAFOOF");
    transformed_ = on;
    cartesian_ = false;
  }

  std::string Words(const Motion& motion) const {
    const Eigen::Vector3d p = motion.X_PT.translation();
    const Eigen::Vector3d abc = Angles(motion);
    return fmt::format("X{} Y{} Z{} A={} B={} C={}", Fixed(p.x(), kLengthDecimals),
                       Fixed(p.y(), kLengthDecimals), Fixed(p.z(), kLengthDecimals),
                       Fixed(abc[0], kAngleDecimals), Fixed(abc[1], kAngleDecimals),
                       Fixed(abc[2], kAngleDecimals));
  }

  Eigen::Vector3d Angles(const Motion& motion) const {
    return SinumerikAngles(settings_.rotation, motion.X_PT.linear() * settings_.R_TC) * kDegPerRad;
  }

  int TurnOf(const Motion& motion) const {
    if (!motion.q) return *motion.turn;
    Pose X_PT = motion.X_PT;
    Eigen::Vector3d abc = Angles(motion);
    for (int i = 0; i < 3; ++i) {
      X_PT.translation()[i] = Rounded(X_PT.translation()[i], kLengthDecimals);
      abc[i] = Rounded(abc[i], kAngleDecimals) * kRadPerDeg;
    }
    X_PT.linear() = FromSinumerikAngles(settings_.rotation, abc) * settings_.R_TC.transpose();
    const Pose X_BF = *program_.X_BP * X_PT * program_.X_FT.value_or(settings_.X_FT).inverse();
    return TurnAsWritten(arm_, settings_.axes, X_BF, *motion.status, *motion.q);
  }

  void Event(const ProgramEvent& event) {
    switch (event.kind) {
      case ProgramEvent::Kind::kPassBegin:
        Line(fmt::format("MSG(\"PASS {} PIECE {}\")", Fixed(event.value, 0), event.piece));
        break;
      case ProgramEvent::Kind::kPassEnd:
        Line(fmt::format("MSG(\"END OF PASS {} PIECE {}\")", Fixed(event.value, 0), event.piece));
        break;
      case ProgramEvent::Kind::kSpindleOn:
      case ProgramEvent::Kind::kSpindleOff:
        for (const std::string& line : templates_.Lines(event)) Line(line);
        break;
    }
  }

  const MotionProgram& program_;
  const Arm& arm_;
  const PostSettings& settings_;
  Templates templates_;
  std::string text_;
  std::string feed_;
  bool transformed_ = false;  // TRAORI holds
  bool cartesian_ = false;    // CP holds, not PTP
};

}  // namespace

std::map<std::string, std::string> SinumerikTexts() {
  return {{"spindle_on", "S{rpm} M3"}, {"spindle_off", "M5"}};
}

Eigen::Vector3d SinumerikAngles(const std::string& rotation, const Eigen::Matrix3d& R) {
  return rotation == "rpy" ? Eigen::Vector3d(AnglesZyx(R).reverse()) : AnglesZxz(R);
}

Eigen::Matrix3d FromSinumerikAngles(const std::string& rotation, const Eigen::Vector3d& abc) {
  return rotation == "rpy" ? FromAnglesZyx(abc.reverse()) : FromAnglesZxz(abc);
}

ProgramFiles SinumerikPost::Write(const MotionProgram& program, const Arm& arm,
                                  const PostSettings& settings) const {
  assert(IsWellFormed(program));
  return SinumerikWriter(program, arm, settings).Write();
}

}  // namespace millpose
