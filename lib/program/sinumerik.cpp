// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/sinumerik.hpp"

#include <cassert>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/sections.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

constexpr size_t kLongestName = 24;
constexpr int kLengthDecimals = 4;
constexpr int kAngleDecimals = 6;

class SinumerikWriter {
 public:
  SinumerikWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings)
      : program_(program),
        arm_(arm),
        settings_(settings),
        templates_(SinumerikTexts(), settings.texts, settings.tool_name) {}

  ProgramFiles Write() {
    Walk(program_, {[&] { Begin(); }, [&](const ProgramEvent& event) { Event(event); },
                    [&](size_t i) { AddMotion(program_.motions[i]); }});
    const std::string name = LegalName(program_.name, kLongestName, 2);
    ProgramFiles files;
    std::string main = Head();
    const std::vector<std::string> parts = Pack(sections_, settings_.max_motions, settings_.max_bytes);
    for (size_t i = 0; i < parts.size(); ++i) {
      const std::string part = SubprogramName(name, i, kLongestName);
      files[part + ".spf"] = parts[i] + "M17\n";
      main += part + "\n";
    }
    Transform(false);
    for (size_t i = parts.empty() ? 0 : sections_.size() - 1; i < sections_.size(); ++i)
      main += sections_[i].text;
    main += "CYCLE832(0,_OFF,1)\n";
    for (const std::string& line : templates_.Lines("footer")) main += line + "\n";
    files[name + ".mpf"] = main + "M30\n";
    return files;
  }

 private:
  void Line(const std::string& line) { sections_.back().text += line + "\n"; }

  /// States every modal setting again, so that a section can be entered.
  void Begin() {
    sections_.emplace_back();
    feed_.clear();
    transformed_.reset();
    cartesian_ = false;
  }

  std::string Head() const {
    std::string head;
    const auto add = [&](const std::string& line) { head += line + "\n"; };
    add("; written by millpose for SINUMERIK 840D sl with robot transformation; mm, degrees");
    add(settings_.rotation == "rpy" ? "; orientation rpy: C about Z, B about new Y, A about new X"
                                    : "; orientation euler: A about Z, B about new X, C about new Z");
    for (const auto& [key, value] : program_.header) add(fmt::format("; {}: {}", key, value));
    Pose X_FC = program_.X_FT.value_or(settings_.X_FT);
    X_FC.linear() = X_FC.linear() * settings_.R_TC;
    const Eigen::Vector3d t = X_FC.translation();
    const Eigen::Vector3d abc = SinumerikAngles(settings_.rotation, X_FC.linear()) * kDegPerRad;
    add(fmt::format("; TOOL {} in the flange: X{} Y{} Z{} A={} B={} C={}", settings_.tool_name,
                    Fixed(t.x(), 4), Fixed(t.y(), 4), Fixed(t.z(), 4), Fixed(abc[0], 4), Fixed(abc[1], 4),
                    Fixed(abc[2], 4)));
    add("G17 G710 G40 G90 G94");
    for (const std::string& line : templates_.Lines("tool_change")) add(line);
    if (program_.X_BP) add(Frame(*program_.X_BP));
    add("G54");
    add("ORIWKS");
    add(fmt::format("CYCLE832({},_FINISH,0.1)", Fixed(settings_.blend, 4)));
    add("G642");
    for (const std::string& line : templates_.Lines("header")) add(line);
    return head;
  }

  static std::string Frame(const Pose& X_BP) {
    const Eigen::Vector3d p = X_BP.translation();
    const Eigen::Vector3d zyx = AnglesZyx(X_BP.linear()) * kDegPerRad;
    return fmt::format("$P_UIFR[1]=CTRANS(X,{},Y,{},Z,{}):CROT(X,{},Y,{},Z,{})",
                       Fixed(p.x(), kLengthDecimals), Fixed(p.y(), kLengthDecimals),
                       Fixed(p.z(), kLengthDecimals), Fixed(zyx[2], kAngleDecimals),
                       Fixed(zyx[1], kAngleDecimals), Fixed(zyx[0], kAngleDecimals));
  }

  void AddMotion(const Motion& motion) {
    ++sections_.back().motions;
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
    if (transformed_ == on) return;
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
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) {
      Line(fmt::format("PASS_{}_{}:", Fixed(event.value, 0), event.piece));
      Line(fmt::format("MSG(\"{}\")", place));
    } else if (event.kind == ProgramEvent::Kind::kPassEnd) {
      Line(fmt::format("MSG(\"END OF {}\")", place));
    }
    for (const std::string& line : templates_.Lines(event)) Line(line);
  }

  const MotionProgram& program_;
  const Arm& arm_;
  const PostSettings& settings_;
  Templates templates_;
  std::vector<Section> sections_;
  std::string feed_;
  std::optional<bool> transformed_;  // TRAORI holds
  bool cartesian_ = false;           // CP holds, not PTP
};

}  // namespace

std::map<std::string, std::string> SinumerikTexts() {
  return {{"spindle_on", "S{rpm} M3"}, {"spindle_off", "M5"}, {"tool_change", "T=\"{tool}\" D1\nM6"}};
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
