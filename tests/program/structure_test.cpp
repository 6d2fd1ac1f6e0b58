// SPDX-License-Identifier: GPL-3.0-or-later
// The shape of the texts, by expressions written from the controllers' manuals and apart from the readers:
// block structure, declarations before statements, fields, names, numbers, ASCII.
#include <gtest/gtest.h>

#include <regex>

#include "machine/robot/kinematics.hpp"
#include "program/economy.hpp"
#include "program/krl/krl.hpp"
#include "program/scanner.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

const std::string kReal = "-?[0-9]{1,6}\\.[0-9]{1,9}";

/// What is wrong with a text: "line: text", empty when nothing is.
using Complaints = std::vector<std::string>;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  for (const std::string_view line : SplitLines(text)) lines.emplace_back(line);
  return lines;
}

void ComplainAboutCharacters(const std::string& text, Complaints& complaints) {
  for (const char c : text) {
    if (c != '\n' && (c < ' ' || c > '~'))
      complaints.push_back(fmt::format("character {}", static_cast<int>(c)));
  }
  for (const std::string& line : Lines(text)) {
    static const std::regex external(",E[1-6] [-0-9.]+");
    if (std::regex_replace(line, external, "").size() > 100) complaints.push_back("long: " + line);
    // A number with a comma, without digits before its point, or with an exponent.
    static const std::regex odd("(^|[ ={,XYZABCF])(-?\\.[0-9]|-?[0-9.]+[eE][-+0-9]|--)");
    if (line[0] != ';' && std::regex_search(line, odd)) complaints.push_back("number: " + line);
  }
}

Complaints CheckKrl(const std::string& text, const std::string& name) {
  Complaints complaints;
  ComplainAboutCharacters(text, complaints);
  // Without zeros at its end, and without a point where nothing follows.
  const std::string number = "-?[0-9]{1,6}(?:\\.[0-9]{0,8}[1-9])?";
  const std::string pose = fmt::format("X {0},Y {0},Z {0},A {0},B {0},C {0}", number);
  const std::string external = fmt::format("(,E[1-6] {})*", number);
  const std::string axes = fmt::format("A1 {0},A2 {0},A3 {0},A4 {0},A5 {0},A6 {0}", number);
  const std::regex motion(
      fmt::format("PTP \\{{{0},S 'B[01]{{3}}',T 'B[01]{{6}}'{1}\\}}|PTP \\{{{2}{1}\\}}|"
                  "LIN \\{{({3},?)+{1}\\}}( C_DIS)?",
                  pose, external, axes, fmt::format("[XYZABC] {}", number)));
  const std::regex setting(
      fmt::format("\\$(BASE|TOOL) = \\{{FRAME: {0}\\}}|BAS \\(#(BASE|TOOL),[0-9]+ \\)|\\$ORI_TYPE = #VAR|"
                  "\\$ADVANCE = [0-5]|BAS \\(#VEL_PTP,[0-9]+ \\)|"
                  "\\$(VEL|ACC)\\.ORI[12] = {1}|\\$ACC\\.CP = {1}",
                  pose, number));
  const std::regex other(
      fmt::format("\\$VEL\\.CP = {0}|\\$APO\\.CDIS = {0}|PASS_[0-9]+_[0-9]+:|"
                  "TRIGGER WHEN DISTANCE=0 DELAY=-?[0-9]+ DO "
                  "\\$OUT\\[[0-9]+\\]=(TRUE|FALSE)|"
                  "\\$A?N?OUT\\[1\\]=[A-Z0-9]+|[A-Za-z0-9_]+ \\( \\)",
                  number));
  static const std::regex ini(
      " *(GLOBAL INTERRUPT DECL 3 WHEN \\$STOPMESS==TRUE DO IR_STOPM \\( \\)|INTERRUPT ON 3|"
      "BAS \\(#INITMOV,0 \\))");
  const std::regex define(fmt::format("DEF {} \\( \\)", name));
  if (!std::regex_match(name, std::regex("[A-Za-z][A-Za-z0-9_]{0,23}"))) complaints.push_back("name " + name);
  enum { kHead, kSettings, kStatements, kEnded } stage = kHead;
  int folds = 0;
  bool framed = false, tooled = false;
  for (const std::string& line : Lines(text)) {
    if (line.find(";FOLD") != std::string::npos) ++folds;
    if (line.find(";ENDFOLD") != std::string::npos && --folds < 0) complaints.push_back("fold: " + line);
    if (line.empty() || line[line.find_first_not_of(' ')] == ';') continue;
    if (stage == kHead && (line[0] == '&' || std::regex_match(line, define))) {
      if (line[0] != '&') stage = kSettings;
    } else if (stage == kSettings && (std::regex_match(line, setting) || std::regex_match(line, ini))) {
      framed = framed || line.starts_with("$BASE");
      tooled = tooled || line.starts_with("$TOOL");
    } else if (stage != kHead && stage != kEnded &&
               (std::regex_match(line, motion) || std::regex_match(line, other))) {
      stage = kStatements;
    } else if (stage == kStatements && line == "END") {
      stage = kEnded;
    } else {
      complaints.push_back(line);
    }
  }
  if (stage != kEnded) complaints.push_back("no END");
  if (folds != 0) complaints.push_back("folds left open");
  const bool sub = name.size() > 4 && std::regex_search(name, std::regex("_[0-9]{3}$"));
  if (!sub && !(framed && tooled)) complaints.push_back("no base or tool");
  return complaints;
}

Complaints CheckKrlData(const std::string& text, const std::string& name) {
  Complaints complaints;
  ComplainAboutCharacters(text, complaints);
  static const std::regex declaration(
      "&[A-Z]+ .*| *;(FOLD|ENDFOLD).*| *EXT BAS \\(BAS_COMMAND :IN,REAL :IN \\)| *DECL INT SUCCESS");
  std::vector<std::string> lines = Lines(text);
  int folds = 0;
  const auto begin = std::find(lines.begin(), lines.end(), "DEFDAT " + name);
  if (begin == lines.end() || lines.back() != "ENDDAT") return {"DEFDAT " + name + " … ENDDAT"};
  for (auto line = lines.begin(); line != lines.end() - 1; ++line) {
    if (line->find(";FOLD") != std::string::npos) ++folds;
    if (line->find(";ENDFOLD") != std::string::npos) --folds;
    const bool before = line < begin && line->front() != '&';
    if (line != begin && (before || !std::regex_match(*line, declaration))) complaints.push_back(*line);
  }
  if (folds != 0) complaints.push_back("folds left open");
  return complaints;
}

Complaints CheckSinumerik(const std::string& text, const std::string& name) {
  Complaints complaints;
  ComplainAboutCharacters(text, complaints);
  if (!std::regex_match(name, std::regex("[A-Za-z]{2}[A-Za-z0-9_]{0,22}")))
    complaints.push_back("name " + name);
  const std::string pose = fmt::format("X{0} Y{0} Z{0} A={0} B={0} C={0}", kReal);
  const std::regex block(fmt::format(
      "G0 {0} STAT='B[01]{{3}}' TU='B[01]{{6}}' PTP|(G9 )?G1 {0}( F{1})?( CP)?|"
      "G0 SUPA RA1={1} RA2={1} RA3={1} RA4={1} RA5={1} RA6={1}|TRAORI|TRAFOOF|COMPOF G642|M6|S[0-9.]+ M3|M5|"
      "G505 ORI(RPY|EULER) ORIVECT ORIWKS|"
      "G17 G710 G40 G90 G94|T=\"[A-Z0-9_]+\" D1|CYCLE832\\({1},_ORI_FINISH,{1}\\)|CYCLE832\\(0,_OFF,1\\)|"
      "WHEN TRUE DO \\$A_OUT\\[[0-9]+\\]=[01]|MSG\\(\"[A-Z0-9 "
      "]*\"\\)|[A-Z]{{2}}[A-Z0-9_]*:|[A-Za-z]{{2}}[A-Za-z0-9_]*_[0-9]{{3}}|"
      "\\$P_UIFR\\[5\\]=CTRANS\\(X,{1},Y,{1},Z,{1}\\):CROT\\(X,{1},Y,{1},Z,{1}\\)",
      pose, kReal));
  bool ended = false, transformed = false, point_to_point = false, framed = false;
  for (const std::string& line : Lines(text)) {
    if (line.empty() || line[0] == ';') continue;
    if (ended) complaints.push_back("after the end: " + line);
    if (line == "M30" || line == "M17") {
      ended = true;
    } else if (!std::regex_match(line, block)) {
      complaints.push_back(line);
    }
    if (line == "TRAORI" || line == "TRAFOOF") transformed = line == "TRAORI";
    if (line == "TRAORI" || line == "TRAFOOF") framed = false;
    if (line.starts_with("G505 ")) framed = true;
    const bool cartesian = line.find(" X") != std::string::npos && line.starts_with("G");
    if (cartesian && !transformed) complaints.push_back("without TRAORI: " + line);
    if (cartesian && !framed) complaints.push_back("without its frame: " + line);
    if (line.find(" RA1") != std::string::npos && transformed) complaints.push_back("with TRAORI: " + line);
    if (line.ends_with(" PTP")) point_to_point = true;
    if (line.ends_with(" CP")) point_to_point = false;
    if (cartesian && point_to_point && line.find("G1") != std::string::npos)
      complaints.push_back("G1 by PTP: " + line);
  }
  if (!ended) complaints.push_back("no end");
  return complaints;
}

Complaints CheckLinuxCnc(const std::string& text, const std::string&) {
  Complaints complaints;
  ComplainAboutCharacters(text, complaints);
  const std::string axes = fmt::format("X{0} Y{0} Z{0} A{0} B{0} C{0}", kReal);
  const std::regex block(fmt::format(
      "G0 {0}|G1 {0}( F{1})?|G10 L2 P9 X0 Y0 Z0 A0 B0 C0 R0|G59\\.3 G92\\.1|M6[23] P[0-9]+|M68 E3 Q[01]|"
      "M66 E0 L0|G21 G90 G17 G40 G49 G94|G9[34]|G61\\.1|G64 P{1} Q0|S[0-9.]+ M3|M5",
      axes, kReal));
  bool ended = false;
  for (const std::string& line : Lines(text)) {
    if (line.empty() || line[0] == ';') continue;
    if (ended) complaints.push_back("after the end: " + line);
    ended = line == "M2";
    if (!ended && !std::regex_match(line, block)) complaints.push_back(line);
  }
  if (!ended) complaints.push_back("no end");
  return complaints;
}

Complaints Check(const std::string& controller, const std::string& file, const std::string& text) {
  const std::string name = file.substr(0, file.rfind('.'));
  if (file.ends_with(".dat")) return CheckKrlData(text, name);
  if (controller == "krl") return CheckKrl(text, name);
  return controller == "sinumerik" ? CheckSinumerik(text, name) : CheckLinuxCnc(text, name);
}

TEST(Structure, EveryTextIsWellFormed) {
  const PlanResult plan = SamplePlan({.wall_turn_deg = -75, .wall_yaw_deg = 12, .tilt_deg = 7});
  MotionOptions options;
  options.header = {{"tool", "spindle \xc3\xbc"}, {"base", std::string(200, 'x')}};
  options.approach_feed = options.retract_feed = 20;
  options.approach_slow = 5;
  options.outputs = {{3, true, 0.02, true}, {3, false, 0, false}};
  for (const std::string variant :
       {"krl", "sinumerik", "sinumerik_euler", "linuxcnc", "linuxcnc_cartesian"}) {
    for (const int most : {5, 12, 1400}) {
      PostSettings settings = SampleSettings(variant);
      settings.max_motions = most;
      settings.path_acceleration = 2000;
      std::unique_ptr<Post> post = SamplePost(variant);
      if (ControllerOf(variant) == "krl") {
        KrlOptions krl;
        if (most == 12)
          settings.controller_axes = {{"E1", "", AxisKind::kLinear, 100}, {"E2", "", AxisKind::kRotary, -20}};
        krl.orientation_acceleration = 10;
        post = std::make_unique<KrlPost>(krl);
      }
      MotionProgram program = MakeMotionProgram(plan, options);
      if (most == 5) AddHandovers(program, most);
      const std::string controller = ControllerOf(variant);
      for (const auto& [file, text] : post->Write(program, plan.arm, settings)) {
        EXPECT_EQ(Check(controller, file, text), Complaints{}) << variant << " " << file;
      }
    }
  }
}

/// The tool in the program's base at joint angles.
Pose PoseOf(const MotionProgram& program, const PlanResult& plan, const Joints& q) {
  return program.X_BP->inverse() * ForwardFlange(plan.arm, q) * plan.X_FT;
}

/// s that the motions with a feed take as a reader returns them.
double FeedSeconds(const MotionProgram& program) {
  double seconds = 0;
  for (size_t i = 1; i < program.motions.size(); ++i) {
    const Motion &from = program.motions[i - 1], &to = program.motions[i];
    if (to.duration > 0) seconds += to.duration;
    if (to.duration == 0 && to.feed > 0)
      seconds += (to.X_PT.translation() - from.X_PT.translation()).norm() / to.feed;
  }
  return seconds;
}

TEST(Structure, ThePlungeFeedHoldsTowardsTheMaterial) {
  PlanResult plan = SamplePlan({.points = 6, .spacing = 4, .ring = false, .passes = 1});
  for (const int lead_in : {0, 1}) plan.passes[0].points[lead_in].point.kind = PointKind::kLeadIn;
  const double cut = plan.passes[0].points[0].point.feed_rate;
  for (const double plunge : {0.0, 0.3 * cut, 4 * cut}) {
    for (const double approach : {0.5 * cut, 20 * cut}) {  // slower than the cut is honoured too
      MotionOptions options;
      options.plunge_feed = plunge;
      options.approach_feed = approach;
      options.approach_slow = 5;
      options.retract_feed = 10 * cut;
      const double towards = plunge > 0 ? plunge : cut;
      const double wanted =
          45 / approach + 5 / towards + 4 / std::min(cut, towards) + 16 / cut + 50 / (10 * cut);
      for (const std::string variant :
           {"krl", "sinumerik", "sinumerik_euler", "linuxcnc", "linuxcnc_cartesian"}) {
        const PostSettings settings = SampleSettings(variant);
        const auto post = SamplePost(variant);
        const ProgramFiles files = post->Write(MakeMotionProgram(plan, options), plan.arm, settings);
        MotionProgram read = post->Read(files, plan.arm, settings);
        // Where poses follow joints the way begins above the first point, 50 mm out.
        for (size_t i = 1; i < read.motions.size(); ++i)
          if (read.motions[i - 1].q && read.motions[i].type == MotionType::kLinear)
            read.motions[i - 1].X_PT = PoseOf(read, plan, *read.motions[i - 1].q);
        EXPECT_NEAR(FeedSeconds(read), wanted, 1e-3 * wanted)
            << variant << " plunge " << plunge / cut << " approach " << approach / cut;
      }
    }
  }
}

TEST(Structure, TheCheckerSeesFaults) {
  const PlanResult plan = SamplePlan();
  const std::vector<std::array<std::string, 3>> faults = {
      {"krl", "\nEND\n", "\n"},
      {"krl", "LIN {X ", "LIN {X,"},
      {"krl", "LIN {X ", "LIN {W "},
      {"krl", "\n$BASE", "\n; $BASE"},
      {"krl", "C_DIS", "C_VEL"},
      {"krl", ";ENDFOLD (PASS", "; ("},
      {"krl", "A1 0,", "A1 .0,"},
      {"krl", "DEF Sample", "DEF Simple"},
      {"krl", "$VEL.ORI1", "$VEL.ORI3"},
      {"sinumerik", "TRAORI\n", ""},
      {"sinumerik", " CP", ""},
      {"sinumerik", "G505 ORIRPY ORIVECT ORIWKS\n", ""},
      {"sinumerik", "G0 SUPA", "G0"},
      {"sinumerik", "M30", "M2"},
      {"sinumerik", "STAT='B", "STAT='H"},
      {"linuxcnc", "M2", ""},
      {"linuxcnc", "G1 X", "G1 X,"},
      {"linuxcnc", " F12", " G12"},
  };
  for (const auto& [controller, from, to] : faults) {
    ProgramFiles files =
        MakePost(controller)->Write(MakeMotionProgram(plan), plan.arm, SampleSettings(controller));
    std::string& text = files.rbegin()->second;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
    EXPECT_NE(Check(controller, files.rbegin()->first, text), Complaints{}) << controller << " " << from;
  }
}

}  // namespace
}  // namespace millpose
