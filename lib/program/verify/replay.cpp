// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/replay.hpp"

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"
#include "program/programmed_line.hpp"

namespace millpose {
namespace {

constexpr double kTurnStep = 0.5 * kRadPerDeg;
constexpr double kLargestTurn = 4 * kPi;  // rad that a straight motion may turn; more is no program of ours
constexpr double kFarOutside = 2 * kPi;   // rad beyond the limits: not sampled, the arm stays where it was
constexpr double kTurnSlack = 2e-4;       // rad: where rounding decides which turn an axis is said to be in
constexpr double kCallSlack = 1e-4;       // rad: six decimals of a degree, and turns counted exactly
constexpr double kMostSteps = 1e6;        // of one motion: lengths and turns are bounded before
constexpr double kTargetStep = 5;  // mm: from target to target full revolutions must be followed, no more

/// The programmed tool in B of a motion; the tool that the program believes in.
Pose ProgrammedTool(const MotionProgram& program, const Motion& motion) {
  return FrameOf(program, motion).value_or(Pose::Identity()) * motion.X_PT;
}

Pose ToolOf(const MotionProgram& program, const Cell& cell) { return program.X_FT.value_or(cell.X_FT); }

/// A straight motion in the frame that its target counts in.
struct FramedLine {
  ProgrammedLine line;
  Pose X_BP = Pose::Identity();
  /// Where external axes carry that frame along: the program, and which of its motions.
  const MotionProgram* program = nullptr;
  size_t index = 0;

  Pose At(double share) const { return (program ? FrameAt(*program, index, share) : X_BP) * line.At(share); }
  double length() const { return line.length(); }
  double angle() const { return line.angle(); }
};

int StepsOf(const FramedLine& line, double step, double external_parts = 0) {
  const double parts = std::max({line.length() / step, line.angle() / kTurnStep, external_parts});
  return std::max(1, static_cast<int>(std::ceil(std::min(parts, kMostSteps))));
}

/// The same where external axes carry the target's frame along: straight, and turning as ever, in that frame.
FramedLine CarriedLineOf(const MotionProgram& program, size_t index, const Pose& X_BT) {
  const Motion &motion = program.motions[index], &before = program.motions[index - 1];
  const Pose from = motion.X_BP_begin->inverse() * X_BT;
  const auto carried = [&](const ProgrammedLine& line) {
    return FramedLine{line, Pose::Identity(), &program, index};
  };
  if (program.swivel) return carried(ProgrammedLine(from, motion.X_PT, *program.swivel));
  if (!motion.angles) return carried(ProgrammedLine(from, motion.X_PT));
  const Eigen::Vector3d first =
      before.angles ? *before.angles : ToolAngles(program.rotation, from.linear() * program.R_TC);
  return carried(ProgrammedLine(from.translation(), motion.X_PT.translation(), program.rotation, program.R_TC,
                                first, *motion.angles));
}

/// The straight motion `index` of a program from where the tool stands.
FramedLine LineOf(const MotionProgram& program, size_t index, const Pose& X_BT) {
  const Motion& motion = program.motions[index];
  if (motion.X_BP_begin) return CarriedLineOf(program, index, X_BT);
  const Pose target = ProgrammedTool(program, motion);
  if (program.swivel) return {ProgrammedLine(X_BT, target, *program.swivel)};
  if (!motion.angles) return {ProgrammedLine(X_BT, target)};
  // Angles run evenly in the frame that they count in, which a coupled table turns in the robot's base.
  const Pose X_BP = FrameOf(program, motion).value_or(Pose::Identity());
  const Pose from = X_BP.inverse() * X_BT;
  const Motion* before = index > 0 ? &program.motions[index - 1] : nullptr;
  const Eigen::Vector3d first =
      before && before->angles ? *before->angles : ToolAngles(program.rotation, from.linear() * program.R_TC);
  return {ProgrammedLine(from.translation(), motion.X_PT.translation(), program.rotation, program.R_TC, first,
                         *motion.angles),
          X_BP};
}

/// The joint positions along a straight line; stops early where the branch ends. True when it came through.
bool FollowLine(const Arm& arm, const Pose& X_FT, const FramedLine& line, int steps, const Joints& start,
                std::vector<Joints>& angles) {
  const int branch = Status(arm, start);
  const Pose X_TF = X_FT.inverse();
  Joints q = start;
  for (int i = 1; i <= steps; ++i) {
    const auto next = InverseNear(arm, line.At(static_cast<double>(i) / steps) * X_TF, branch, q);
    if (!next) return false;
    angles.push_back(q = *next);
  }
  return true;
}

/// The axis that is farther outside its limits than any slip of rounding or turns, 0 for none.
int FarOutside(const Arm& arm, const Joints& q) {
  for (int i = 0; i < 6; ++i) {
    const bool inside = q[i] >= arm.lower[i] - kFarOutside && q[i] <= arm.upper[i] + kFarOutside;
    if (!inside) return i + 1;
  }
  return 0;
}

/// The joint target of a straight motion from `q`. Its end and its turn are tested before anything is
/// sampled.
std::optional<Joints> StraightTarget(const MotionProgram& program, const Cell& cell, size_t index,
                                     const Joints& q, std::string& reason) {
  const Pose X_FT = ToolOf(program, cell);
  const FramedLine line = LineOf(program, index, ForwardFlange(cell.arm, q) * X_FT);
  const int branch = Status(cell.arm, q);
  reason = fmt::format("the straight motion leaves the arm's reach in configuration S = {}", branch);
  if (!InverseNear(cell.arm, line.At(1) * X_FT.inverse(), branch, q)) return std::nullopt;
  if (line.angle() > kLargestTurn) {
    reason = fmt::format("the straight motion turns by {:.0f} deg", line.angle() * kDegPerRad);
    return std::nullopt;
  }
  std::vector<Joints> angles;
  const double parts = ExternalParts(program, index, kTargetStep, kTurnStep);
  if (!FollowLine(cell.arm, X_FT, line, StepsOf(line, kTargetStep, parts), q, angles)) return std::nullopt;
  return angles.back();
}

/// What a call that the cell declares leaves behind; it must begin where the cell says.
std::optional<Joints> CallTarget(const MotionProgram& program, const Motion& motion,
                                 const std::optional<Joints>& q, std::string& reason) {
  const DeclaredCall& call = program.calls[static_cast<size_t>(motion.call)];
  const double off = q ? (*q - call.from).cwiseAbs().maxCoeff() : 0;
  if (q && off <= kCallSlack) return call.to;
  reason = q ? fmt::format("{} must be called at its from_deg; a joint is off by {:.3f} deg", call.name,
                           off * kDegPerRad)
             : fmt::format("{} is called at an unknown place", call.name);
  return std::nullopt;
}

/// The external axis that motion `index` takes along a cut to or from farther outside its limits than they
/// are wide; empty for none. Such a way is not worth following: it may be kilometres long.
std::string FarAlong(const MotionProgram& program, size_t index) {
  for (size_t k = 0; k < program.external_axes.size() && CoordinatedMotions(program, index); ++k) {
    const ExternalAxis& axis = program.external_axes[k];
    const double range = axis.upper - axis.lower;
    for (const size_t end : {index - 1, index}) {
      const double value = program.motions[end].external[k];
      const bool near = value >= axis.lower - range && value <= axis.upper + range;
      if (!near) return axis.name;
    }
  }
  return {};
}

/// Why the arm does not arrive at `q` as a motion's text says that it stands there; empty: it does.
std::string WhyNotAsStated(const MotionProgram& program, const Cell& cell, const Motion& motion,
                           const Joints& q) {
  if (const int status = Status(cell.arm, q); motion.status && *motion.status != status)
    return fmt::format("the straight motion arrives in configuration S = {}, but S = {} is stated", status,
                       *motion.status);
  const Joints angles = program.axes.FromArm(q);
  for (int i = 0; motion.least && i < 6; ++i) {
    const double from = (*motion.least)[i];
    if (angles[i] >= from - kTurnSlack && (angles[i] <= from + 2 * kPi + kTurnSlack || std::isinf(from)))
      continue;
    return fmt::format(
        "the straight motion arrives with A{} at {:.3f} deg, but {:.0f} to {:.0f} deg are stated", i + 1,
        angles[i] * kDegPerRad, from * kDegPerRad, from * kDegPerRad + 360);
  }
  return {};
}

/// The joint target of one motion from `q`; empty with a reason.
std::optional<Joints> Target(const MotionProgram& program, const Cell& cell, size_t index,
                             const std::optional<Joints>& q, std::string& reason) {
  const Motion& motion = program.motions[index];
  if (motion.call >= 0) return CallTarget(program, motion, q, reason);
  if (const std::string far = FarAlong(program, index); !far.empty()) {
    reason = fmt::format("{} leaves its limits by more than its whole range", far);
    return std::nullopt;
  }
  if (motion.type == MotionType::kJoint && motion.q) {
    const int axis = FarOutside(cell.arm, *motion.q);
    if (axis == 0) return motion.q;
    reason = fmt::format("A{} at {:.3f} deg leaves its limits", axis, (*motion.q)[axis - 1] * kDegPerRad);
    return std::nullopt;
  }
  if (!FrameOf(program, motion)) {
    reason = "a pose is approached, but no base frame is set";
    return std::nullopt;
  }
  if (motion.type == MotionType::kLinear) {
    if (!q) {
      reason = "the program begins with a straight motion from an unknown place";
      return std::nullopt;
    }
    const std::optional<Joints> target = StraightTarget(program, cell, index, *q, reason);
    if (!target) return std::nullopt;
    reason = WhyNotAsStated(program, cell, motion, *target);
    return reason.empty() ? target : std::nullopt;
  }
  if (!q && !(motion.status && motion.turn)) {
    reason = "the first pose has no S and T (STAT and TU), so the configuration is not defined";
    return std::nullopt;
  }
  const Pose X_BF = ProgrammedTool(program, motion) * ToolOf(program, cell).inverse();
  const int status = motion.status ? *motion.status : Status(cell.arm, *q);
  reason = fmt::format("the pose cannot be reached in configuration S = {}", status);
  return motion.turn ? AnglesAt(cell.arm, program.axes, X_BF, status, *motion.turn)
                     : InverseNear(cell.arm, X_BF, status, *q);
}

}  // namespace

double ExternalParts(const MotionProgram& program, size_t index, double length, double angle) {
  double parts = 0;
  for (size_t k = 0; k < program.external_axes.size() && MovesExternal(program, index); ++k) {
    const double way = std::abs(program.motions[index].external[k] - program.motions[index - 1].external[k]);
    parts = std::max(parts, way / (program.external_axes[k].kind == AxisKind::kLinear ? length : angle));
  }
  return parts;
}

Finding At(const MotionProgram& program, size_t motion, Cause cause, std::string message) {
  const Motion& at = program.motions[motion];
  const std::string file = at.file < static_cast<int>(program.files.size())
                               ? program.files[static_cast<size_t>(at.file)]
                               : std::string();
  return {file, at.line, std::move(message), cause};
}

Replay ReplayTargets(const MotionProgram& program, const Cell& cell, std::vector<Finding>& findings) {
  Replay replay;
  std::optional<Joints> q;
  for (size_t i = 0; i < program.motions.size(); ++i) {
    std::string reason;
    const std::optional<Joints> target = Target(program, cell, i, q, reason);
    if (!target) findings.push_back(At(program, i, Cause::kReach, reason));
    if (target) q = target;
    replay.targets.push_back(q.value_or(cell.home));
    replay.reached.push_back(target.has_value());
  }
  return replay;
}

std::vector<ProgrammedLine> OtherWays(const MotionProgram& program, const Replay& replay, const Cell& cell,
                                      size_t index) {
  if (!program.any_turn || index == 0 || program.motions[index].type != MotionType::kLinear) return {};
  const Motion& motion = program.motions[index];
  const Pose X_PB =
      (motion.X_BP_begin ? *motion.X_BP_begin : FrameOf(program, motion).value_or(Pose::Identity()))
          .inverse();
  const Pose start = X_PB * ForwardFlange(cell.arm, replay.targets[index - 1]) * ToolOf(program, cell);
  std::vector<ProgrammedLine> ways = {ProgrammedLine(start, motion.X_PT)};
  if (!motion.angles) return ways;
  // Behind a joint motion the control finds A, B, C itself; where they have no one value (B at 90 degrees, an
  // angle at 180) it is taken to turn the shorter way.
  const Eigen::Vector3d first = program.motions[index - 1].angles.value_or(
      ToolAnglesNear(program.rotation, start.linear() * program.R_TC, *motion.angles));
  ways.emplace_back(start.translation(), motion.X_PT.translation(), program.rotation, program.R_TC, first,
                    *motion.angles);
  return ways;
}

Pose RealTool(const MotionProgram& program, const Cell& cell, size_t index, double share, const Pose& X_PT) {
  const Motion& motion = program.motions[index];
  const Pose X_BP = motion.X_BP_begin ? FrameAt(program, index, share)
                                      : FrameOf(program, motion).value_or(Pose::Identity());
  return X_BP * X_PT * ToolOf(program, cell).inverse() * cell.X_FT;
}

void AppendInstants(const MotionProgram& program, const Cell& cell, const Replay& replay, size_t index,
                    double step, std::vector<Instant>& instants, std::vector<Finding>& findings) {
  const Motion& motion = program.motions[index];
  if (index == 0 || !replay.reached[index] || motion.call >= 0) return;
  const Joints &from = replay.targets[index - 1], &to = replay.targets[index];
  const Pose X_FT = ToolOf(program, cell);
  const Pose start = ForwardFlange(cell.arm, from) * X_FT;
  const FramedLine line = motion.type == MotionType::kLinear
                              ? LineOf(program, index, start)
                              : FramedLine{ProgrammedLine(start, ForwardFlange(cell.arm, to) * X_FT)};
  const bool rides = CoordinatedMotions(program, index);
  const int steps = StepsOf(line, step, rides ? ExternalParts(program, index, step, kTurnStep) : 0);
  std::vector<Joints> angles;
  if (motion.type == MotionType::kJoint) {
    for (int i = 1; i <= steps; ++i) angles.push_back(from + (to - from) * (static_cast<double>(i) / steps));
  } else if (!FollowLine(cell.arm, X_FT, line, steps, from, angles)) {
    findings.push_back(
        At(program, index, Cause::kReach, "the straight motion leaves the arm's reach on its way"));
  }
  for (size_t i = 0; i < angles.size(); ++i) {
    instants.push_back({angles[i], ForwardFlange(cell.arm, angles[i]) * cell.X_FT, index,
                        static_cast<double>(i + 1) / steps});
  }
}

}  // namespace millpose
