// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/sinumerik/sinumerik.hpp"

#include <cassert>

#include "base/text.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/program_name.hpp"
#include "program/sinumerik/sinumerik_block.hpp"
#include "program/writer.hpp"

namespace millpose {
namespace {

constexpr size_t kLongestFile = 24;  // a name, without the file's ending
constexpr size_t kWidth = 100;
constexpr int kLengthDecimals = 4;
constexpr int kAngleDecimals = 6;

class SinumerikWriter : public ProgramWriter {
 public:
  SinumerikWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
                  const SinumerikOptions& options)
      : ProgramWriter(program, arm, settings, SinumerikTexts()), options_(options) {}

  ProgramFiles Write() {
    At(0);
    WriteSections();
    Transform(false);
    At(0);
    const std::string name = LegalName(program_.name, kProgramNameLength, 2);
    ProgramFiles files;
    std::string main = Head();
    const std::vector<std::string> parts = Parts();
    for (size_t i = 0; i < parts.size(); ++i) {
      const std::string part = SubprogramName(name, i, kLongestFile);
      files[part + ".spf"] = parts[i] + "M17\n";
      main += part + "\n";
    }
    files[name + ".mpf"] = main + MainText(parts) + "CYCLE832(0,_OFF,1)\n" + TextLines("footer") + "M30\n";
    return files;
  }

 private:
  /// What is written next belongs to motion `i`; the head states its frame.
  void At(size_t i) {
    if (i >= program_.motions.size()) return;
    motion_ = &program_.motions[i];
    if (i == 0) frame_ = Frame();
  }

  /// The workpiece as the transformation counts where the motion stands.
  std::optional<Pose> Frame() const {
    const std::optional<Pose> X_BP = motion_ ? FrameOf(program_, *motion_) : program_.X_BP;
    if (!X_BP) return std::nullopt;
    return AsCounted(settings_, motion_ ? motion_->external : ExternalPosition(), *X_BP);
  }

  void Begin() override {
    feed_.clear();
    transformed_.reset();
  }

  void Forget() override {
    Begin();
    frame_ = Frame();
  }

  std::string Head() const {
    std::string head;
    const auto add = [&](const std::string& line) { head += line + "\n"; };
    add("; written by millpose for SINUMERIK 840D sl with robot transformation; mm, degrees");
    add("; orientation " + TurningText());
    for (const std::string& line : MachineData()) add("; " + line);
    for (const std::string& text : HeaderTexts(kWidth - 2)) add("; " + text);
    Pose X_FC = X_FT_;
    X_FC.linear() = X_FC.linear() * settings_.R_TC();
    const Eigen::Vector3d t = X_FC.translation();
    const Eigen::Vector3d abc = ToolAngles(settings_.rotation, X_FC.linear()) * kDegPerRad;
    add(fmt::format("; TOOL {} in the flange: X{} Y{} Z{} {}", PlainAscii(settings_.tool_name),
                    Fixed(t.x(), 4), Fixed(t.y(), 4), Fixed(t.z(), 4), AngleWords(abc, 4)));
    if (!program_.notice.empty()) head += fmt::format("MSG(\"{}\")\n", program_.notice);
    const std::string settings = Settings();
    const size_t codes = settings.find('\n') + 1;  // the tool is changed before its frame is set
    return head + settings.substr(0, codes) + TextLines("tool_change") + settings.substr(codes) +
           TextLines("header");
  }

  std::string Settings() const override {
    std::string settings = "G17 G710 G40 G90 G94\n";
    if (const std::optional<Pose> frame = Frame()) settings += FrameLine(*frame) + "\n";
    return settings;
  }

  /// What the program takes for granted, to be compared with the control's machine data.
  std::vector<std::string> MachineData() const {
    const std::string angles = SinumerikAngleWord(settings_.rotation);
    // For ORIRPY2 no manual at hand gives a value of MD21100.
    const std::string by_data =
        settings_.rotation == AngleOrder::kRpy2
            ? "MD21100 for ORIRPY2"
            : fmt::format("MD21100 = {}", settings_.rotation == AngleOrder::kRpy ? 0 : 1);
    const std::string counting = !options_.ori_def_with_g_code   ? fmt::format("MD21102 = 1 or {}", by_data)
                                 : *options_.ori_def_with_g_code ? "MD21102 = 1"
                                                                 : "MD21102 = 0 and " + by_data;
    std::vector<std::string> lines = {
        fmt::format("ASSUMED {}: angles as {}; MD10600 = 1: frame angles Z, Y', X''", counting, angles),
        options_.ori_ipo_with_g_code
            ? fmt::format("ASSUMED MD21104 = {}: the tool turns as {} says, on a great circle",
                          *options_.ori_ipo_with_g_code ? 1 : 0,
                          *options_.ori_ipo_with_g_code ? "ORIVECT" : "ORIWKS")
            : "MD21104 not known: blocks are short enough for every way to turn the tool",
        fmt::format("ASSUMED G{} is for this program and overwritten; no basic frame; its origin is the "
                    "robot base",
                    options_.Frame())};
    if (HasCoordinatedMotions(program_))
      lines.emplace_back(
          "ASSUMED F counts along X, Y, Z alone (FGROUP); external axes move along in the same time");
    return lines;
  }

  /// What holds after each TRAORI anew: the control then deselects the frame, and rounding ends.
  void AddSettings() {
    Line(fmt::format("G{} {} ORIVECT ORIWKS", options_.Frame(), SinumerikAngleWord(settings_.rotation)));
    Line(fmt::format("CYCLE832({},_ORI_FINISH,{})", Fixed(settings_.blend, 4),
                     Fixed(settings_.orientation_blend * kDegPerRad, 4)));
    Line("COMPOF G642");
  }

  std::string FrameLine(const Pose& X_BP) const {
    const Eigen::Vector3d p = X_BP.translation();
    const Eigen::Vector3d zyx = AnglesZyx(X_BP.linear()) * kDegPerRad;
    return fmt::format("$P_UIFR[{}]=CTRANS(X,{},Y,{},Z,{}):CROT(X,{},Y,{},Z,{})", options_.Frame() - 500,
                       Fixed(p.x(), kLengthDecimals), Fixed(p.y(), kLengthDecimals),
                       Fixed(p.z(), kLengthDecimals), Fixed(zyx[2], kAngleDecimals),
                       Fixed(zyx[1], kAngleDecimals), Fixed(zyx[0], kAngleDecimals));
  }

  void AddMotion(size_t i) override {
    const Motion& motion = program_.motions[i];
    At(i);
    if (motion.type == MotionType::kLinear) {
      AddLinear(motion, CoordinatedMotions(program_, i));
    } else if (motion.status) {
      Transform(true);
      Line(fmt::format("G0 {} STAT='B{:03b}' TU='B{:06b}' PTP", Words(motion), options_.Stat(*motion.status),
                       TurnOf(motion)));
      cartesian_ = false;
    } else {
      AddJoint(motion);
    }
  }

  /// `rides`: external axes move along; they stand in the blocks in which they do.
  void AddLinear(const Motion& motion, bool rides) {
    Transform(true);
    std::string line = fmt::format("{}G1 {}", motion.exact ? "G9 " : "", Words(motion));
    if (rides) line += ExternalWords(motion, true);
    const std::string feed = Fixed(motion.feed * 60, 4);
    if (feed != feed_) line += " F" + feed;
    feed_ = feed;
    if (!cartesian_) line += " CP";
    cartesian_ = true;
    Line(line);
  }

  void AddJoint(const Motion& motion) {
    Transform(false);
    const Joints angles = settings_.axes.FromArm(*motion.q) * kDegPerRad;
    std::string line = "G0 SUPA";  // neither frame nor, where MD10760 says so, tool length act on the joints
    for (int i = 0; i < 6; ++i) {
      line += fmt::format(" {}={}", options_.axis_names[i], Fixed(angles[i], kAngleDecimals));
    }
    Line(line + ExternalWords(motion, false));
    angles_ = ToolAngles(settings_.rotation, motion.X_PT.linear() * settings_.R_TC());
  }

  std::string ExternalWords(const Motion& motion, bool coupled_alone) const {
    std::string words;
    for (const ControllerAxis& axis : settings_.controller_axes)
      if (axis.coupled || !coupled_alone)
        words += fmt::format(" {}={}", axis.name,
                             Fixed(ValueOf(settings_, axis, motion.external),
                                   IsRotary(settings_, axis) ? kAngleDecimals : kLengthDecimals));
    return words;
  }

  /// Switches the robot transformation: axes are addressed by themselves only without it.
  void Transform(bool on) {
    if (transformed_ == on) return;
    // At another station the workpiece stands elsewhere; the frame takes effect with its word behind TRAORI.
    if (const std::optional<Pose> frame = Frame(); on && frame && !(frame_ && SameFrame(*frame, *frame_))) {
      Line(FrameLine(*frame));
      frame_ = frame;
    }
    Line(on ? "TRAORI" : "TRAFOOF");
    transformed_ = on;
    cartesian_ = false;
    if (on) AddSettings();
  }

  std::string AngleWords(const Eigen::Vector3d& degrees, int decimals) const {
    std::vector<std::string> words;
    for (size_t i = 0; i < 3; ++i)
      words.push_back(
          fmt::format("{}={}", words_[i], Fixed(degrees[static_cast<Eigen::Index>(i)], decimals)));
    return fmt::format("{}", fmt::join(words, " "));
  }

  /// "ORIRPY: C2 about Z, B2 about new Y, A2 about new X".
  std::string TurningText() const {
    const auto& [a, b, c] = words_;
    const std::string group = SinumerikAngleWord(settings_.rotation);
    if (settings_.rotation == AngleOrder::kRpy)
      return fmt::format("{}: {} about Z, {} about new Y, {} about new X", group, c, b, a);
    if (settings_.rotation == AngleOrder::kRpy2)
      return fmt::format("{}: {} about X, {} about new Y, {} about new Z", group, a, b, c);
    return fmt::format("{}: {} about Z, {} about new X, {} about new Z", group, a, b, c);
  }

  std::string Words(const Motion& motion) {
    const Eigen::Vector3d p = motion.X_PT.translation();
    const Eigen::Vector3d abc = Angles(motion);
    angles_ = abc * kRadPerDeg;
    return fmt::format("X{} Y{} Z{} {}", Fixed(p.x(), kLengthDecimals), Fixed(p.y(), kLengthDecimals),
                       Fixed(p.z(), kLengthDecimals), AngleWords(abc, kAngleDecimals));
  }

  /// Degrees. Where A, B, C may run evenly each by itself, those that are nearest to the ones before.
  Eigen::Vector3d Angles(const Motion& motion) const {
    if (motion.angles) return *motion.angles * kDegPerRad;
    const Eigen::Matrix3d R = motion.X_PT.linear() * settings_.R_TC();
    const bool near = motion.type == MotionType::kLinear && angles_ && !options_.ori_ipo_with_g_code;
    return (near ? ToolAnglesNear(settings_.rotation, R, *angles_) : ToolAngles(settings_.rotation, R)) *
           kDegPerRad;
  }

  int TurnOf(const Motion& motion) const {
    Pose X_PC = motion.X_PT;
    Eigen::Vector3d abc = Angles(motion);
    for (int i = 0; i < 3; ++i) {
      X_PC.translation()[i] = Rounded(X_PC.translation()[i], kLengthDecimals);
      abc[i] = Rounded(abc[i], kAngleDecimals) * kRadPerDeg;
    }
    X_PC.linear() = FromToolAngles(settings_.rotation, abc);
    return TurnAt(motion, X_PC);
  }

  void Event(const ProgramEvent& event) override {
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) {
      Line(fmt::format("PASS_{}_{}:", Fixed(event.value, 0), event.piece));
      Line(fmt::format("MSG(\"{}\")", place));
    } else if (event.kind == ProgramEvent::Kind::kPassEnd) {
      Line(fmt::format("MSG(\"END OF {}\")", place));
    } else if (event.kind == ProgramEvent::Kind::kDwell) {
      Line("G4 F" + ShortestNumber(event.value));
    } else if (event.kind == ProgramEvent::Kind::kOutput) {
      // A synchronised action of one block: done when the next motion begins, without a stop.
      Line(fmt::format("WHEN TRUE DO $A_OUT[{}]={}", event.output.number, event.output.on ? 1 : 0));
    }
    AddTexts(event);
  }

  const SinumerikOptions& options_;
  const std::array<std::string, 3> words_ = options_.Words();
  const Motion* motion_ = nullptr;  // that is being written, or the first
  std::optional<Pose> frame_;       // as it was stated last
  std::string feed_;
  std::optional<Eigen::Vector3d> angles_;  // of the last pose, rad
  std::optional<bool> transformed_;        // TRAORI holds
  bool cartesian_ = false;                 // CP holds, not PTP
};

/// A, B, C that run evenly each by itself, the nearest of those that mean the same.
LineModel ByAngles(AngleOrder rotation, const Eigen::Matrix3d& R_TC) {
  return [rotation, R_TC](const Pose& from, const Pose& to) {
    const Eigen::Vector3d first = ToolAngles(rotation, from.linear() * R_TC);
    return ProgrammedLine(from.translation(), to.translation(), rotation, R_TC, first,
                          ToolAnglesNear(rotation, to.linear() * R_TC, first));
  };
}

}  // namespace

std::vector<LineModel> SinumerikPost::Lines(const PostSettings& settings) const {
  const Eigen::Vector3d direction = settings.R_TC() * Eigen::Vector3d::UnitZ();
  std::vector<LineModel> lines = {
      [direction](const Pose& from, const Pose& to) { return ProgrammedLine(from, to, direction); }};
  if (options_.ori_ipo_with_g_code) return lines;
  lines.push_back(ByAngles(settings.rotation, settings.R_TC()));
  lines.emplace_back([](const Pose& from, const Pose& to) { return ProgrammedLine(from, to); });
  return lines;
}

std::map<std::string, std::string> SinumerikTexts() {
  return {{"spindle_on", "S{rpm} M3"}, {"spindle_off", "M5"}, {"tool_change", "T=\"{tool}\" D1\nM6"}};
}

std::string SinumerikAngleWord(AngleOrder rotation) {
  std::string word = WordOf(kOrientationGroupWords, rotation);
  for (char& c : word) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return word;
}

std::vector<std::string> SinumerikPost::Assumptions(const PostSettings& settings) const {
  const auto words = options_.Words();
  return {fmt::format("{}=, {}=, {}= are the tool's angles by {} (the cell's orientation_words)", words[0],
                      words[1], words[2], SinumerikAngleWord(settings.rotation)),
          fmt::format("bit 2 of STAT means A5 {} 0 (the cell's stat_a5_positive)",
                      options_.stat_a5_positive.value_or(false) ? ">" : "<")};
}

std::vector<std::pair<std::string, std::string>> SinumerikPost::BeforeFirstRun(
    const PostSettings& settings) const {
  const std::string group = SinumerikAngleWord(settings.rotation);
  const auto words = options_.Words();
  return {
      {"tool",
       fmt::format("the tool list holds \"{}\" with D1: length and orientation as the head's line TOOL",
                   settings.tool_name)},
      {"frame",
       fmt::format("G{} is for these programs: no other job's offset stands in it; no basic frame, no DRF",
                   options_.Frame())},
      {"words of the orientation",
       fmt::format("{}=, {}=, {}= are what this machine calls the tool's angles (MD10620)", words[0],
                   words[1], words[2])},
      {"orientation group",
       fmt::format("{}: bring one pose by hand with it, compare the angles (MD21100, MD21102)", group)},
      {"STAT", fmt::format("jog A5 to {}10 deg and read STAT with PTP: bit 2 is set",
                           options_.stat_a5_positive.value_or(false) ? "+" : "-")},
      {"axes", fmt::format("the robot's channel axes 1 to 6 are {}", fmt::join(options_.axis_names, ", "))},
      {"texts", TextsToTry(settings)},
      {"first entry",
       "single block to it at reduced speed, compare the axes with points.csv; then a dry run "
       "(dry_run_offset_mm)"}};
}

// Axes by name stand beside the robot's in joint blocks: a name can be only one axis.
std::string SinumerikPost::WhyNotIn(const PostSettings& settings) const {
  for (const ControllerAxis& axis : settings.controller_axes) {
    const bool robots = std::ranges::find(options_.axis_names, axis.name) != options_.axis_names.end();
    const auto words = options_.Words();
    const bool angle = std::ranges::find(words, axis.name) != words.end();
    if (robots || angle || SinumerikBlock::IsAddress(axis.name))
      return fmt::format(
          "controllers.sinumerik.external_axes: {} is {}; expected: the name of a channel axis of "
          "its own",
          axis.name, robots ? "one of axis_names" : "an address of blocks");
  }
  return {};
}

ProgramFiles SinumerikPost::Write(const MotionProgram& program, const Arm& arm,
                                  const PostSettings& settings) const {
  assert(IsWellFormed(program));
  return SinumerikWriter(program, arm, settings, options_).Write();
}

// Called by its name; M17 leads back.
CallingSyntax SinumerikPost::Calling() const {
  return {.longest = kProgramNameLength,
          .letters = 2,
          .ending = ".mpf",
          .head = "; written by millpose for SINUMERIK 840D sl\n",
          .call = "{name}\n",
          .tail = "M30\n",
          .called_ending = ".spf",
          .called_tail = "M17\n"};
}

// Of the tool management: the number that the control itself gave to the tool at place 1 of the buffer
// magazine 9998, which is the spindle, and the names of tools by such numbers. $P_TOOLNO would tell the tool
// that was asked for. STOPRE: what stands in the spindle is to be read when the program is there, not before.
std::string SinumerikPost::ToolCheck(const PostSettings&) const {
  return "MP_TOOL:\n"
         "STOPRE\n"
         "IF $TC_TP2[$TC_MPP6[9998,1]]==\"{tool}\" GOTOF MP_TOOL_IN\n"
         "MSG(\"TOOL {tool} EXPECTED\")\n"
         "M0\n"
         "GOTOB MP_TOOL\n"
         "MP_TOOL_IN:\n"
         "MSG()";
}

// CYCLE832 holds for every corner of a cut alike.
void SinumerikPost::Round(MotionProgram& program, const Arm&, const PostSettings& settings) const {
  for (Motion& motion : program.motions) {
    if (motion.type != MotionType::kLinear || motion.exact) continue;
    motion.blend = settings.blend;
    motion.angle_blend = settings.orientation_blend;
  }
}

}  // namespace millpose
