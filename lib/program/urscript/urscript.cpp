// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/urscript/urscript.hpp"

#include <cassert>

#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "program/controller_axes.hpp"
#include "program/program_name.hpp"
#include "program/urscript/urscript_rounding.hpp"
#include "program/writer.hpp"

namespace millpose {
namespace {

constexpr size_t kLongestName = 31;
constexpr size_t kWidth = 100;
constexpr int kDecimals = 7;  // m, rad, m/s: 0.0001 mm, 0.000006 deg

constexpr double kHalfTurn = 1e-6;         // rad, that a turn may be short of one
constexpr double kLevel = 1 * kRadPerDeg;  // a base that was levelled stands within

std::string Listed(const double* values, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i ? ", " : "") + Fixed(values[i], kDecimals);
  return text;
}

/// Axis times angle. Of the two that mean half a turn the one whose first component of some size is positive,
/// so that rounding does not make one of the other.
Eigen::Vector3d TurnOf(const Eigen::Matrix3d& rotation) {
  Eigen::Vector3d turn = RotationVector(rotation);
  const double angle = turn.norm();
  if (angle < kPi - kHalfTurn) return turn;
  const auto first = std::find_if(turn.begin(), turn.end(), [](double c) { return std::abs(c) > 0.1; });
  return *first < 0 ? Eigen::Vector3d(turn * (1 - 2 * kPi / angle)) : turn;
}

/// "p[x, y, z, rx, ry, rz]": m, and axis times angle in rad.
std::string PoseLiteral(const Pose& pose) {
  const Eigen::Vector3d place = pose.translation() / 1000, turn = TurnOf(pose.linear());
  return fmt::format("p[{}, {}]", Listed(place.data(), 3), Listed(turn.data(), 3));
}

class UrScriptWriter : public ProgramWriter {
 public:
  UrScriptWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
                 const UrScriptOptions& options)
      : ProgramWriter(program, arm, settings, UrScriptTexts(settings)), options_(options) {}

  ProgramFiles Write() {
    WriteSections();
    const std::string name = LegalName(program_.name, kLongestName, 1);
    return {{name + ".script", Head(name) + MainText({}) + TextLines("footer") + "end\n"}};
  }

 private:
  std::string Head(const std::string& name) const {
    std::string head =
        "# written by millpose for Universal Robots CB3 and e-Series; m, rad, m/s; poses of the tool in the "
        "base,\n# rx, ry, rz: axis of the turn times its angle\n";
    for (const std::string& text : HeaderTexts(kWidth - 2)) head += "# " + text + "\n";
    head += fmt::format("def {}():\n", name);
    if (!program_.notice.empty())
      head +=
          fmt::format("popup(\"{}\", title=\"millpose\", warning=True, blocking=True)\n", program_.notice);
    return head + Settings() + TextLines("header") + TextLines("tool_change");
  }

  std::string Settings() const override {
    Pose X_FC = X_FT_;
    X_FC.linear() = X_FC.linear() * settings_.R_TC();
    return fmt::format("set_tcp({})\n{}\n", PoseLiteral(X_FC), UrScriptPayload(settings_));
  }

  void Begin() override {}

  void AddMotion(size_t i) override {
    const Motion& motion = program_.motions[i];
    if (motion.type == MotionType::kLinear) return AddLine(i);
    const Joints angles = settings_.axes.FromArm(*motion.q);
    Line(fmt::format("movej([{}], a={}, v={})", Listed(angles.data(), 6),
                     Fixed(UrScriptMovejAcceleration(arm_), 4),
                     Fixed(UrScriptMovejSpeed(arm_, options_), 4)));
  }

  void AddLine(size_t i) {
    const Motion& motion = program_.motions[i];
    Pose X_BC = FrameOf(program_, motion).value_or(Pose::Identity()) * motion.X_PT;
    X_BC.linear() = X_BC.linear() * settings_.R_TC();
    Line(fmt::format("{}({}, a={}, v={}, r={})", options_.movel ? "movel" : "movep", PoseLiteral(X_BC),
                     Fixed(UrScriptAcceleration(settings_, options_) / 1000, 4),
                     Fixed(motion.feed / 1000, kDecimals),
                     Fixed(motion.exact ? 0 : motion.blend / 1000, kDecimals)));
  }

  void Event(const ProgramEvent& event) override {
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) Line(fmt::format("textmsg(\"{}\")", place));
    if (event.kind == ProgramEvent::Kind::kPassEnd) Line(fmt::format("textmsg(\"END OF {}\")", place));
    // The cut stands still where it begins and ends.
    if (event.kind == ProgramEvent::Kind::kOutput)
      Line(fmt::format("set_standard_digital_out({}, {})", event.output.number,
                       event.output.on ? "True" : "False"));
    if (event.kind == ProgramEvent::Kind::kDwell) Line(fmt::format("sleep({})", ShortestNumber(event.value)));
    AddTexts(event);
  }

  const UrScriptOptions& options_;
};

}  // namespace

std::map<std::string, std::string> UrScriptTexts(const PostSettings& settings) {
  const auto ask = [](const std::string& what) {
    return fmt::format("popup(\"{}, then go on\", title=\"millpose\", blocking=True)", what);
  };
  std::map<std::string, std::string> texts = {{"spindle_on", ask("SPINDLE ON {rpm} 1/min: switch it on")},
                                              {"spindle_off", ask("SPINDLE OFF: switch it off")}};
  if (settings.ChangesTool()) texts["tool_change"] = ask("TOOL {tool}: put it in");
  return texts;
}

std::string UrScriptPayload(const PostSettings& settings) {
  const Eigen::Vector3d centre = settings.load->centre / 1000;
  return fmt::format("set_payload({}, [{}, {}, {}])", ShortestNumber(settings.load->mass),
                     Fixed(centre.x(), kDecimals), Fixed(centre.y(), kDecimals),
                     Fixed(centre.z(), kDecimals));
}

double UrScriptMovejAcceleration(const Arm& arm) { return arm.acceleration.minCoeff(); }

double UrScriptMovejSpeed(const Arm& arm, const UrScriptOptions& options) {
  return options.movej_speed_percent / 100.0 * arm.speed.minCoeff();
}

double UrScriptAcceleration(const PostOptions& settings, const UrScriptOptions& options) {
  return settings.path_acceleration.value_or(options.path_acceleration);
}

std::optional<AxisConvention> UrScriptPost::OwnZero() const {
  Joints offset = Joints::Zero();
  offset[0] = kPi;
  offset[3] = -kPi / 2;
  return AxisConvention::OfSigns({1, 1, 1, 1, -1, 1}, offset);
}

PathDynamics UrScriptPost::Dynamics(const PostOptions& options) const {
  PathDynamics dynamics = Post::Dynamics(options);
  dynamics.acceleration = UrScriptAcceleration(options, options_);
  return dynamics;
}

std::string UrScriptPost::WhyNotIn(const PostSettings& settings) const {
  if (!settings.load)
    return "controllers.urscript: tool.load is missing; expected: mass and centre of what hangs on the "
           "flange, which programs state (set_payload)";
  for (const PathOutput& output : settings.outputs)
    if (output.number >= kUrScriptOutputs)
      return fmt::format("controllers.urscript.outputs: number {}; allowed: the standard outputs 0 to {}",
                         output.number, kUrScriptOutputs - 1);
  return {};
}

std::vector<std::string> UrScriptPost::Assumptions(const PostSettings&) const {
  return {
      "straight motions turn the tool evenly about one axis, the shorter way round: the maker's script "
      "manual does not say how"};
}

std::vector<std::pair<std::string, std::string>> UrScriptPost::BeforeFirstRun(
    const PostSettings& settings) const {
  const bool level = settings.X_WB.linear()(2, 2) >= SinCos(kLevel).cos;
  return {
      {"joints",
       "jog each joint: the pendant's angles are those of points.csv; its feature Base is the "
       "cell's base_in_world, whose X points away from the outstretched arm at zero"},
      {"mounting", level ? "the installation says that the robot stands upright"
                         : "the installation's mounting (tilt, turn) is the cell's base_in_world"},
      {"tool", "programs state the TCP themselves (set_tcp): tool_pose in the head is what was measured"},
      {"payload", UrScriptPayload(settings) + " is what hangs on the flange; the pendant warns where not"},
      {"safety",
       "speeds, force and power of the safety settings let the cut through: a protective stop "
       "marks the part"},
      {"corners",
       fmt::format("run the program in the maker's simulator: no message of a blend or of a skipped "
                   "move; {}",
                   options_.movel ? "watch the speed at slow feeds"
                                  : "else controllers.urscript.cut_motion: "
                                    "movel")},
      {"texts", TextsToTry(settings)},
      {"first entry",
       "step to it at a low speed slider and compare the joints with points.csv; then a dry run "
       "(dry_run_offset_mm)"}};
}

FrameTexts UrScriptPost::Frames(const PostSettings& settings) const {
  FrameTexts frames = Post::Frames(settings);
  frames.base += "; poses count in the robot base";
  return frames;
}

ProgramFiles UrScriptPost::Write(const MotionProgram& program, const Arm& arm,
                                 const PostSettings& settings) const {
  assert(IsWellFormed(program) && settings.load);
  if (!program.corner_assumption.empty()) return UrScriptWriter(program, arm, settings, options_).Write();
  MotionProgram rounded = program;
  Round(rounded, arm, settings);
  return UrScriptWriter(rounded, arm, settings, options_).Write();
}

// One file cannot call another.
CallingSyntax UrScriptPost::Calling() const {
  return {.longest = kLongestName,
          .letters = 1,
          .ending = ".script",
          .tail = "end\n",
          .called_ending = ".script"};
}

void UrScriptPost::Round(MotionProgram& program, const Arm&, const PostSettings& settings) const {
  ChooseBlends(program, settings);
}

}  // namespace millpose
