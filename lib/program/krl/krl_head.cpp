// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl_head.hpp"

#include "base/units.hpp"
#include "machine/robot/make_pose.hpp"
#include "program/controller_axes.hpp"
#include "program/krl/krl.hpp"
#include "program/pose_text.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

using krl::kAngleDecimals;
using krl::kLengthDecimals;
// How far the controller's frame may be from the cell's; REAL has 24 bits.
constexpr const char* kLength = "0.01";  // mm
constexpr const char* kAngle = "0.001";  // degrees

/// Data of the check and of its message (KRL's types for user messages, KSS 8).
constexpr const char* kDeclarations =
    "DECL FRAME MP_OFF\n"
    "DECL KRLMSG_T MP_MSG\n"
    "DECL KRLMSGPAR_T MP_PAR[3]\n"
    "DECL KRLMSGOPT_T MP_OPT\n"
    "DECL INT MP_ID\n";

/// Compares as frames, not number by number: angles are not unique (C 180 and C -180, all of them at B 90).
/// The loop keeps a start key from going on.
std::string CheckOf(const std::string& name, const Pose& assumed) {
  std::string text = fmt::format("MP_OFF = {{FRAME: {}}}\nMP_OFF = INV_POS(MP_OFF):{}\n",
                                 KrlFields(assumed, kAngleDecimals), name);
  for (int i = 1; i <= 3; ++i) text += fmt::format("MP_PAR[{}] = {{PAR_TYPE #EMPTY}}\n", i);
  std::vector<std::string> lengths, angles;
  for (const char axis : {'X', 'Y', 'Z'}) lengths.push_back(fmt::format("ABS(MP_OFF.{})>{}", axis, kLength));
  for (const char axis : {'A', 'B', 'C'}) angles.push_back(fmt::format("ABS(MP_OFF.{})>{}", axis, kAngle));
  for (const auto& terms : {lengths, angles}) {
    text += fmt::format("IF ({}) THEN\n", fmt::join(terms, ") OR ("));
    text += fmt::format(
        "MP_MSG = {{MODUL[] \"millpose\",NR 1,MSG_TXT[] \"{} is not as assumed: see the head\"}}\n", name);
    text +=
        "MP_OPT = {VL_STOP TRUE,CLEAR_P_RESET TRUE,CLEAR_P_SAW FALSE,LOG_TO_DB TRUE}\n"
        "MP_ID = SET_KRLMSG(#QUIT,MP_MSG,MP_PAR[],MP_OPT)\n"
        "LOOP\nHALT\nENDLOOP\nENDIF\n";
  }
  return text;
}

/// Which of the controller's own frames the program uses, where it uses one.
std::string Numbered(const char* list, int number) {
  return number > 0 ? fmt::format("{}[{}] must hold: ", list, number) : std::string();
}

std::string LoadText(const ToolLoad& load) {
  const auto three = [](const Eigen::Vector3d& v, int decimals) {
    return fmt::format("{} {} {}", Fixed(v.x(), decimals), Fixed(v.y(), decimals), Fixed(v.z(), decimals));
  };
  return fmt::format("M {} kg, CM {} mm, J {} kg m2", Fixed(load.mass, 3), three(load.centre, 1),
                     three(load.inertia, 3));
}

}  // namespace

FrameTexts KrlPost::Frames(const PostSettings& settings) const {
  FrameTexts texts{Numbered("TOOL_DATA", options_.tool_number) + settings.tool_name + " in the flange",
                   Numbered("BASE_DATA", options_.base_number) + "workpiece in $WORLD",
                   {}};
  const std::string robroot = PoseText(KrlRobroot(options_));
  if (options_.ersysroot) {
    const KrlRail& rail = *options_.ersysroot;
    texts.more = {{"ersysroot", "assumed $ERSYSROOT: " + PoseText(MakePose(rail.pose))},
                  {"rail", fmt::format("{} along {} of it, the robot on the carriage:", KrlCarriage(settings),
                                       WordOf(kFrameAxisWords, rail.direction))},
                  {"carriage", robroot}};
  } else {
    texts.more = {{"robroot", "assumed $ROBROOT: " + robroot}};
  }
  if (options_.external_base) {
    const KrlTable& table = *options_.external_base;
    texts.more.emplace_back(fmt::format("machine_def_{}", table.machine_def),
                            "assumed ROOT: " + PoseText(MakePose(table.root)));
    texts.more.emplace_back("table", "what turns, in that root: " + PoseText(MakePose(table.flange)));
  }
  if (settings.load) texts.more.emplace_back("load", LoadText(*settings.load));
  return texts;
}

std::array<std::string, 6> KrlWords(const Pose& pose, int decimals) {
  const Eigen::Vector3d abc = AnglesZyx(pose.linear()) * kDegPerRad;
  std::array<std::string, 6> words;
  for (int i = 0; i < 6; ++i)
    words[static_cast<size_t>(i)] =
        fmt::format("{} {}", "XYZABC"[i],
                    i < 3 ? Short(pose.translation()[i], kLengthDecimals) : Short(abc[i - 3], decimals));
  return words;
}

std::string KrlFields(const Pose& pose, int decimals) {
  return fmt::format("{}", fmt::join(KrlWords(pose, decimals), ","));
}

std::string KrlTableBase(const KrlTable& table) {
  return fmt::format("EK(MACHINE_DEF[{0}].ROOT,MACHINE_DEF[{0}].MECH_TYPE,", table.machine_def);
}

std::string KrlDeclarations() { return kDeclarations; }

std::string KrlNotice(const std::string& notice) {
  std::string text;
  for (int i = 1; i <= 3; ++i) text += fmt::format("MP_PAR[{}] = {{PAR_TYPE #EMPTY}}\n", i);
  text += fmt::format("MP_MSG = {{MODUL[] \"millpose\",NR 2,MSG_TXT[] \"{}\"}}\n", notice);
  text +=
      "MP_OPT = {VL_STOP FALSE,CLEAR_P_RESET TRUE,CLEAR_P_SAW FALSE,LOG_TO_DB TRUE}\n"
      "MP_ID = SET_KRLMSG(#NOTIFY,MP_MSG,MP_PAR[],MP_OPT)\n";
  return text;
}

std::string KrlFrameCheck(const KrlOptions& options) {
  std::string text = options.ersysroot ? CheckOf("$ERSYSROOT", MakePose(options.ersysroot->pose))
                                       : CheckOf("$ROBROOT", KrlRobroot(options));
  if (options.external_base)
    text += CheckOf(fmt::format("MACHINE_DEF[{}].ROOT", options.external_base->machine_def),
                    MakePose(options.external_base->root));
  return text;
}

std::string KrlLoad(const KrlOptions& options, const PostSettings& settings) {
  if (!options.WritesLoad() || !settings.load) return {};
  const ToolLoad& load = *settings.load;
  const auto three = [](const Eigen::Vector3d& v) {
    return fmt::format("X {},Y {},Z {}", Short(v.x(), 4), Short(v.y(), 4), Short(v.z(), 4));
  };
  return fmt::format("$LOAD = {{M {},CM {{{},A 0,B 0,C 0}},J {{{}}}}}", Short(load.mass, 3),
                     three(load.centre), three(load.inertia));
}

size_t KrlLines(const std::string& text, const std::vector<std::string_view>& lines, size_t first) {
  size_t line = first;
  for (const std::string_view wanted : SplitLines(text)) {
    while (line > first && line < lines.size() && Trim(lines[line]).empty()) ++line;
    if (line == lines.size() || Spelled(lines[line]) != Spelled(wanted)) return 0;
    ++line;
  }
  return line - first;
}

}  // namespace millpose
