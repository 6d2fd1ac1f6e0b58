// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>

#include "base/registry.hpp"
#include "motion/corner.hpp"
#include "program/motion_program.hpp"
#include "program/program_time.hpp"
#include "program/programmed_line.hpp"

namespace millpose {

/// What hangs on the flange, as KRL's $LOAD counts it.
struct ToolLoad {
  double mass = 0;                                    ///< kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of gravity, in F, mm
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  ///< about it, along F's axes, kg·m²
};

/// What a controller's program needs to know beyond the motions; from the cell's `controllers:` section.
struct PostSettings {
  AxisConvention axes;                                 ///< controller angle = sign·A + offset
  Eigen::Matrix3d R_TC = Eigen::Matrix3d::Identity();  ///< controller's tool frame C in T, see ToolAxis()
  Pose X_FT = Pose::Identity();                        ///< tool in the flange, for programs that state none
  std::string tool_name;                               ///< T="…", printed in headers
  PathTolerance tolerance =
      WrittenTolerance({});                  ///< that the program keeps: a share of what verification allows
  double blend = 0.01;                       ///< mm: CTOL or G64 P
  double orientation_blend = 0.00017453293;  ///< rad (0.01°), sinumerik: tolerance of the orientation
  double ptp_share = 0.3;                    ///< krl: of the axes' largest speed, for motions between passes
  int advance = 5;                           ///< krl: $ADVANCE
  double orientation_speed = 3.490658504;    ///< krl: rad/s, $VEL.ORI1 and $VEL.ORI2
  std::optional<double> path_acceleration;   ///< krl: mm/s², $ACC.CP
  std::optional<double> orientation_acceleration;  ///< krl: rad/s², $ACC.ORI1 and $ACC.ORI2
  std::string rotation = "rpy";                    ///< sinumerik, linuxcnc: how A, B, C turn, rpy | euler
  bool cartesian = false;                          ///< linuxcnc: cuts as tool poses, not joints
  std::array<std::string, 6> axis_names = {"RA1", "RA2", "RA3", "RA4", "RA5", "RA6"};  ///< sinumerik
  int frame = 505;                          ///< sinumerik: G505…G599, which holds the workpiece
  std::optional<bool> ori_ipo_with_g_code;  ///< sinumerik: MD21104; how the tool turns, see SetTurning()
  std::optional<bool> ori_def_with_g_code;  ///< sinumerik: MD21102; whether ORIRPY and ORIEULER count
  int max_motions = 1400;                   ///< per file; larger programs call sub-programs; not linuxcnc
  size_t max_bytes = 500000;                ///< per file
  int base_number = 0, tool_number = 0;     ///< krl: BASE_DATA and TOOL_DATA to use; 0: the values
  std::vector<double> external;             ///< krl: constant E1, E2, … of every target, mm or degrees
  /// krl: the robot's base in $WORLD, as the cell says that the controller has it; on a coupled rail with the
  /// carriage where the program has it.
  Pose X_KB = Pose::Identity();
  std::optional<Pose> ersysroot;  ///< krl: $ERSYSROOT of a coupled rail; the program checks it, else $ROBROOT
  std::optional<ToolLoad> load;   ///< krl: written as $LOAD
  Eigen::Vector3d tool_direction = Eigen::Vector3d::UnitX();  ///< krl: $TOOL_DIRECTION, in C
  size_t memory = 0;                         ///< bytes that all files may take together; 0: no such bound
  std::optional<PathDynamics> dynamics;      ///< of the controller, for estimates; empty: not known
  std::map<std::string, std::string> texts;  ///< see Templates
  std::vector<DeclaredCall> calls;           ///< that texts may make
};

/// The controller's tool frame C in T when its axis `name` ("x", "y", "z", "-x", …) lies along T's z (from
/// tip to holder): the other axes follow by cyclic exchange, so "z" is the identity. InputError for other
/// names.
Eigen::Matrix3d ToolAxis(const std::string& name);

/// A key of a controller's section that must be given, and what is said where it is not.
struct NeededKey {
  std::string key, message;
};

/// The files of one program by name, e.g. {"cabin_panel.src", …}.
using ProgramFiles = std::map<std::string, std::string>;

/// Longest line (bytes) of a motion with what may stand before it: how many fit into a file for certain.
inline constexpr size_t kBytesPerMotion = 140;

/// Writes and reads one controller's programs, and says what the controller is like. One file and one line of
/// Posts() per controller.
class Post {
 public:
  virtual ~Post() = default;
  virtual std::string Name() const = 0;  ///< krl, sinumerik, linuxcnc: also the folder's name
  /// Of its files, that of main programs first: {".mpf", ".spf"}.
  virtual std::vector<std::string> Endings() const = 0;
  /// Keys of the cell's `controllers:` section that not every controller knows, but this one.
  virtual std::vector<std::string> Keys() const { return {}; }
  /// Those that must be given, with what is said where one is not.
  virtual std::vector<NeededKey> NeededKeys() const { return {}; }

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
  /// Whether its programs tell configurations by those of a spherical wrist.
  virtual bool NeedsSphericalWrist() const { return true; }
  /// Whether programs are read from a disk as they run: no file is too long, and entries are joint angles.
  virtual bool ReadsFromDisk() const { return false; }
  virtual double UsualCycle() const = 0;  ///< s, of interpolation as it is often set up
  /// What it adds to the arm's own limits.
  virtual TimeOptions Times(const PostSettings&) const { return {}; }

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

struct PostEntry {
  std::string name;
  std::function<std::unique_ptr<Post>()> make;
};

/// All controllers; programs that link the library may add theirs.
Registry<PostEntry>& Posts();

/// The post registered under `name`; InputError with the nearest name when there is none.
std::unique_ptr<Post> MakePost(const std::string& name);

}  // namespace millpose
