// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl.hpp"

#include <cassert>

#include "base/text.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/krl/krl_head.hpp"
#include "program/program_name.hpp"
#include "program/rounding.hpp"
#include "program/writer.hpp"

namespace millpose {
namespace {

using krl::kAngleDecimals;
using krl::kLengthDecimals;

constexpr size_t kLongestFile = 24;  // a name, without the file's ending
constexpr size_t kWidth = 100;
constexpr int kTargetDecimals = 4;  // A, B, C of targets, which turn about the tip: 0.00005 degrees

constexpr double kUpright = 1 * kRadPerDeg;  // a base that was levelled stands within

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

std::string Data(const std::string& name) {
  return fmt::format(
      "{}DEFDAT {}\n;FOLD EXTERNAL DECLARATIONS\n  ;FOLD BASISTECH EXT\n"
      "    EXT BAS (BAS_COMMAND :IN,REAL :IN )\n    DECL INT SUCCESS\n  ;ENDFOLD (BASISTECH "
      "EXT)\n;ENDFOLD\n"
      "ENDDAT\n",
      kHead, name);
}

std::string Binary(int bits, int digits) { return fmt::format("'B{:0{}b}'", bits, digits); }

class KrlWriter : public ProgramWriter {
 public:
  KrlWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
            const KrlOptions& options)
      : ProgramWriter(program, arm, settings, KrlTexts(settings)), options_(options) {}

  ProgramFiles Write() {
    At(0);
    WriteSections();
    const std::string name = LegalName(program_.name, kProgramNameLength, 1);
    ProgramFiles files;
    At(0);
    std::string main = Head(name);
    const std::vector<std::string> parts = Parts();
    for (size_t i = 0; i < parts.size(); ++i) {
      const std::string part = SubprogramName(name, i, kLongestFile);
      files[part + ".src"] = fmt::format("{}DEF {} ( )\n{}END\n", kHead, part, parts[i]);
      main += part + " ( )\n";
    }
    files[name + ".src"] = main + MainText(parts) + TextLines("footer") + "END\n";
    files[name + ".dat"] = Data(name);
    return files;
  }

 private:
  /// What is written next belongs to motion `i`; the head states its base.
  void At(size_t i) {
    if (i >= program_.motions.size()) return;
    motion_ = &program_.motions[i];
    if (i == 0) base_ = Base();
    rides_ = (rides_ && HasFeed(*motion_)) || CoordinatedMotions(program_, i);
  }

  /// What $BASE is given where the motion counts; empty where programs state none.
  std::optional<Pose> Base() const {
    const std::optional<Pose> X_BP = motion_ ? FrameOf(program_, *motion_) : program_.X_BP;
    if (!X_BP || options_.base_number > 0) return std::nullopt;
    return KrlBaseValue(options_, settings_, motion_ ? motion_->external : ExternalPosition(), *X_BP);
  }

  void Forget() override {
    Begin();
    base_ = Base();
  }

  void Begin() override {
    feed_.clear();
    distance_.clear();
    words_.reset();
    if (std::exchange(within_pass_, false)) Line(";FOLD PART OF A PASS");
  }

  std::string Head(const std::string& name) const {
    std::string head = kHead;
    const auto add = [&](const std::string& line) { head += line + "\n"; };
    add(fmt::format("DEF {} ( )", name));
    add("; written by millpose for KUKA KRC4; mm, degrees; A about Z, B about new Y, C about new X");
    for (const std::string& text : HeaderTexts(kWidth - 2)) add("; " + text);
    if (program_.frames_checked || !program_.notice.empty()) head += KrlDeclarations();
    head += kIni;
    if (program_.frames_checked) head += KrlFrameCheck(options_);
    if (!program_.notice.empty()) head += KrlNotice(program_.notice);
    return head + Settings() + TextLines("header") + TextLines("tool_change");
  }

  std::string Settings() const override {
    std::string settings;
    const auto add = [&](const std::string& line) { settings += line + "\n"; };
    AddFrames(add);
    if (const std::string load = KrlLoad(options_, settings_); !load.empty()) settings += load + "\n";
    AddDynamics(add);
    return settings;
  }

  /// A numbered frame is the controller's own, with $LOAD, $ACT_TOOL and $ACT_BASE; the header says which
  /// values it must hold.
  template <class Add>
  void AddFrames(const Add& add) const {
    if (options_.base_number > 0) {
      add(fmt::format("BAS (#BASE,{} )", options_.base_number));
    } else if (const std::optional<Pose> base = Base()) {
      add(BaseText(*base));
      if (options_.external_base) add("$IPO_MODE = #BASE");
    }
    if (options_.tool_number > 0) {
      add(fmt::format("BAS (#TOOL,{} )", options_.tool_number));
    } else if (program_.X_FT) {
      Pose X_FC = *program_.X_FT;
      X_FC.linear() = X_FC.linear() * settings_.R_TC();
      add(fmt::format("$TOOL = {{FRAME: {}}}", KrlFields(X_FC, kAngleDecimals)));
    }
  }

  /// On a coupled table the statement, not its value, makes $BASE turn with it.
  std::string BaseText(const Pose& base) const {
    const std::string fields = KrlFields(base, kAngleDecimals);
    if (!options_.external_base) return fmt::format("$BASE = {{FRAME: {}}}", fields);
    return fmt::format("$BASE = {}{{{}}})", KrlTableBase(*options_.external_base), fields);
  }

  template <class Add>
  void AddDynamics(const Add& add) const {
    add("$ORI_TYPE = #VAR");
    add(fmt::format("$ADVANCE = {}", options_.advance));
    add(fmt::format("BAS (#VEL_PTP,{} )", options_.ptp_speed_percent));
    const auto both = [&](const char* what, double value) {
      for (const int i : {1, 2}) add(fmt::format("{}.ORI{} = {}", what, i, Short(value * kDegPerRad, 4)));
    };
    both("$VEL", options_.orientation_speed);
    if (settings_.path_acceleration) add("$ACC.CP = " + Short(*settings_.path_acceleration / 1000, 4));
    if (options_.orientation_acceleration) both("$ACC", *options_.orientation_acceleration);
  }

  /// From where the external axes begin to move along a cut $BASE is not stated again before its end: should
  /// the controller believe in another direction of the rail, the targets make up for it.
  Pose ToolInBase(const Motion& motion) const {
    Pose X_PC = motion.X_PT;
    if (rides_ && base_)
      X_PC = KrlBaseFrame(options_, settings_, motion.external, *base_).inverse(Eigen::Isometry) *
             *FrameOf(program_, motion) * motion.X_PT;
    X_PC.linear() = X_PC.linear() * settings_.R_TC();
    return X_PC;
  }

  void AddMotion(size_t i) override {
    const Motion& motion = program_.motions[i];
    At(i);
    const bool by_pose = motion.type == MotionType::kLinear || motion.status;
    const std::optional<Pose> base = Base();
    if (by_pose && base && !(base_ && (rides_ || SameFrame(*base, *base_)))) {
      Line(BaseText(*base));
      base_ = base;
      words_.reset();
    }
    if (motion.type == MotionType::kLinear) return AddLinear(motion);
    AddTriggers();
    if (motion.status) {
      words_ = KrlWords(ToolInBase(motion), kTargetDecimals);
      Line(fmt::format("PTP {{{},S {},T {}{}}}", fmt::join(*words_, ","), Binary(*motion.status, 3),
                       Binary(TurnOf(motion), 6), External()));
    } else {
      words_.reset();
      const Joints angles = settings_.axes.FromArm(*motion.q) * kDegPerRad;
      std::string fields;
      for (int k = 0; k < 6; ++k)
        fields += fmt::format("{}A{} {}", k ? "," : "", k + 1, Short(angles[k], kAngleDecimals));
      Line(fmt::format("PTP {{{}{}}}", fields, External()));
    }
  }

  void AddLinear(const Motion& motion) {
    const std::string target = fmt::format("{{{}{}}}", Changed(ToolInBase(motion)), External());
    Feed(motion.feed);
    if (!motion.exact) Distance(motion.blend);
    AddTriggers();
    Line(fmt::format("LIN {}{}", target, motion.exact ? "" : " C_DIS"));
  }

  /// The words of a target that are other ones than those of the target before: the controller keeps the
  /// rest. One at least.
  std::string Changed(const Pose& target) {
    const std::array<std::string, 6> words = KrlWords(target, kTargetDecimals);
    std::vector<std::string> changed;
    for (size_t i = 0; i < words.size(); ++i)
      if (!words_ || words[i] != (*words_)[i]) changed.push_back(words[i]);
    if (changed.empty()) changed.push_back(words.front());
    words_ = words;
    return fmt::format("{}", fmt::join(changed, ","));
  }

  /// What is switched where this motion begins.
  void AddTriggers() {
    for (const PathOutput& output : outputs_) {
      Line(fmt::format("TRIGGER WHEN DISTANCE=0 DELAY={} DO $OUT[{}]={}", Fixed(output.delay * 1000, 0),
                       output.number, output.on ? "TRUE" : "FALSE"));
    }
    outputs_.clear();
  }

  /// The axes beside the arm's six, as fields.
  std::string External() const {
    std::string fields;
    for (const ControllerAxis& axis : settings_.controller_axes)
      fields += fmt::format(",{} {}", axis.name,
                            Short(ValueOf(settings_, axis, motion_->external), kLengthDecimals));
    return fields;
  }

  int TurnOf(const Motion& motion) const {
    Pose X_PC = ToolInBase(motion);
    Eigen::Vector3d abc = AnglesZyx(X_PC.linear()) * kDegPerRad;
    for (int i = 0; i < 3; ++i) {
      X_PC.translation()[i] = Rounded(X_PC.translation()[i], kLengthDecimals);
      abc[i] = Rounded(abc[i], kTargetDecimals) * kRadPerDeg;
    }
    X_PC.linear() = FromAnglesZyx(abc);
    return TurnAt(motion, X_PC);
  }

  void Feed(double feed) {
    const std::string text = Short(feed / 1000, 8);  // $VEL.CP is in m/s
    if (text == feed_) return;
    feed_ = text;
    Line("$VEL.CP = " + text);
  }

  void Distance(double blend) {
    const std::string text = Short(blend, 4);
    if (text == distance_) return;
    distance_ = text;
    Line("$APO.CDIS = " + text);
  }

  void Event(const ProgramEvent& event) override {
    const std::string pass = Fixed(event.value, 0);
    if (event.kind == ProgramEvent::Kind::kOutput) {
      outputs_.push_back(event.output);
    } else if (event.kind == ProgramEvent::Kind::kDwell) {
      Line("WAIT SEC " + ShortestNumber(event.value));
    } else if (event.kind == ProgramEvent::Kind::kHandover) {
      Line(";ENDFOLD (PART OF A PASS)");
      within_pass_ = true;
    } else if (event.kind == ProgramEvent::Kind::kPassBegin) {
      Line(fmt::format("PASS_{}_{}:", pass, event.piece));
      Line(fmt::format(";FOLD PASS {} PIECE {}", pass, event.piece));
    } else if (event.kind == ProgramEvent::Kind::kPassEnd) {
      Line(fmt::format(";ENDFOLD (PASS {} PIECE {})", pass, event.piece));
    }
    AddTexts(event);
  }

  const KrlOptions& options_;
  std::vector<PathOutput> outputs_;  // to be switched with the next straight motion
  const Motion* motion_ = nullptr;   // that is being written, or the first
  std::optional<Pose> base_;         // as $BASE was stated last
  std::string feed_, distance_;
  std::optional<std::array<std::string, 6>> words_;  // of the last pose, where it may count on
  bool rides_ = false;        // external axes move, or have moved, along the cut that is being written
  bool within_pass_ = false;  // the next section goes on with a pass
};

}  // namespace

std::map<std::string, std::string> KrlTexts(const PostSettings& settings) {
  std::map<std::string, std::string> texts = {
      {"spindle_on", "; SPINDLE ON {rpm} 1/min: switch it on, then start again\nHALT"},
      {"spindle_off", "; SPINDLE OFF: switch it off, then start again\nHALT"}};
  if (settings.ChangesTool()) texts["tool_change"] = "; TOOL {tool}: put it in, then start again\nHALT";
  return texts;
}

ProgramFiles KrlPost::Write(const MotionProgram& program, const Arm& arm,
                            const PostSettings& settings) const {
  assert(IsWellFormed(program));
  if (program.blend_is_distance) return KrlWriter(program, arm, settings, options_).Write();
  MotionProgram rounded = program;
  ChooseRounding(rounded, settings.tolerance);
  return KrlWriter(rounded, arm, settings, options_).Write();
}

// A module is called by its name as it is.
CallingSyntax KrlPost::Calling() const {
  return {.longest = kProgramNameLength,
          .letters = 1,
          .ending = ".src",
          .head = fmt::format("{}DEF {{name}} ( )\n; written by millpose for KUKA KRC4\n", kHead),
          .call = "{name} ( )\n",
          .tail = "END\n",
          .beside = {{".dat", Data("{name}")}},
          .called_ending = ".src",
          .called_tail = "END\n"};
}

// LIN: the controller's tool direction swivels evenly, the tool turns evenly about it.
std::vector<LineModel> KrlPost::Lines(const PostSettings& settings) const {
  const Eigen::Vector3d direction = settings.R_TC() * DirectionOf(options_.tool_direction);
  return {[direction](const Pose& from, const Pose& to) { return ProgrammedLine(from, to, direction); }};
}

PathDynamics KrlPost::Dynamics(const PostOptions& options) const {
  PathDynamics dynamics = Post::Dynamics(options);
  dynamics.turn_acceleration = options_.orientation_acceleration;
  return dynamics;
}

std::string KrlPost::WhyNotIn(const PostSettings& settings) const {
  if (std::string refusal = KrlWhyNotWithAxes(options_, settings); !refusal.empty()) return refusal;
  const double apart = KrlTilt(options_, settings);
  if (apart > kUpright)
    return fmt::format(
        "controllers.krl: base_in_world and robroot turn the robot by {:.1f} deg against each other, seen "
        "from gravity; {}: the controller's $ROBROOT expected (ceiling C 180, wall B 90), which its own "
        "model of weights uses",
        apart * kDegPerRad, options_.robroot ? "robroot must agree" : "robroot is missing");
  if (options_.tool_number > 0 && settings.several_tools)
    return "controllers.krl.tool_number: has one number for all of the cell's tools; leave it out: programs "
           "then state $TOOL themselves";
  if (!options_.tool_in_spindle.empty() && !(settings.ChangesTool() && settings.tool_number))
    return "controllers.krl.tool_in_spindle: has no effect here: programs change the tool only where the "
           "cell "
           "has several tools or tool_change_deg, and compare its number only where the tool has one";
  if (options_.write_load.value_or(false) && !settings.load)
    return "controllers.krl.write_load: tool.load is missing; expected: mass, centre and inertia of what "
           "hangs on the flange";
  return {};
}

std::vector<std::pair<std::string, std::string>> KrlPost::BeforeFirstRun(const PostSettings& settings) const {
  const auto frame = [](const char* list, int number, const char* own, const char* line) {
    return number > 0
               ? fmt::format("{}[{}] at the controller: the values of {} in the head", list, number, line)
               : fmt::format("programs state {} themselves: {} in the head is what was measured", own, line);
  };
  std::vector<std::pair<std::string, std::string>> steps = {
      {"tool", frame("TOOL_DATA", options_.tool_number, "$TOOL", "tool_pose")},
      {"base", frame("BASE_DATA", options_.base_number, "$BASE", "base_pose")},
      {"load", options_.WritesLoad() && settings.load
                   ? "programs state $LOAD: load in the head is what hangs on the flange"
                   : "the controller's load data are those of spindle and tool (M, CM, J)"},
      {"tool direction",
       fmt::format("$TOOL_DIRECTION is #{}", options_.tool_direction == FrameAxis::kX   ? "X"
                                             : options_.tool_direction == FrameAxis::kY ? "Y"
                                                                                        : "Z")},
      {"frames of the controller",
       "select the program in T1: it stops with a message where $ROBROOT, $ERSYSROOT or "
       "MACHINE_DEF[n].ROOT is not the head's"},
      {"texts", TextsToTry(settings)},
      {"memory",
       fmt::format("load all files of the program at once; the cell says {} kB (program_memory_kbytes)",
                   options_.memory_kbytes)},
      {"first entry",
       "step to it in T1 and compare the axes with points.csv; then a dry run (dry_run_offset_mm)"}};
  return steps;
}

// The advance run stops at WAIT SEC: what stands in the variable is to be read when the arm is there.
std::string KrlPost::ToolCheck(const PostSettings& settings) const {
  if (options_.tool_in_spindle.empty() || !settings.tool_number) return {};
  return fmt::format("WAIT SEC 0\nWHILE {}<>{{number}}\n; TOOL {{number}} {{tool}} EXPECTED\nHALT\nENDWHILE",
                     options_.tool_in_spindle);
}

void KrlPost::Round(MotionProgram& program, const Arm&, const PostSettings& settings) const {
  ChooseRounding(program, settings.tolerance);
}

}  // namespace millpose
