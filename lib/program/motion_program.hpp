// SPDX-License-Identifier: GPL-3.0-or-later
// A robot program free of any controller's syntax: what posts write and readers return.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/boxed.hpp"
#include "machine/robot/axis_convention.hpp"
#include "planning/result/plan_result.hpp"
#include "program/conventions.hpp"

namespace millpose {

enum class MotionType : uint8_t { kJoint, kLinear };  ///< PTP (all axes together) or LIN (tip on a line)

/// A call of a program of the plant that the cell declares: what it does to settings is unknown; it moves
/// nothing, or the arm from `from` to `to`.
struct DeclaredCall {
  std::string name;
  bool moves = false;
  Joints from = Joints::Zero(), to = Joints::Zero();  ///< rad, where it moves
  std::string text = {};                              ///< of the cell that makes it, where it moves
};

/// What a text does that changes the tool where the arm stands, without a program of the plant.
inline DeclaredCall ChangeByHand(const Joints& at) {
  return {"the change of tool", true, at, at, "tool_change"};
}

/// One motion to a target, at whose end all axes stand. The external axes move evenly with it: in joint
/// motions with the joints; in straight ones the tip stays on its line, and the tool turns as ever, in the
/// frame that the target counts in, which they carry. A joint motion goes to `q` where that is known, else to
/// `X_PT` on the arm's branch `status` with the turns `turn`.
struct Motion {
  MotionType type = MotionType::kJoint;
  Pose X_PT = Pose::Identity();  ///< target, tool in the workpiece frame; unset when read from joint angles
  std::optional<Joints> q;  ///< target angles, rad; always known when written, only if programmed when read
  std::optional<int> status, turn;  ///< S and T (bits of the controller's angles), where programmed
  /// rad: each of the controller's angles at its end lies within a revolution above (−∞: anywhere), where
  /// that is programmed (LS CONFIG).
  Boxed<Joints> least = std::nullopt;
  /// Where the external axes stand at its end: one value for each of MotionProgram::external_axes.
  ExternalPosition external;
  /// The frame that the target counts in, in the robot's base as it stands then; empty: the program's.
  Boxed<Pose> X_BP;
  /// The same frame in the robot's base as it stands where a motion with feed begins on whose way external
  /// axes move; else empty.
  Boxed<Pose> X_BP_begin = std::nullopt;
  double feed = 0;      ///< mm/s of the tip, LIN only
  double duration = 0;  ///< s, joint motions in inverse time; 0: as fast as the axes allow
  /// Orientation as programmed in three angles (SINUMERIK, Cartesian LinuxCNC), rad, not wrapped. They run
  /// evenly from those of the motion before, unless the program's `swivel` says otherwise.
  std::optional<Eigen::Vector3d> angles;
  double turn_speed = 0;       ///< rad/s, largest turning of the tool, LIN only; 0: no such limit
  double clearance_share = 1;  ///< of the cell's clearances, with which a planned motion was checked
  bool exact = false;          ///< exact stop (no blending)
  double blend = 0;            ///< mm; 0 when exact: how far the path may leave the corner, or see
                               ///< MotionProgram::blend_is_distance
  /// rad, as read: how far the orientation may leave it (SINUMERIK), or the joints 1 to 3 (LinuxCNC's
  /// joints).
  double angle_blend = 0;
  /// Index into MotionProgram::calls: what this call does, taken from the cell's word; −1 for none.
  int call = -1;
  int pass = -1, point = -1;  ///< which milling point; −1 for none
  int file = 0, line = 0;     ///< of the program text, when read: index into MotionProgram::files
};

/// An output that a cut switches on its path, without a stop.
struct PathOutput {
  int number = 0;
  bool on = true;
  double delay = 0;      ///< s after the place; negative: before
  bool at_begin = true;  ///< at the cut's first point, else at its last
};

/// What happens before a motion, at the place where the one before ends. A handover is where a long piece
/// goes on in another file; a dwell is a wait for some seconds. Those from kText on are made by texts and
/// hands alone: only a program that was read has them.
struct ProgramEvent {
  enum class Kind : uint8_t {
    kSpindleOn,
    kSpindleOff,
    kPassBegin,
    kPassEnd,
    kOutput,
    kHandover,
    kDwell,
    kText,     ///< a text of the cell other than the spindle's; `text`: its name
    kCall,     ///< of a program that the cell declares, outside of texts; `text`: name and arguments
    kStop,     ///< until somebody goes on
    kWait,     ///< for a condition
    kMessage,  ///< to the operator
    kTool      ///< words that change the tool, outside of texts
  } kind;
  size_t before_motion = 0;  ///< index into motions; motions.size() for the end
  double value = 0;          ///< spindle speed rev/s, pass number, or s of a dwell
  int piece = 0;             ///< of the pass
  PathOutput output;         ///< of kOutput
  int file = 0, line = 0;    ///< of the program text, when read
  std::string text = {};     ///< from kText on: upper case, single blanks
  std::string of = {};       ///< of a kCall: the cell's text that makes this call; empty: none does
};

struct MotionProgram {
  std::string name;
  std::vector<std::pair<std::string, std::string>> header;  ///< key, value: printed as comments
  std::vector<ExternalAxis> external_axes;                  ///< of the cell
  Pose X_WB = Pose::Identity();  ///< of the cell, with all of them at 0; unset where there are none
  std::optional<Pose> X_BP;      ///< workpiece (base) frame in the robot's base; empty when the text has none
  std::optional<Pose> X_FT;      ///< tool in the flange; empty when the text has none
  AxisConvention axes;           ///< of the controller, that `turn` counts in
  AngleOrder rotation = AngleOrder::kRpy;              ///< how `angles` of motions turn, see ToolAngles()
  Eigen::Matrix3d R_TC = Eigen::Matrix3d::Identity();  ///< controller's tool frame, whose `angles` these are
  bool blend_is_distance = false;  ///< of motions: from the corner to where its rounding may begin
  /// Unit direction of the tool, in T, that straight motions swivel evenly while the tool turns evenly about
  /// it (KRL's $TOOL_DIRECTION); empty: one even turn, or by `angles`.
  std::optional<Eigen::Vector3d> swivel;
  /// Beside `swivel` the control may turn the tool evenly about one axis or by `angles` of the motions that
  /// run evenly: its machine data decide, and nobody has said how they stand.
  bool any_turn = false;
  bool frames_checked = false;  ///< stops before its first motion where the controller's frames are others
  bool blend_overlaps = false;  ///< motions overlap at corners; `blend` bounds the tip alone
  /// What a rounded corner is taken to stay within, in one sentence, where the maker does not document its
  /// path (docs/verification.md); blends are then distances. Empty: its path is known.
  std::string corner_assumption;
  std::vector<Motion> motions;
  std::vector<ProgramEvent> events;  ///< ascending by before_motion
  std::vector<DeclaredCall> calls;   ///< that it makes, each once
  bool switches_spindle = true;      ///< as read: the cell has a text that does
  std::string notice;                ///< shown to the operator before the first motion; empty: none
  std::vector<std::string> files;    ///< names of the texts it was read from
};

/// What the header says under `key`, which may go on in further lines of the key; empty where nothing.
std::string HeaderValue(const MotionProgram& program, const std::string& key);

/// The frame that a motion's target counts in, in the robot's base; empty when the text has none.
inline std::optional<Pose> FrameOf(const MotionProgram& program, const Motion& motion) {
  return motion.X_BP ? motion.X_BP.AsOptional() : program.X_BP;
}

/// Whether the external axes move in motion `i`; where they come from before the first one is not known.
bool MovesExternal(const MotionProgram& program, size_t i);
/// Whether they move along a cut: in a motion with feed.
bool CoordinatedMotions(const MotionProgram& program, size_t i);
/// Whether they do so anywhere.
bool HasCoordinatedMotions(const MotionProgram& program);
/// Where they stand at `share` (0..1) of its way.
ExternalPosition ExternalOf(const MotionProgram& program, size_t i, double share);
/// The robot's base as seen from what carries the part, which stands in W with all external axes at 0.
Pose BaseOnPart(const MotionProgram& program, const ExternalPosition& external);
/// The frame that its target counts in, in the robot's base as it stands at `share` of its way. Precondition:
/// the motion has its frame.
Pose FrameAt(const MotionProgram& program, size_t i, double share);

/// The notice of a program whose poses take the expected deflection out: run twice it would cut twice.
inline constexpr char kCompensatedNotice[] = "COMPENSATED: NOT TO BE RUN TWICE ON ONE PART";

/// The key of a header's line that says that the tool is in the spindle already.
inline constexpr char kToolHeldKey[] = "tool_held";

/// A call that moves the arm, made from home and back to home.
struct CallTransition {
  DeclaredCall call;
  std::vector<Joints> there, back;  ///< from home to where the call begins, and from where it ends to home
  double clearance_share = 1;       ///< of the cell's clearances, with which both were planned
};

/// What a program says beyond its plan.
struct MotionOptions {
  std::vector<std::pair<std::string, std::string>> header;  ///< after job, cell and inputs
  std::string notice;
  double approach_feed = 0;  ///< mm/s; 0: none of its own
  double approach_slow = 0;  ///< mm before the first point that run at the plunge feed
  double plunge_feed = 0;    ///< mm/s towards material; 0: the feed of the first point
  double retract_feed = 0;   ///< mm/s; 0: the feed of the last point
  double dwell = 0;          ///< s, where a piece turns back for the last time: at the bottom of a hole
  std::vector<PathOutput> outputs;
  std::vector<CallTransition> calls;  ///< that of text footer at the end, the others at the beginning
};

/// Why no program can be made of a plan (a gap that could not be planned, nothing planned at all); empty when
/// one can.
std::string WhyNotProgrammable(const PlanResult& plan);

/// The plan with every point lifted by `offset` (mm) along the tool axis, to see its program run in the air;
/// no more than what a program is made of follows. A point that the arm does not reach then is an InputError
/// naming pass and point.
PlanResult Lifted(PlanResult plan, double offset);

/// The motions of a plan in order: PTP home, from there the calls that move; per gap the way-points as PTP,
/// the last one (where the approach begins) as a pose with S and T; LIN approach (in two parts where it has a
/// feed of its own), LIN cuts (a closed piece returns to its first point as a last motion), LIN retract; PTP
/// home. The spindle turns from before the first approach to after the last retract. The last cut, both ends
/// of approach and retract, where a cut turns back, and where it slows down on its way along the tool axis,
/// are exact. Between stations the spindle stands still, and the external axes move in a joint motion of
/// their own, in which the arm stands at home; where they move along a cut each of its points has its own
/// position of them. Precondition: WhyNotProgrammable() is empty.
MotionProgram MakeMotionProgram(const PlanResult& plan, const MotionOptions& options = {});

/// Straight and timed motions; the others move as fast as the axes allow.
bool HasFeed(const Motion& motion);

/// s that the arm stands still at the end of each motion.
std::vector<double> Dwells(const MotionProgram& program);

/// The program's lists are consistent: `before_motion` ascending and in range. For assertions.
bool IsWellFormed(const MotionProgram& program);

}  // namespace millpose
