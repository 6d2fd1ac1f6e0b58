// SPDX-License-Identifier: GPL-3.0-or-later
// What a program makes the machine do, as an interpreter of the campaign says: apart from lib/program, so
// that one misunderstanding of a manual does not hide another.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "machine/robot/kinematics.hpp"

namespace millpose::campaign {

using Files = std::map<std::string, std::string>;

/// The machine that runs a program. The controller counts the arm's own angles.
struct Machine {
  Arm arm;
  Pose X_FT = Pose::Identity();                        ///< the real tool
  Eigen::Matrix3d R_TC = Eigen::Matrix3d::Identity();  ///< the controller's tool frame
  std::string rotation = "rpy";                        ///< how A, B, C turn (SINUMERIK, LinuxCNC)
  bool cartesian = false;                              ///< LinuxCNC with tool poses in cuts
  std::string tool_name;
  Pose robroot = Pose::Identity();         ///< KUKA's $ROBROOT, or $ERSYSROOT on a coupled rail
  std::vector<std::string> external = {};  ///< axes beside the arm's, as texts name them
  bool coupled = false;                  ///< KUKA: E1 is a rail along y of robroot, E2 turns about z of root
  Pose carriage = Pose::Identity();      ///< the robot on that rail
  Pose root = Pose::Identity();          ///< MACHINE_DEF[2].ROOT
  Pose flange = Pose::Identity();        ///< what turns, in it
  int base_number = 0, tool_number = 0;  ///< of the frames that the controller holds; 0: none
  Pose X_BP = Pose::Identity();          ///< the base of that number
  std::string unit = {};                 ///< RAPID: mechanical unit of root, in upper case
  std::set<std::string> plant = {};      ///< names of the plant's programs that texts call
};

/// One thing that the machine does.
struct Step {
  enum class Kind { kWay, kCut, kSwitch, kStop } kind = Kind::kWay;
  Joints q = Joints::Zero();               ///< where a motion ends, rad
  Pose X_BT = Pose::Identity();            ///< the real tip there
  bool straight = false;                   ///< the tip on a line, else the joints together
  std::optional<Eigen::Vector3d> angles;   ///< rad, of a straight motion whose three angles run evenly
  double feed = 0;                         ///< of cuts, mm/min along the tip's way; 0: see seconds
  double seconds = 0;                      ///< of cuts in inverse time, or that only turn
  double turn_speed = 0;                   ///< rad/s, of straight cuts; 0: none
  double way_speed = 1;                    ///< share, of ways
  bool exact = true;                       ///< stops at its end
  double blend = 0;                        ///< where it does not: mm from the corner (KRL), or from the path
  bool from_corner = false;                ///< which of the two
  double angle_blend = 0;                  ///< bound of the orientation, rad; 0: none
  std::optional<Joints> programmed;        ///< six words as given, where a text gives six (LinuxCNC)
  std::map<std::string, double> external;  ///< where the axes beside the arm's stand, mm or deg
  std::string words;                       ///< all else that counts: what is switched, modes
  std::string aside;                       ///< what holds too and is not modelled: a change of it is no harm
  int line = 0;
};

struct Trace {
  std::string refused;  ///< why the control would not run it; empty: it does
  std::string open;     ///< what the manual does not say of it; empty: nothing
  int guards = 0;       ///< at how many other frames of the controller it stands still
  std::vector<Step> steps;
};

/// What becomes of a program when a text is changed.
enum class Effect { kSame, kBorder, kChanged, kRefused };
struct Judgement {
  Effect effect = Effect::kSame;
  std::string why;
};

/// Compares what two programs do. kSame is far within the tolerances of verification, kChanged clearly
/// outside; between them and where a manual leaves it open stands kBorder.
Judgement Judge(const Trace& original, const Trace& mutant, const Machine& machine);

Trace RunKrl(const Files& files, const Machine& machine);
Trace RunSinumerik(const Files& files, const Machine& machine);
Trace RunLinuxCnc(const Files& files, const Machine& machine);
Trace RunUrScript(const Files& files, const Machine& machine);
Trace RunFanuc(const Files& files, const Machine& machine);
Trace RunRapid(const Files& files, const Machine& machine);

}  // namespace millpose::campaign
