// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/linuxcnc/linuxcnc.hpp"

#include <cassert>

#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/linuxcnc/linuxcnc_rounding.hpp"
#include "program/program_name.hpp"
#include "program/writer.hpp"

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
  Joints angles = axes.FromArm(q) * kDegPerRad;
  for (double& angle : angles) angle = Rounded(angle, kAngleDecimals);
  return angles;
}

class LinuxCncWriter : public ProgramWriter {
 public:
  LinuxCncWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
                 const LinuxCncOptions& options)
      : ProgramWriter(program, arm, settings, LinuxCncTexts(settings)), options_(options) {}

  ProgramFiles Write(const std::string& ending) {
    WriteSections();
    return {{LegalName(program_.name, kLongestName, 1) + ending,
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
      const Pace pace{0, LinearDuration(program_, i, arm_), motion.exact};
      AddLine(i, {before.X_PT, *before.q, 0}, {motion.X_PT, *motion.q, 1}, pace, 0);
    } else if (motion.duration > 0) {
      AddTimed(*motion.q, {0, motion.duration, motion.exact}, motion.external);
    } else {
      PathMode(motion.exact);
      const Joints angles = AsWritten(settings_.axes, *motion.q);
      Line("G0 " + Words(angles) + Stated(motion.external));
      last_ = angles;
    }
  }

  /// How a motion, or a part of one, is run.
  struct Pace {
    double feed, duration;  // mm/s, s
    bool exact;
    double begin = 0, end = 1;  // shares of the motion
  };

  /// A place of a straight motion.
  struct LinePlace {
    Pose X_PT;
    Joints q;
    double share;  // of the motion
  };

  /// The workpiece frame in the base at `share` of motion `i`.
  Pose BaseFrame(size_t i, double share) const {
    return program_.motions[i].X_BP_begin ? FrameAt(program_, i, share) : X_BP_;
  }

  /// A straight line of the tip, of motion `i`, halved until the joint motions between stay near it.
  void AddLine(size_t i, const LinePlace& from, const LinePlace& to, const Pace& pace, int depth) {
    const double share = (from.share + to.share) / 2;
    Pose middle = Pose::Identity();
    middle.translation() = (from.X_PT.translation() + to.X_PT.translation()) / 2;
    // Half-way of the shortest turn: the normalised sum of the two quaternions.
    const Eigen::Quaterniond first(from.X_PT.linear()), second(to.X_PT.linear());
    const double side = first.dot(second) < 0 ? -1 : 1;
    middle.linear() =
        Eigen::Quaterniond(first.coeffs() + side * second.coeffs()).normalized().toRotationMatrix();
    const Joints halfway = (from.q + to.q) / 2;
    const Pose X_BP = BaseFrame(i, share);
    const Pose reached = X_BP.inverse() * ForwardFlange(arm_, halfway) * X_FT_;
    const Eigen::Vector3d off = reached.translation() - middle.translation();
    const double turned = AngleBetween(reached.linear(), middle.linear());
    const auto q_middle = InverseNear(arm_, X_BP * middle * X_FT_.inverse(), Status(arm_, to.q), halfway);
    // Where the arm changes its branch half-way no joint motion follows the line; read-back says so.
    // A tip that is ahead or behind runs at another feed, and stands where the tool is turned otherwise.
    const PoseLine line(from.X_PT, to.X_PT);
    const Eigen::Vector3d way = to.X_PT.translation() - from.X_PT.translation();
    const double ahead = line.length() > kStandstill ? std::abs(off.dot(way)) / way.squaredNorm() : 0;
    const bool near = off.norm() <= kHalfwayDeviation && turned <= kHalfwayAngle && ahead <= kHalfwayLead &&
                      ahead * line.angle() <= kHalfwayTurn;
    if (near || depth == kDeepest || !q_middle) {
      AddTimed(to.q, pace, ExternalOf(program_, i, to.share));
      return;
    }
    const LinePlace at{middle, *q_middle, share};
    AddLine(i, from, at, {0, pace.duration / 2, false}, depth + 1);
    AddLine(i, at, to, {0, pace.duration / 2, pace.exact}, depth + 1);
  }

  void AddTimed(const Joints& q, const Pace& pace, const ExternalPosition& external) {
    PathMode(pace.exact);
    Joints angles = AsWritten(settings_.axes, q);
    if ((angles - last_).head<3>().norm() < kStandstill) angles.head<3>() = last_.head<3>();
    const double length = FeedLength(last_, angles, ExternalWay(external));
    if (length == 0) return;
    // G93 floors the speed along that length; slower motions state the speed itself.
    const double per_minute = length / pace.duration * 60;
    const bool inverse = per_minute > kInverseTimeFloor;
    FeedMode(inverse);
    Line(fmt::format("G1 {}{} F{}", Words(angles), Stated(external),
                     inverse ? Fixed(60 / pace.duration, 6) : Fixed(per_minute, 9)));
    last_ = angles;
  }

  Pose ToolInBase(const Motion& motion) const {
    const Pose X_BP = FrameOf(program_, motion).value_or(Pose::Identity());
    Pose X_BC = AsCounted(settings_, motion.external, X_BP) * motion.X_PT;
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
      AddPoseBlock(X_BC.translation(), *motion.angles, {motion.feed, motion.duration, motion.exact},
                   motion.external);
      return;
    }
    const Motion& before = program_.motions[i - 1];
    const double length = (motion.X_PT.translation() - before.X_PT.translation()).norm();
    const double duration = LinearDuration(program_, i, arm_);
    const double feed = length / motion.feed < duration ? length / duration : motion.feed;
    AddPoses(i, ToolInBase(before), X_BC, {feed, duration, motion.exact}, 0);
  }

  /// A straight line, halved until A, B, C that run evenly stay near the even turn about one axis.
  void AddPoses(size_t i, const Pose& from, const Pose& to, const Pace& pace, int depth) {
    const Eigen::Vector3d first = pose_words_.tail<3>() * kRadPerDeg;
    const Eigen::Vector3d last = ToolAnglesNear(settings_.rotation, to.linear(), first);
    const Pose middle = PoseLine(from, to).At(0.5);
    const Eigen::Matrix3d halfway = FromToolAngles(settings_.rotation, (first + last) / 2);
    if (AngleBetween(halfway, middle.linear()) <= kHalfwayAngle || depth == kDeepest) {
      AddPoseBlock(to.translation(), last, pace, ExternalOf(program_, i, pace.end));
      return;
    }
    const double share = (pace.begin + pace.end) / 2;
    AddPoses(i, from, middle, {pace.feed, pace.duration / 2, false, pace.begin, share}, depth + 1);
    AddPoses(i, middle, to, {pace.feed, pace.duration / 2, pace.exact, share, pace.end}, depth + 1);
  }

  void AddPoseBlock(const Eigen::Vector3d& place, const Eigen::Vector3d& angles, const Pace& pace,
                    const ExternalPosition& external) {
    Joints words;
    words << place, angles * kDegPerRad;
    for (int i = 0; i < 6; ++i) words[i] = Rounded(words[i], i < 3 ? kLengthDecimals : kAngleDecimals);
    const bool moves = (words - pose_words_).head<3>().cwiseAbs().maxCoeff() > 0.5e-4;
    const bool turns = (words - pose_words_).tail<3>().cwiseAbs().maxCoeff() > 0.5e-6;
    pose_words_ = words;
    if (!moves && !turns && ExternalWay(external).isZero(0)) return;
    PathMode(pace.exact);
    FeedMode(!moves);
    std::string line = fmt::format("G1 X{} Y{} Z{} A{} B{} C{}", Fixed(words[0], kLengthDecimals),
                                   Fixed(words[1], kLengthDecimals), Fixed(words[2], kLengthDecimals),
                                   Fixed(words[3], kAngleDecimals), Fixed(words[4], kAngleDecimals),
                                   Fixed(words[5], kAngleDecimals)) +
                       Stated(external);
    // F counts along X, Y, Z; a motion that only turns states its time.
    const std::string feed_text = moves ? Fixed(pace.feed * 60, 4) : Fixed(60 / pace.duration, 6);
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

  /// Words of the external axes where they have moved since they were stated; now they are stated.
  std::string Stated(const ExternalPosition& external) {
    if (external_ == external) return {};
    std::string words;
    for (const ControllerAxis& axis : settings_.controller_axes)
      words += fmt::format(" {}{}", axis.name, Fixed(ValueOf(settings_, axis, external), kAngleDecimals));
    external_ = external;
    return words;
  }

  /// What U, V, W move by, as written, from where they were stated.
  Eigen::Vector3d ExternalWay(const ExternalPosition& external) const {
    if (external_.empty() || external_ == external) return Eigen::Vector3d::Zero();
    const auto words = [&](const ExternalPosition& at) {
      return ExternalWords(settings_, at)
          .unaryExpr([](double word) { return Rounded(word, kAngleDecimals); })
          .eval();
    };
    return words(external) - words(external_);
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

Eigen::Vector3d ExternalWords(const PostSettings& settings, const ExternalPosition& external) {
  Eigen::Vector3d words = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < std::min<size_t>(settings.controller_axes.size(), 3); ++k)
    words[static_cast<Eigen::Index>(k)] = ValueOf(settings, settings.controller_axes[k], external);
  return words;
}

double FeedLength(const Joints& from, const Joints& to, const Eigen::Vector3d& external) {
  const double xyz = (to - from).head<3>().norm(), uvw = external.norm();
  if (xyz > 0) return xyz;
  return uvw > 0 ? uvw : (to - from).tail<3>().norm();
}

ProgramFiles LinuxCncPost::Write(const MotionProgram& program, const Arm& arm,
                                 const PostSettings& settings) const {
  assert(IsWellFormed(program));
  return LinuxCncWriter(program, arm, settings, options_).Write(Endings().front());
}

// The interpreter looks for a file of the name in lower case.
CallingSyntax LinuxCncPost::Calling() const {
  return {.longest = kLongestName,
          .letters = 1,
          .ending = Endings().front(),
          .head = "; written by millpose for LinuxCNC\n",
          .call = "O<{name}> CALL\n",
          .tail = "M2\n",
          .called_ending = Endings().front(),
          .called_head = "O<{name}> SUB\n",
          .called_tail = "O<{name}> ENDSUB\n",
          .called_lower = true};
}

// It adds what it does between points of its own accord.
double LinuxCncPost::AngleReserve() const { return kHalfwayAngle + kAngleMargin; }

void LinuxCncPost::Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const {
  ChooseOverlap(program, arm, settings, options_.cartesian);
}

}  // namespace millpose
