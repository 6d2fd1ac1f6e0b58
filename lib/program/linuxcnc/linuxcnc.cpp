// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/linuxcnc/linuxcnc.hpp"

#include <cassert>

#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "motion/line.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/linuxcnc/linuxcnc_rounding.hpp"
#include "program/writer.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr size_t kWidth = 100;
constexpr size_t kLongestName = 64;
constexpr int kLengthDecimals = 4;
constexpr int kAngleDecimals = 6;
constexpr int kDeepest = 12;  // halvings of one line
// X, Y, Z that move by less than this (degrees; 0.001 mm at 3 m) are held, so that F counts along A, B, C.
constexpr double kStandstill = 2e-5;

/// A joint position of the text: degrees as rounded there.
Joints AsWritten(const AxisConvention& axes, const Joints& q) {
  Joints angles = ToController(axes, q) * kDegPerRad;
  for (double& angle : angles) angle = Rounded(angle, kAngleDecimals);
  return angles;
}

class LinuxCncWriter : public ProgramWriter {
 public:
  LinuxCncWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
                 const LinuxCncOptions& options)
      : ProgramWriter(program, arm, settings, LinuxCncTexts(settings)), options_(options) {}

  ProgramFiles Write() {
    WriteSections();
    return {{LegalName(program_.name, kLongestName, 1) + ".ngc",
             Head() + MainText({}) + TextLines("footer") + "M2\n"}};
  }

 private:
  std::string Head() const {
    std::string head = "; written by millpose for LinuxCNC; X Y Z A B C are the joints 1 to 6, degrees\n";
    if (options_.cartesian) {
      head += "; in cuts: the tool in the robot's base, mm, degrees; ";
      head += settings_.rotation == AngleOrder::kRpy ? "C about Z, B about new Y, A about new X\n"
                                                     : "A about Z, B about new X, C about new Z\n";
    }
    for (const std::string& text : HeaderTexts(kWidth - 2)) head += "; " + text + "\n";
    if (!program_.notice.empty()) head += fmt::format("(MSG, {})\n", program_.notice);
    return head + Settings() + TextLines("header") + TextLines("tool_change");
  }

  std::string Settings() const override {
    return fmt::format("G21 G90 G17 G40 G49 G94\n{}\nG59.3 G92.1\n", NoOffsets(settings_));
  }

  void Begin() override { Restate(); }

  void Forget() override {
    Restate();
    cartesian_.reset();
    external_.clear();
  }

  /// Modal settings are to be stated again.
  void Restate() {
    path_mode_.clear();
    inverse_time_.reset();
    feed_.clear();
  }

  /// Switches between joints and tool poses, where the program has both.
  void Coordinates(bool cartesian) {
    if (!options_.cartesian || cartesian_ == cartesian) return;
    AddText(cartesian ? "cartesian_on" : "joints_on");
    cartesian_ = cartesian;
    Restate();
  }

  void AddMotion(size_t i) override {
    const Motion& motion = program_.motions[i];
    blend_ = motion.blend > 0 ? motion.blend : settings_.blend;
    X_BP_ = FrameOf(program_, motion).value_or(Pose::Identity());
    if (motion.type == MotionType::kLinear && options_.cartesian) return AddPose(i);
    Coordinates(false);
    if (motion.type == MotionType::kLinear) {
      const Motion& before = program_.motions[i - 1];
      const double share = LinearDuration(before, motion, arm_);
      AddLine(before.X_PT, *before.q, motion.X_PT, *motion.q, share, motion.exact, 0);
    } else if (motion.duration > 0) {
      AddTimed(*motion.q, motion.duration, motion.exact);
    } else {
      PathMode(motion.exact);
      const Joints angles = AsWritten(settings_.axes, *motion.q);
      Line("G0 " + Words(angles) + ExternalWords(motion));
      last_ = angles;
    }
  }

  /// A straight line of the tip from joints q0 to q1, halved until the joint motions between stay near it.
  void AddLine(const Pose& X0, const Joints& q0, const Pose& X1, const Joints& q1, double duration,
               bool exact, int depth) {
    Pose middle = Pose::Identity();
    middle.translation() = (X0.translation() + X1.translation()) / 2;
    // Half-way of the shortest turn: the normalised sum of the two quaternions.
    const Eigen::Quaterniond first(X0.linear()), second(X1.linear());
    const double side = first.dot(second) < 0 ? -1 : 1;
    middle.linear() =
        Eigen::Quaterniond(first.coeffs() + side * second.coeffs()).normalized().toRotationMatrix();
    const Joints halfway = (q0 + q1) / 2;
    const Pose reached = X_BP_.inverse() * ForwardFlange(arm_, halfway) * X_FT_;
    const Eigen::Vector3d off = reached.translation() - middle.translation();
    const double turned = AngleBetween(reached.linear(), middle.linear());
    const auto q_middle = InverseNear(arm_, X_BP_ * middle * X_FT_.inverse(), Status(arm_, q1), halfway);
    // Where the arm changes its branch half-way no joint motion follows the line; read-back says so.
    // A tip that is ahead or behind runs at another feed, and stands where the tool is turned otherwise.
    const PoseLine line(X0, X1);
    const Eigen::Vector3d way = X1.translation() - X0.translation();
    const double ahead = line.length() > kStandstill ? std::abs(off.dot(way)) / way.squaredNorm() : 0;
    const bool near = off.norm() <= kHalfwayDeviation && turned <= kHalfwayAngle && ahead <= kHalfwayLead &&
                      ahead * line.angle() <= kHalfwayTurn;
    if (near || depth == kDeepest || !q_middle) {
      AddTimed(q1, duration, exact);
      return;
    }
    AddLine(X0, q0, middle, *q_middle, duration / 2, false, depth + 1);
    AddLine(middle, *q_middle, X1, q1, duration / 2, exact, depth + 1);
  }

  void AddTimed(const Joints& q, double duration, bool exact) {
    PathMode(exact);
    Joints angles = AsWritten(settings_.axes, q);
    if ((angles - last_).head<3>().norm() < kStandstill) angles.head<3>() = last_.head<3>();
    const double length = FeedLength(last_, angles);
    if (length == 0) return;
    // G93 floors the speed along that length; slower motions state the speed itself.
    const double per_minute = length / duration * 60;
    const bool inverse = per_minute > kInverseTimeFloor;
    FeedMode(inverse);
    Line(fmt::format("G1 {} F{}", Words(angles), inverse ? Fixed(60 / duration, 6) : Fixed(per_minute, 9)));
    last_ = angles;
  }

  Pose ToolInBase(const Motion& motion) const {
    Pose X_BC = AsCounted(settings_, motion.external, X_BP_) * motion.X_PT;
    X_BC.linear() = X_BC.linear() * settings_.R_TC();
    return X_BC;
  }

  /// A straight motion as tool poses.
  void AddPose(size_t i) {
    const Motion& motion = program_.motions[i];
    const Pose X_BC = ToolInBase(motion);
    if (cartesian_ != true) {
      // The interpreter takes the pose from the kinematics: angles within half a turn.
      const Pose start = ToolInBase(program_.motions[i - 1]);
      pose_words_ << start.translation(), ToolAngles(settings_.rotation, start.linear()) * kDegPerRad;
      Coordinates(true);
    }
    if (motion.angles) {  // as read: short enough already
      AddPoseBlock(X_BC.translation(), *motion.angles, motion.feed, motion.duration, motion.exact);
      return;
    }
    const Motion& before = program_.motions[i - 1];
    const double length = (motion.X_PT.translation() - before.X_PT.translation()).norm();
    const double duration = LinearDuration(before, motion, arm_);
    const double feed = length / motion.feed < duration ? length / duration : motion.feed;
    AddPoses(ToolInBase(before), X_BC, {feed, duration, motion.exact}, 0);
  }

  struct Pace {
    double feed, duration;  // mm/s, s
    bool exact;
  };

  /// A straight line, halved until A, B, C that run evenly stay near the even turn about one axis.
  void AddPoses(const Pose& from, const Pose& to, const Pace& pace, int depth) {
    const Eigen::Vector3d first = pose_words_.tail<3>() * kRadPerDeg;
    const Eigen::Vector3d last = ToolAnglesNear(settings_.rotation, to.linear(), first);
    const Pose middle = PoseLine(from, to).At(0.5);
    const Eigen::Matrix3d halfway = FromToolAngles(settings_.rotation, (first + last) / 2);
    if (AngleBetween(halfway, middle.linear()) <= kHalfwayAngle || depth == kDeepest) {
      AddPoseBlock(to.translation(), last, pace.feed, pace.duration, pace.exact);
      return;
    }
    AddPoses(from, middle, {pace.feed, pace.duration / 2, false}, depth + 1);
    AddPoses(middle, to, {pace.feed, pace.duration / 2, pace.exact}, depth + 1);
  }

  void AddPoseBlock(const Eigen::Vector3d& place, const Eigen::Vector3d& angles, double feed, double duration,
                    bool exact) {
    Joints words;
    words << place, angles * kDegPerRad;
    for (int i = 0; i < 6; ++i) words[i] = Rounded(words[i], i < 3 ? kLengthDecimals : kAngleDecimals);
    const bool moves = (words - pose_words_).head<3>().cwiseAbs().maxCoeff() > 0.5e-4;
    const bool turns = (words - pose_words_).tail<3>().cwiseAbs().maxCoeff() > 0.5e-6;
    pose_words_ = words;
    if (!moves && !turns) return;
    PathMode(exact);
    FeedMode(!moves);
    std::string line = fmt::format("G1 X{} Y{} Z{} A{} B{} C{}", Fixed(words[0], kLengthDecimals),
                                   Fixed(words[1], kLengthDecimals), Fixed(words[2], kLengthDecimals),
                                   Fixed(words[3], kAngleDecimals), Fixed(words[4], kAngleDecimals),
                                   Fixed(words[5], kAngleDecimals));
    // F counts along X, Y, Z; a motion that only turns states its time.
    const std::string feed_text = moves ? Fixed(feed * 60, 4) : Fixed(60 / duration, 6);
    if (!moves || feed_text != feed_) line += " F" + feed_text;
    feed_ = moves ? feed_text : "";
    Line(line);
  }

  static std::string Words(const Joints& angles) {
    std::string words;
    for (int i = 0; i < 6; ++i)
      words += fmt::format("{}{}{}", i ? " " : "", "XYZABC"[i], Fixed(angles[i], kAngleDecimals));
    return words;
  }

  /// Words of the external axes that have moved since they were stated.
  std::string ExternalWords(const Motion& motion) {
    if (external_ == motion.external) return {};
    std::string words;
    for (const ControllerAxis& axis : settings_.controller_axes)
      words +=
          fmt::format(" {}{}", axis.name, Fixed(ValueOf(settings_, axis, motion.external), kAngleDecimals));
    external_ = motion.external;
    return words;
  }

  void FeedMode(bool inverse) {
    if (inverse_time_ != inverse) Line(inverse ? "G93" : "G94");
    if (inverse_time_ != inverse) feed_.clear();
    inverse_time_ = inverse;
  }

  void PathMode(bool exact) {
    const double bound = cartesian_ == true ? blend_ : BlendDegrees(blend_, arm_, X_FT_);
    const std::string mode = exact ? "G61.1" : fmt::format("G64 P{} Q0", Fixed(bound, 6));
    if (path_mode_ != mode) Line(mode);
    path_mode_ = mode;
  }

  void Event(const ProgramEvent& event) override {
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) Line("; " + place);
    if (event.kind == ProgramEvent::Kind::kPassEnd) Line("; END OF " + place);
    // Switched when the next motion begins, without a stop.
    if (event.kind == ProgramEvent::Kind::kOutput)
      Line(fmt::format("{} P{}", event.output.on ? "M62" : "M63", event.output.number));
    if (event.kind == ProgramEvent::Kind::kDwell) Line("G4 P" + ShortestNumber(event.value));
    AddTexts(event);
  }

  const LinuxCncOptions& options_;
  Pose X_BP_ = Pose::Identity();        // of the motion that is being written
  ExternalPosition external_;           // as stated last; empty: not stated
  Joints last_ = Joints::Zero();        // degrees, as written
  Joints pose_words_ = Joints::Zero();  // X, Y, Z, A, B, C of the last tool pose, mm and degrees, as written
  std::optional<bool> cartesian_;       // tool poses, not joints
  std::optional<bool> inverse_time_;
  std::string path_mode_;  // G61.1 or G64 with its bound, as it holds
  double blend_ = 0;       // mm, how far the tip may leave rounded corners of the motion
  std::string feed_;       // of G94, as written
};

}  // namespace

std::map<std::string, std::string> LinuxCncTexts(const PostSettings& settings) {
  std::map<std::string, std::string> texts = {{"spindle_on", "S{rpm} M3"},
                                              {"spindle_off", "M5"},
                                              {"cartesian_on", "M68 E3 Q0\nM66 E0 L0"},
                                              {"joints_on", "M68 E3 Q1\nM66 E0 L0"}};
  if (settings.ChangesTool())
    texts["tool_change"] =
        settings.tool_number ? "T{number} M6" : "(MSG, TOOL {tool}: put it in, then go on)\nM0";
  return texts;
}

double BlendDegrees(double blend, const Arm& arm, const Pose& X_FT) {
  return blend / (ArmLength(arm) + X_FT.translation().norm()) * kDegPerRad;
}

std::string NoOffsets(const PostSettings& settings) {
  std::string words = "G10 L2 P9 X0 Y0 Z0 A0 B0 C0";
  for (const ControllerAxis& axis : settings.controller_axes) words += fmt::format(" {}0", axis.name);
  return words + " R0";
}

// Joints count from nothing.
std::string LinuxCncPost::WhyNotIn(const PostSettings& settings) const {
  if (options_.cartesian || std::ranges::none_of(settings.controller_axes, &ControllerAxis::coupled))
    return "";
  return "controllers.linuxcnc.external_axes: coupled: true has no effect in joint programs (coordinates: "
         "joint); expected: false";
}

double FeedLength(const Joints& from, const Joints& to) {
  const double xyz = (to - from).head<3>().norm();
  return xyz > 0 ? xyz : (to - from).tail<3>().norm();
}

ProgramFiles LinuxCncPost::Write(const MotionProgram& program, const Arm& arm,
                                 const PostSettings& settings) const {
  assert(IsWellFormed(program));
  return LinuxCncWriter(program, arm, settings, options_).Write();
}

// The interpreter looks for a file of the name in lower case.
CallingSyntax LinuxCncPost::Calling() const {
  return {.longest = kLongestName,
          .letters = 1,
          .ending = ".ngc",
          .head = "; written by millpose for LinuxCNC\n",
          .call = "O<{name}> CALL\n",
          .tail = "M2\n",
          .called_ending = ".ngc",
          .called_head = "O<{name}> SUB\n",
          .called_tail = "O<{name}> ENDSUB\n",
          .called_lower = true};
}

// Parameter 5400: the number of the tool in the spindle.
std::string LinuxCncPost::ToolCheck(const PostSettings& settings) const {
  if (!settings.tool_number) return {};
  return "O9001 WHILE [#5400 NE {number}]\n(MSG, TOOL {number} {tool} EXPECTED)\nM0\nO9001 ENDWHILE";
}

// It adds what it does between points of its own accord.
double LinuxCncPost::AngleReserve() const { return kHalfwayAngle + kAngleMargin; }

void LinuxCncPost::Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const {
  ChooseOverlap(program, arm, settings, options_.cartesian);
}

}  // namespace millpose
