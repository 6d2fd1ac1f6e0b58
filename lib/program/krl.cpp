// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl.hpp"

#include <cassert>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/sections.hpp"
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
      : program_(program),
        arm_(arm),
        settings_(settings),
        templates_(KrlTexts(), settings.texts, settings.tool_name) {}

  ProgramFiles Write() {
    Walk(program_, {[&] { Begin(); }, [&](const ProgramEvent& event) { Event(event); },
                    [&](size_t i) { AddMotion(i); }});
    const std::string name = LegalName(program_.name, kLongestName, 1);
    ProgramFiles files;
    std::string main = Head(name);
    const std::vector<std::string> parts = Pack(sections_, settings_.max_motions, settings_.max_bytes);
    for (size_t i = 0; i < parts.size(); ++i) {
      const std::string part = SubprogramName(name, i, kLongestName);
      files[part + ".src"] = fmt::format("{}DEF {} ( )\n{}END\n", kHead, part, parts[i]);
      main += part + " ( )\n";
    }
    for (size_t i = parts.empty() ? 0 : sections_.size() - 1; i < sections_.size(); ++i)
      main += sections_[i].text;
    for (const std::string& line : templates_.Lines("footer")) main += line + "\n";
    files[name + ".src"] = main + "END\n";
    files[name + ".dat"] = Data(name);
    return files;
  }

 private:
  void Line(const std::string& line) { sections_.back().text += line + "\n"; }

  void Begin() {
    sections_.emplace_back();
    feed_.clear();
  }

  std::string Head(const std::string& name) const {
    std::string head = kHead;
    const auto add = [&](const std::string& line) { head += line + "\n"; };
    add(fmt::format("DEF {} ( )", name));
    add("; written by millpose for KUKA KRC4; mm, degrees; A about Z, B about new Y, C about new X");
    for (const auto& [key, value] : program_.header) add(fmt::format("; {}: {}", key, value));
    head += kIni;
    if (settings_.base_number > 0) {
      add(fmt::format("$BASE = BASE_DATA[{}]", settings_.base_number));
    } else if (program_.X_BP) {
      add(fmt::format("$BASE = {{FRAME: {}}}", PoseFields(*program_.X_BP, kAngleDecimals)));
    }
    if (settings_.tool_number > 0) {
      add(fmt::format("$TOOL = TOOL_DATA[{}]", settings_.tool_number));
    } else if (program_.X_FT) {
      Pose X_FC = *program_.X_FT;
      X_FC.linear() = X_FC.linear() * settings_.R_TC;
      add(fmt::format("$TOOL = {{FRAME: {}}}", PoseFields(X_FC, kAngleDecimals)));
    }
    add("$ORI_TYPE = #VAR");
    add("$ADVANCE = 5");
    add(fmt::format("$APO.CDIS = {}", Fixed(settings_.blend, 4)));
    add(fmt::format("BAS (#VEL_PTP,{} )", Fixed(settings_.ptp_share * 100, 0)));
    for (const std::string& line : templates_.Lines("header")) add(line);
    for (const std::string& line : templates_.Lines("tool_change")) add(line);
    return head;
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

  void AddMotion(size_t i) {
    const Motion& motion = program_.motions[i];
    ++sections_.back().motions;
    if (motion.type == MotionType::kLinear) {
      AddLinear(motion);
    } else if (motion.status) {
      Line(fmt::format("PTP {{{},S {},T {}{}}}", PoseFields(ToolInBase(motion), kEntryDecimals),
                       Binary(*motion.status, 3), Binary(TurnOf(motion), 6), External()));
    } else {
      const Joints angles = ToController(settings_.axes, *motion.q) * kDegPerRad;
      std::string fields;
      for (int k = 0; k < 6; ++k)
        fields += fmt::format("{}A{} {}", k ? "," : "", k + 1, Fixed(angles[k], kAngleDecimals));
      Line(fmt::format("PTP {{{}{}}}", fields, External()));
    }
  }

  void AddLinear(const Motion& motion) {
    const std::string target =
        fmt::format("{{{}{}}}", PoseFields(ToolInBase(motion), kAngleDecimals), External());
    if (settings_.spline && !motion.exact && !in_spline_) {
      Feed(motion.feed);
      Line("SPLINE");
      in_spline_ = true;
    }
    if (!in_spline_) {
      Feed(motion.feed);
      Line(fmt::format("LIN {}{}", target, motion.exact ? "" : " C_DIS"));
      return;
    }
    // Within the block the feed is that set before it, or the segment's own.
    const std::string feed = FeedText(motion.feed);
    Line(fmt::format("  SLIN {}{}", target, feed == feed_ ? "" : " WITH $VEL.CP = " + feed));
    if (!motion.exact) return;
    Line("ENDSPLINE");
    in_spline_ = false;
  }

  /// The constant external axes, as fields.
  std::string External() const {
    std::string fields;
    for (size_t i = 0; i < settings_.external.size(); ++i) {
      fields += fmt::format(",E{} {}", i + 1, Fixed(settings_.external[i], kLengthDecimals));
    }
    return fields;
  }

  int TurnOf(const Motion& motion) const {
    if (!motion.q || !program_.X_BP) return *motion.turn;
    Pose X_PT = ToolInBase(motion);
    Eigen::Vector3d abc = AnglesZyx(X_PT.linear()) * kDegPerRad;
    for (int i = 0; i < 3; ++i) {
      X_PT.translation()[i] = Rounded(X_PT.translation()[i], kLengthDecimals);
      abc[i] = Rounded(abc[i], kEntryDecimals) * kRadPerDeg;
    }
    X_PT.linear() = FromAnglesZyx(abc) * settings_.R_TC.transpose();
    const Pose X_BF = *program_.X_BP * X_PT * program_.X_FT.value_or(settings_.X_FT).inverse();
    return TurnAsWritten(arm_, settings_.axes, X_BF, *motion.status, *motion.q);
  }

  static std::string FeedText(double feed) { return Fixed(feed / 1000, 8); }  // $VEL.CP is in m/s

  void Feed(double feed) {
    const std::string text = FeedText(feed);
    if (text == feed_) return;
    feed_ = text;
    Line("$VEL.CP = " + text);
  }

  void Event(const ProgramEvent& event) {
    if (event.kind == ProgramEvent::Kind::kPassBegin) {
      Line(fmt::format(";FOLD PASS {} PIECE {}", Fixed(event.value, 0), event.piece));
    } else if (event.kind == ProgramEvent::Kind::kPassEnd) {
      Line(fmt::format(";ENDFOLD (PASS {} PIECE {})", Fixed(event.value, 0), event.piece));
    }
    for (const std::string& line : templates_.Lines(event)) Line(line);
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
  std::vector<Section> sections_;
  std::string feed_;
  bool in_spline_ = false;
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
