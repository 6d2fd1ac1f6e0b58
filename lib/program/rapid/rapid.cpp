// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/rapid/rapid.hpp"

#include <cassert>

#include "base/text.hpp"
#include "machine/robot/make_pose.hpp"
#include "program/calling_program.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/pose_text.hpp"
#include "program/program_name.hpp"
#include "program/rapid/rapid_configuration.hpp"
#include "program/rapid/rapid_data.hpp"
#include "program/rounding.hpp"
#include "program/writer.hpp"

namespace millpose {
namespace {

using Eigen::Vector4d;

constexpr size_t kLongestFile = 24;  // a name, without the file's ending; identifiers take 32
constexpr size_t kWidth = 100;
constexpr int kLengthDecimals = 4;
constexpr int kAngleDecimals = 6;
constexpr double kLeastZone = 1e-4;  // mm

constexpr const char* kWritten =
    "! written by millpose for ABB IRC5 and OmniCore (RAPID); mm, degrees, quaternions with the real part "
    "first\n";

/// The numbers N of ",mp_vN," in a text: which constants it uses.
std::vector<bool> UsedIn(const std::string& text, const std::string& name, size_t count) {
  std::vector<bool> used(count, false);
  const std::string begin = "," + name;
  for (size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1)) {
    size_t number = 0, end = at + begin.size();
    for (; end < text.size() && text[end] >= '0' && text[end] <= '9'; ++end)
      number = number * 10 + static_cast<size_t>(text[end] - '0');
    if (number >= 1 && number <= count) used[number - 1] = true;
  }
  return used;
}

/// Constants of one type by their values, numbered as they come.
class Constants {
 public:
  Constants(std::string type, std::string name) : type_(std::move(type)), name_(std::move(name)) {}

  std::string NameOf(const std::string& value) {
    const auto found = std::ranges::find(values_, value);
    const auto index = static_cast<size_t>(found - values_.begin());
    if (found == values_.end()) values_.push_back(value);
    return fmt::format("{}{}", name_, index + 1);
  }

  /// Declarations of those that `text` uses.
  std::string Declared(const std::string& text) const {
    const std::vector<bool> used = UsedIn(text, name_, values_.size());
    std::string lines;
    for (size_t i = 0; i < values_.size(); ++i)
      if (used[i]) lines += fmt::format("LOCAL CONST {} {}{}:={};\n", type_, name_, i + 1, values_[i]);
    return lines;
  }

 private:
  std::string type_, name_;
  std::vector<std::string> values_;
};

class RapidWriter : public ProgramWriter {
 public:
  RapidWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
              const RapidOptions& options, const CallingSyntax& syntax)
      : ProgramWriter(program, arm, settings, RapidTexts(settings)),
        options_(options),
        name_(ProgramName(syntax, program.name)),
        tail_(syntax.tail) {
    Pose X_FC = X_FT_;
    X_FC.linear() = X_FC.linear() * settings.R_TC();
    tool_ = rapid::ToolText(X_FC, settings.load.value_or(ToolLoad{}));
  }

  ProgramFiles Write() {
    WriteSections();
    ProgramFiles files;
    const std::vector<std::string> parts = Parts();
    std::string calls;
    for (size_t i = 0; i < parts.size(); ++i) {
      const std::string part = SubprogramName(name_, i, kLongestFile);
      files[part + ".mod"] = fmt::format("MODULE mp_{0}\n{1}PROC {0}()\n{2}ENDPROC\nENDMODULE\n", part,
                                         Data(parts[i]), parts[i]);
      calls += CallOf(part);
    }
    const std::string body = calls + MainText(parts);
    files[name_ + ".mod"] = Head(body) + body + TextLines("footer") + Filled(tail_);
    return files;
  }

 private:
  std::string Filled(std::string text) const {
    for (size_t at = text.find("{name}"); at != std::string::npos; at = text.find("{name}"))
      text.replace(at, 6, name_);
    return text;
  }

  /// A module that is loaded by itself leaves its room to the next one.
  std::string CallOf(const std::string& part) const {
    if (options_.load_from.empty()) return part + ";\n";
    const std::string path = fmt::format("\"{}/{}.mod\"", options_.load_from, part);
    return fmt::format("Load \\Dynamic,{0};\n%\"{1}\"%;\nUnLoad {0};\n", path, part);
  }

  void Begin() override { stated_ = false; }

  std::string Data(const std::string& text) const {
    return fmt::format(
        "LOCAL PERS tooldata mp_tool:={};\nLOCAL PERS wobjdata mp_wobj:={};\n"
        "LOCAL CONST speeddata mp_way:={};\n{}{}",
        tool_, first_object_, rapid::SpeedText({options_.way_speed, options_.orientation_speed}),
        speeds_.Declared(text), zones_.Declared(text));
  }

  std::string Head(const std::string& body) const {
    std::string head = fmt::format("MODULE mp_{}\n{}", name_, kWritten);
    for (const std::string& text : HeaderTexts(kWidth - 2)) head += "! " + text + "\n";
    head += Data(body);
    head += fmt::format("PROC {}()\n", name_);
    if (!program_.notice.empty()) head += fmt::format("TPWrite \"{}\";\n", program_.notice);
    return head + Settings() + TextLines("header") + TextLines("tool_change");
  }

  std::string Settings() const override {
    std::string settings;
    for (const std::string& statement : RapidSettings(options_)) settings += statement + ";\n";
    return settings;
  }

  /// Tool and work object keep what the last run left in them: their values are given before the motions that
  /// rely on them. Where the part has gone elsewhere, the work object is given again.
  void State(const Motion& motion, bool by_pose) {
    const std::optional<Pose>& X_BP = FrameOf(program_, motion);
    const Pose frame =
        RapidObjectFrame(options_, settings_, motion.external, X_BP.value_or(Pose::Identity()));
    if (!stated_) Line("mp_tool:=" + tool_ + ";");
    if (!stated_ || (by_pose && !SameFrame(frame, frame_))) {
      const std::string unit = options_.work_unit ? options_.work_unit->name : std::string();
      const std::string object = rapid::WorkObjectText({unit, frame});
      if (first_object_.empty()) first_object_ = object;
      Line("mp_wobj:=" + object + ";");
      frame_ = frame;
      turned_ = Vector4d::UnitX();
    }
    stated_ = true;
  }

  void AddMotion(size_t i) override {
    const Motion& motion = program_.motions[i];
    const bool linear = motion.type == MotionType::kLinear;
    State(motion, linear);
    if (linear) return AddLinear(motion);
    const Joints angles = settings_.axes.FromArm(*motion.q) * kDegPerRad;
    std::string joints;
    for (int k = 0; k < 6; ++k) joints += (k ? "," : "") + rapid::NumText(angles[k], kAngleDecimals);
    Line(fmt::format("MoveAbsJ [[{}],{}]\\NoEOffs,mp_way,fine,mp_tool\\WObj:=mp_wobj;", joints,
                     External(motion)));
  }

  void AddLinear(const Motion& motion) {
    const Eigen::Vector3d p = motion.X_PT.translation();
    turned_ = rapid::QuaternionOf(motion.X_PT.linear() * settings_.R_TC(), turned_);
    const std::string speed = speeds_.NameOf(rapid::SpeedText({motion.feed, options_.orientation_speed}));
    const std::string zone =
        motion.exact ? "fine" : zones_.NameOf(rapid::ZoneText(std::max(kLeastZone, motion.blend)));
    Line(fmt::format("MoveL [[{},{},{}],{},{},{}],{},{},mp_tool\\WObj:=mp_wobj;",
                     rapid::NumText(p.x(), kLengthDecimals), rapid::NumText(p.y(), kLengthDecimals),
                     rapid::NumText(p.z(), kLengthDecimals), rapid::QuaternionText(turned_),
                     RapidConfigurationText(RapidConfigurationOf(arm_, settings_.axes, *motion.q)),
                     External(motion), speed, zone));
  }

  /// The axes beside the arm's six.
  std::string External(const Motion& motion) const {
    std::string values;
    for (const std::string& name : RapidAxisNames()) {
      const auto axis = std::ranges::find(settings_.controller_axes, name, &ControllerAxis::name);
      values += values.empty() ? "[" : ",";
      values += axis == settings_.controller_axes.end()
                    ? kNoRapidAxis
                    : rapid::NumText(ValueOf(settings_, *axis, motion.external), kLengthDecimals);
    }
    return values + "]";
  }

  void Event(const ProgramEvent& event) override {
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) {
      Line("! " + place);
    } else if (event.kind == ProgramEvent::Kind::kPassEnd) {
      Line("! END OF " + place);
    } else if (event.kind == ProgramEvent::Kind::kDwell) {
      Line(fmt::format("WaitTime {};", ShortestNumber(event.value)));
    } else if (event.kind == ProgramEvent::Kind::kOutput) {
      // The motion before is exact: statements behind it wait until the arm is there.
      Line(fmt::format("SetDO {}{},{};", options_.signal_prefix, event.output.number,
                       event.output.on ? 1 : 0));
    }
    AddTexts(event);
  }

  const RapidOptions& options_;
  const std::string name_, tail_;
  std::string tool_, first_object_;
  Constants speeds_{"speeddata", "mp_v"}, zones_{"zonedata", "mp_z"};
  bool stated_ = false;                  // tool and work object have their values
  Pose frame_ = Pose::Identity();        // of the work object, as it was given last
  Vector4d turned_ = Vector4d::UnitX();  // of the last pose
};

/// Whether an axis in which the controller counts carries the part.
bool CarriesPart(const PostSettings& settings) {
  return std::ranges::any_of(settings.controller_axes, [&](const ControllerAxis& axis) {
    const auto index = AxisOf(settings, axis);
    return index && axis.coupled && settings.mechanism.axes()[*index].carries == Carries::kWorkpiece;
  });
}

}  // namespace

const std::vector<std::string>& RapidAxisNames() {
  static const std::vector<std::string> names = {"eax_a", "eax_b", "eax_c", "eax_d", "eax_e", "eax_f"};
  return names;
}

std::vector<std::string> RapidSettings(const RapidOptions& options) {
  std::vector<std::string> settings = {"ConfJ\\On",        "ConfL\\On",      "SingArea\\Off",
                                       "PDispOff",         "EOffsOff",       "SoftDeact",
                                       "VelSet 100,5000",  "AccSet 100,100", "PathAccLim FALSE,FALSE",
                                       "WorldAccLim\\Off", "GripLoad load0"};
  for (const std::string& unit : options.activate_units) settings.push_back("ActUnit " + unit);
  return settings;
}

std::map<std::string, std::string> RapidTexts(const PostSettings& settings) {
  std::map<std::string, std::string> texts = {
      {"spindle_on", "! SPINDLE ON {rpm} 1/min: switch it on, then start again\nStop;"},
      {"spindle_off", "! SPINDLE OFF: switch it off, then start again\nStop;"}};
  if (settings.ChangesTool()) texts["tool_change"] = "! TOOL {tool}: put it in, then start again\nStop;";
  return texts;
}

namespace {

/// What work objects count from: the world, or the user frame of the unit that carries them.
Pose CountedFrom(const RapidOptions& options) {
  return options.work_unit ? MakePose(options.work_unit->frame) : Pose::Identity();
}

}  // namespace

Pose RapidObjectFrame(const RapidOptions& options, const PostSettings& settings,
                      const ExternalPosition& external, const Pose& X_BP) {
  return CountedFrom(options).inverse() * MakePose(options.base_frame) * AsCounted(settings, external, X_BP);
}

Pose RapidBaseFrame(const RapidOptions& options, const PostSettings& settings,
                    const ExternalPosition& external, const Pose& object) {
  return FromCounted(settings, external,
                     MakePose(options.base_frame).inverse() * CountedFrom(options) * object);
}

ProgramFiles RapidPost::Write(const MotionProgram& program, const Arm& arm,
                              const PostSettings& settings) const {
  assert(IsWellFormed(program));
  if (program.blend_is_distance) return RapidWriter(program, arm, settings, options_, Calling()).Write();
  MotionProgram rounded = program;
  ChooseRounding(rounded, settings.tolerance);
  return RapidWriter(rounded, arm, settings, options_, Calling()).Write();
}

void RapidPost::Round(MotionProgram& program, const Arm&, const PostSettings& settings) const {
  ChooseRounding(program, settings.tolerance);
}

std::optional<AxisConvention> RapidPost::OwnZero() const {
  Joints zero = Joints::Zero();
  zero[1] = DegToRad(90);
  zero[2] = DegToRad(-90);
  return AxisConvention::OfSigns({1, 1, 1, 1, 1, 1}, zero);
}

Pose RapidPost::BaseInWorld(const PostSettings&) const { return MakePose(options_.base_frame); }

TimeOptions RapidPost::Times() const {
  TimeOptions times;
  times.orientation_speed = options_.orientation_speed;
  times.way_tip_speed = options_.way_speed;
  times.way_turn_speed = options_.orientation_speed;
  return times;
}

// The module's procedure has the program's name; main() calls it, and a program that is called has no main().
CallingSyntax RapidPost::Calling() const {
  CallingSyntax syntax;
  syntax.longest = kProgramNameLength;
  syntax.letters = 1;
  syntax.ending = syntax.called_ending = ".mod";
  syntax.head = fmt::format("MODULE mp_{{name}}\n{}PROC {{name}}()\n", kWritten);
  syntax.call = "{name};\n";
  syntax.tail = "ENDPROC\nPROC main()\n{name};\nENDPROC\nENDMODULE\n";
  syntax.called_tail = "ENDPROC\nENDMODULE\n";
  syntax.comment_begin = "! ";
  syntax.reserved = {"alias", "and",  "backward", "case",      "connect",  "const",  "default",   "div",
                     "do",    "else", "elseif",   "endfor",    "endfunc",  "endif",  "endproc",   "endtest",
                     "error", "exit", "false",    "for",       "from",     "func",   "goto",      "if",
                     "inout", "load", "local",    "main",      "mod",      "module", "nostepin",  "not",
                     "or",    "pers", "proc",     "raise",     "readonly", "record", "retry",     "return",
                     "set",   "step", "stop",     "sysmodule", "task",     "test",   "then",      "to",
                     "trap",  "true", "trynext",  "undo",      "unload",   "var",    "viewonly",  "wait",
                     "while", "with", "xor",      "fine",      "reset",    "break",  "endmodule", "noview"};
  return syntax;
}

std::string RapidPost::WhyNotIn(const PostSettings& settings) const {
  if (!settings.load)
    return "tool.load is missing: tooldata of RAPID state the mass, its centre and inertia of what hangs on "
           "the flange, and the controller reckons with them; needed with controllers.rapid";
  if (!(settings.load->mass > 0)) return "tool.load: a mass above 0 kg is needed with controllers.rapid";
  const bool carries = CarriesPart(settings);
  if (carries && !options_.work_unit)
    return "controllers.rapid.work_unit is missing; needed: the mechanical unit that carries the workpiece, "
           "since one of external_axes that is coupled does";
  if (!carries && options_.work_unit)
    return "controllers.rapid.work_unit has no effect: none of external_axes that carries the workpiece is "
           "coupled";
  return {};
}

std::vector<std::string> RapidPost::Assumptions(const PostSettings& settings) const {
  std::vector<std::string> assumptions = {
      "cfx of configurations counts as ABB says for serial arms with six axes (docs/rapid.md)"};
  if (!settings.outputs.empty())
    assumptions.push_back(
        fmt::format("output n is the signal {}n (the cell's signal_prefix)", options_.signal_prefix));
  return assumptions;
}

std::vector<std::pair<std::string, std::string>> RapidPost::BeforeFirstRun(
    const PostSettings& settings) const {
  const std::string size =
      options_.memory_kbytes
          ? fmt::format("the cell says {} kB for all files of a program", *options_.memory_kbytes)
          : "compare the size of all files with the program memory that the pendant shows as free";
  std::vector<std::pair<std::string, std::string>> steps = {
      {"tool",
       "programs state tooldata themselves: tool_pose in the head is what was measured, load is "
       "what hangs on the flange"},
      {"base",
       "programs state wobjdata themselves: base_pose in the head is the part in the controller's "
       "world"},
      {"base frame", "Configuration, Motion, Robot: the base frame is base_frame in the head; gravity too"},
      {"axes", "jog to the first MoveAbsJ of the program: arm and points.csv must agree"},
      {"configuration",
       "move to the first MoveL in steps and compare cf1, cf4, cf6, cfx at the pendant with the program's"},
      {"texts", TextsToTry(settings)},
      {"memory", options_.load_from.empty()
                     ? size
                     : fmt::format("copy all files of the program to {} (load_from)", options_.load_from)},
      {"first entry", "step to it in manual mode with reduced speed; then a dry run (dry_run_offset_mm)"}};
  for (const std::string& unit : options_.activate_units)
    steps.emplace_back("unit", fmt::format("{} can be activated by ActUnit", unit));
  return steps;
}

FrameTexts RapidPost::Frames(const PostSettings& settings) const {
  FrameTexts texts{settings.tool_name + " in tool0",
                   "workpiece in the controller's world",
                   {{"base_frame", "assumed of the robot: " + PoseText(MakePose(options_.base_frame))}}};
  if (options_.work_unit)
    texts.more.emplace_back("work_unit",
                            fmt::format("assumed user frame of {}, axes at 0: {}", options_.work_unit->name,
                                        PoseText(MakePose(options_.work_unit->frame))));
  if (settings.load) {
    const ToolLoad& load = *settings.load;
    texts.more.emplace_back(
        "load", fmt::format("{} kg at {} {} {} mm in tool0", Fixed(load.mass, 3), Fixed(load.centre.x(), 1),
                            Fixed(load.centre.y(), 1), Fixed(load.centre.z(), 1)));
  }
  return texts;
}

}  // namespace millpose
