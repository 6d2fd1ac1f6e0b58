// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>

#include "base/error.hpp"
#include "machine/motion/corner.hpp"
#include "program/post_options.hpp"
#include "program/program_time.hpp"
#include "program/programmed_line.hpp"
#include "program/templates.hpp"

namespace millpose {

/// What hangs on the flange, as KRL's $LOAD counts it.
struct ToolLoad {
  double mass = 0;                                    ///< kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of gravity, in F, mm
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  ///< about it, along F's axes, kg·m²
};

/// What a program needs to know beyond its motions and the controller's own options.
struct PostSettings : PostOptions {
  AxisConvention axes;             ///< how the controller counts the arm's angles
  Pose X_FT = Pose::Identity();    ///< tool in the flange, for programs that state none
  Pose X_WB = Pose::Identity();    ///< the robot's base in the cell, whose z points up
  Mechanism mechanism;             ///< the cell's external axes; X_WB holds with all of them at 0
  std::string tool_name;           ///< T="…", printed in headers
  std::optional<int> tool_number;  ///< by which the controller knows it
  std::string tool_check;      ///< lines that wait until the tool is in the spindle, see Post::ToolCheck()
  bool several_tools = false;  ///< the spindle can hold others as well
  bool tool_held = false;      ///< it is in the spindle already: only `tool_check` stands in programs
  std::optional<Joints> change_at;  ///< where the arm stands for it, rad; else it is at home
  std::optional<ToolLoad> load;     ///< where the cell gives it
  PathTolerance tolerance =
      WrittenTolerance({});                  ///< that the program keeps: a share of what verification allows
  double blend = 0.01;                       ///< mm: CTOL or G64 P
  double orientation_blend = 0.00017453293;  ///< rad (0.01°), tolerance of the orientation

  /// Whether programs change the tool themselves, if only by asking somebody for it.
  bool ChangesTool() const { return several_tools || change_at || tool_held; }
};

/// What fills the holes of its texts.
inline Templates::Tool ToolOf(const PostSettings& settings) {
  return {settings.tool_name, settings.tool_number, settings.tool_check, settings.tool_held};
}

/// What a program's head says of the frames that its numbers count in.
struct FrameTexts {
  std::string tool, base;                                 ///< whose poses the head prints
  std::vector<std::pair<std::string, std::string>> more;  ///< key, value
};

/// How a controller's main program calls others; {name} is the program's. Without `call` none can. What the
/// last line of `head` and `tail` is stands in every program of the controller.
struct CallingSyntax {
  size_t longest = 24, letters = 1;                    ///< of names, see LegalName()
  std::set<std::string> reserved = {};                 ///< names that are no program's, in lower case
  std::string ending = {};                             ///< of main programs
  std::string head = {}, call = {}, tail = {};         ///< each line with its end
  std::string closing = {};                            ///< before `tail` where there is nothing but calls
  std::map<std::string, std::string> beside = {};      ///< further files of a main program, by ending
  std::string called_ending = {};                      ///< of a program that is called
  std::string called_head = {}, called_tail = {};      ///< round its text, in place of `tail`
  bool called_lower = false;                           ///< its name is in lower case
  std::string comment_begin = "; ", comment_end = {};  ///< of comments by themselves
  size_t comment_width = 98;                           ///< characters between
};

/// The files of one program by name, e.g. {"cabin_panel.src", …}.
using ProgramFiles = std::map<std::string, std::string>;

/// Writes and reads one controller's programs, and says what the controller is like. An implementation holds
/// the options of its own and ends with its PostEntry (post_entry.hpp); its name stands in post.cpp.
class Post {
 public:
  virtual ~Post() = default;
  virtual std::string Name() const = 0;  ///< krl, rapid, sinumerik, …: also the folder's name
  /// Of its files, that of main programs first: {".mpf", ".spf"}.
  virtual std::vector<std::string> Endings() const = 0;

  /// The ways in which the controller may make a straight motion; empty: with one even turn.
  virtual std::vector<LineModel> Lines(const PostSettings&) const { return {}; }
  /// rad: what the controller itself does to the orientation between points.
  virtual double AngleReserve() const { return 0; }
  /// Rounding of corners that is asked for as one tolerance, mm; `chord`: that of the tool path.
  virtual double Blend(const PathTolerance& tolerance, double chord) const;
  /// Sets how far each corner is rounded, within the settings' tolerance.
  virtual void Round(MotionProgram& program, const Arm& arm, const PostSettings& settings) const = 0;
  /// Whether the controller counts in a world of its own, where programs state and check the robot's base.
  virtual bool HasOwnWorld() const { return false; }
  /// The robot's base in that world, with the cell's external axes at 0, as the cell says that the controller
  /// has it.
  virtual Pose BaseInWorld(const PostSettings&) const { return Pose::Identity(); }
  /// How it counts the inner angles of every arm that it runs, where its maker fixes that: signs and zero.
  virtual std::optional<AxisConvention> OwnZero() const { return std::nullopt; }
  /// Whether its programs tell configurations by those of a spherical wrist.
  virtual bool NeedsSphericalWrist() const { return true; }
  /// Whether it moves axes beside the arm's six at all.
  virtual bool HasExternalAxes() const { return true; }
  /// Whether programs are read from a disk as they run: no file is too long, and entries are joint angles.
  virtual bool ReadsFromDisk() const { return false; }
  /// Whether all axes, the external ones among them, run evenly from place to place of its programs, which
  /// are dense enough for that: then nothing need count in what moves along a cut.
  virtual bool MovesAllTogether() const { return false; }
  virtual double UsualCycle() const = 0;  ///< s, of interpolation as it is often set up
  /// Whether it goes to where an approach begins by the axes' angles in any case: no turn bit counts.
  virtual bool EntersByJoints() const { return ReadsFromDisk(); }
  /// Longest line (bytes) of a motion with what may stand before it: how many fit into a file for certain.
  virtual size_t BytesPerMotion() const { return 140; }
  /// What it adds to the arm's own limits.
  virtual TimeOptions Times() const { return {}; }
  /// What bounds its speed along short motions, for estimates.
  virtual PathDynamics Dynamics(const PostOptions& options) const;
  /// Bytes that all files of a program may take together; 0: no such bound.
  virtual size_t Memory() const { return 0; }

  /// Why it cannot be programmed in a cell, in one sentence; empty where it can. The names of its external
  /// axes are known to be those of the cell.
  virtual std::string WhyNotIn(const PostSettings&) const { return {}; }
  /// What the cell says of the controller and no program can check: one sentence each, for heads and reports.
  virtual std::vector<std::string> Assumptions(const PostSettings&) const { return {}; }
  /// What somebody does by hand before the first run in a cell, in that order: what it is about, and what to
  /// do.
  virtual std::vector<std::pair<std::string, std::string>> BeforeFirstRun(const PostSettings& settings) const;
  virtual FrameTexts Frames(const PostSettings& settings) const;
  /// Lines behind the change of tool that let nothing go on before the controller says that the right one is
  /// in the spindle; empty where it cannot tell.
  virtual std::string ToolCheck(const PostSettings&) const { return {}; }
  /// What stands before those lines in place of the text tool_change where the tool is in the spindle
  /// already.
  virtual std::string HeldTool() const { return {}; }

  /// How a main program calls others.
  virtual CallingSyntax Calling() const = 0;

  /// Precondition: every motion has its q, or is a joint motion with status and turn (as read).
  virtual ProgramFiles Write(const MotionProgram& program, const Arm& arm,
                             const PostSettings& settings) const = 0;
  /// Reads back what Write() writes. Throws InputError with file:line:column, all problems at once.
  virtual MotionProgram Read(const ProgramFiles& files, const Arm& arm,
                             const PostSettings& settings) const = 0;
  /// What the reader would refuse of the settings' texts wherever they stood, see
  /// ProgramReader::CheckTexts().
  virtual std::vector<Problem> CheckTexts(const Arm& arm, const PostSettings& settings) const = 0;
};

/// What to do about the cell's texts before a first run.
std::string TextsToTry(const PostSettings& settings);

/// The post registered under `name`, with default options; InputError with the nearest name when there is
/// none.
std::unique_ptr<Post> MakePost(const std::string& name);

}  // namespace millpose
