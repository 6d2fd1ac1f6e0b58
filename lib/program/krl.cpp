// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl.hpp"

#include <cassert>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

constexpr size_t kLongestName = 24;
constexpr int kLengthDecimals = 4;  // 0.00005 mm per coordinate
constexpr int kAngleDecimals = 6;   // of a degree: 0.00005 mm at 3 m
constexpr int kEntryDecimals = 4;   // A, B, C of a PTP with S and T: the line stays within 100 columns

constexpr const char* kHead =
    "&ACCESS RVP\n&REL 1\n&PARAM TEMPLATE = C:\\KRC\\Roboter\\Template\\vorgabe\n&PARAM EDITMASK = *\n";

constexpr const char* kIni =
    ";FOLD INI\n"
    "  ;FOLD BASISTECH INI\n"
    "    GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )\n"
    "    INTERRUPT ON 3\n"
    "    BAS (#INITMOV,0 )\n"
    "  ;ENDFOLD (BASISTECH INI)\n"
    ";ENDFOLD (INI)\n";

std::string Binary(int bits, int digits) { return fmt::format("'B{:0{}b}'", bits, digits); }

class KrlWriter {
 public:
  KrlWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings)
      : program_(program), arm_(arm), settings_(settings), templates_(KrlTexts(), settings.texts) {}

  ProgramFiles Write() {
    const std::string name = LegalName(program_.name, kLongestName, 1);
    Head(name);
    size_t event = 0;
    for (size_t i = 0; i <= program_.motions.size(); ++i) {
      for (; event < program_.events.size() && program_.events[event].before_motion == i; ++event) {
        Event(program_.events[event]);
      }
      if (i < program_.motions.size()) AddMotion(program_.motions[i]);
    }
    text_ += "END\n";
    return {{name + ".src", text_}, {name + ".dat", Data(name)}};
  }

 private:
  void Line(const std::string& line) { text_ += line + "\n"; }

  void Head(const std::string& name) {
    text_ = kHead;
    Line(fmt::format("DEF {} ( )", name));
    Line("; written by millpose for KUKA KRC4; mm, degrees; A about Z, B about new Y, C about new X");
    for (const auto& [key, value] : program_.header) Line(fmt::format("; {}: {}", key, value));
    text_ += kIni;
    if (program_.X_BP) Line(fmt::format("$BASE = {{FRAME: {}}}", PoseFields(*program_.X_BP, kAngleDecimals)));
    if (program_.X_FT) {
      Pose X_FC = *program_.X_FT;
      X_FC.linear() = X_FC.linear() * settings_.R_TC;
      Line(fmt::format("$TOOL = {{FRAME: {}}}", PoseFields(X_FC, kAngleDecimals)));
    }
    Line("$ORI_TYPE = #VAR");
    Line("$ADVANCE = 5");
    Line(fmt::format("$APO.CDIS = {}", Fixed(settings_.blend, 4)));
    Line(fmt::format("BAS (#VEL_PTP,{} )", Fixed(settings_.ptp_share * 100, 0)));
  }

  static std::string PoseFields(const Pose& pose, int decimals) {
    const Eigen::Vector3d p = pose.translation();
    const Eigen::Vector3d abc = AnglesZyx(pose.linear()) * kDegPerRad;
    return fmt::format("X {},Y {},Z {},A {},B {},C {}", Fixed(p.x(), kLengthDecimals),
                       Fixed(p.y(), kLengthDecimals), Fixed(p.z(), kLengthDecimals), Fixed(abc[0], decimals),
                       Fixed(abc[1], decimals), Fixed(abc[2], decimals));
  }

  Pose ToolInBase(const Motion& motion) const {
    Pose X_PC = motion.X_PT;
    X_PC.linear() = X_PC.linear() * settings_.R_TC;
    return X_PC;
  }

  void AddMotion(const Motion& motion) {
    if (motion.type == MotionType::kLinear) {
      Feed(motion.feed);
      Line(fmt::format("LIN {{{}}}{}", PoseFields(ToolInBase(motion), kAngleDecimals),
                       motion.exact ? "" : " C_DIS"));
    } else if (motion.status) {
      Line(fmt::format("PTP {{{},S {},T {}}}", PoseFields(ToolInBase(motion), kEntryDecimals),
                       Binary(*motion.status, 3), Binary(TurnOf(motion), 6)));
    } else {
      const Joints angles = ToController(settings_.axes, *motion.q) * kDegPerRad;
      std::string fields;
      for (int i = 0; i < 6; ++i)
        fields += fmt::format("{}A{} {}", i ? "," : "", i + 1, Fixed(angles[i], kAngleDecimals));
      Line(fmt::format("PTP {{{}}}", fields));
    }
  }

  int TurnOf(const Motion& motion) const {
    if (!motion.q) return *motion.turn;
    Pose X_PT = ToolInBase(motion);
    Eigen::Vector3d abc = AnglesZyx(X_PT.linear()) * kDegPerRad;
    for (int i = 0; i < 3; ++i) {
      X_PT.translation()[i] = Rounded(X_PT.translation()[i], kLengthDecimals);
      abc[i] = Rounded(abc[i], kEntryDecimals) * kRadPerDeg;
    }
    X_PT.linear() = FromAnglesZyx(abc) * settings_.R_TC.transpose();
    const Pose X_BF = *program_.X_BP * X_PT * program_.X_FT->inverse();
    return TurnAsWritten(arm_, settings_.axes, X_BF, *motion.status, *motion.q);
  }

  void Feed(double feed) {
    const std::string text = Fixed(feed / 1000, 8);  // $VEL.CP is in m/s
    if (text == feed_) return;
    feed_ = text;
    Line("$VEL.CP = " + text);
  }

  void Event(const ProgramEvent& event) {
    switch (event.kind) {
      case ProgramEvent::Kind::kPassBegin:
        Line(fmt::format(";FOLD PASS {} PIECE {}", Fixed(event.value, 0), event.piece));
        break;
      case ProgramEvent::Kind::kPassEnd:
        Line(fmt::format(";ENDFOLD (PASS {} PIECE {})", Fixed(event.value, 0), event.piece));
        break;
      case ProgramEvent::Kind::kSpindleOn:
      case ProgramEvent::Kind::kSpindleOff:
        for (const std::string& line : templates_.Lines(event)) Line(line);
        break;
    }
  }

  static std::string Data(const std::string& name) {
    return fmt::format(
        "{}DEFDAT {}\n;FOLD EXTERNAL DECLARATIONS\n  ;FOLD BASISTECH EXT\n"
        "    EXT BAS (BAS_COMMAND :IN,REAL :IN )\n    DECL INT SUCCESS\n  ;ENDFOLD (BASISTECH "
        "EXT)\n;ENDFOLD\n"
        "ENDDAT\n",
        kHead, name);
  }

  const MotionProgram& program_;
  const Arm& arm_;
  const PostSettings& settings_;
  Templates templates_;
  std::string text_;
  std::string feed_;
};

}  // namespace

std::map<std::string, std::string> KrlTexts() {
  return {{"spindle_on", "; SPINDLE ON {rpm} 1/min: switch it on, then start again\nHALT"},
          {"spindle_off", "; SPINDLE OFF: switch it off, then start again\nHALT"}};
}

ProgramFiles KrlPost::Write(const MotionProgram& program, const Arm& arm,
                            const PostSettings& settings) const {
  assert(IsWellFormed(program));
  return KrlWriter(program, arm, settings).Write();
}

}  // namespace millpose
