// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "toolpath/cam/cam_source.hpp"
#include "toolpath/cam/rotary_axes.hpp"
#include "toolpath/cam/sender.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// A point of a tool path from CAM: where the tip goes on a straight line from the point before. mm, mm/s.
struct CamPoint {
  Eigen::Vector3d position;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit vector from tip to holder
  double feed_rate = 0;                             ///< 0: none was given
  bool rapid = false;                               ///< moved to without cutting
  bool fresh = false;                               ///< a new tool or operation begins: the way here is none
  int line = 0;                                     ///< of the file
  size_t section = 0;                               ///< index into CamSource::sections
};

/// A cutter that the file names. mm.
struct CamCutter {
  double diameter = 0, corner_radius = 0;
  int line = 0;  ///< of the file
};

/// A hole of a cycle that is no plain motion (tapping, an oriented spindle): it is left out.
struct CamHole {
  Eigen::Vector3d position;  ///< as the file names it, in the part's system, mm
  std::string cycle;         ///< "G84", "CYCLE/TAP"
  std::string why;           ///< why it is no plain motion
  int line = 0;              ///< of the file
  size_t section = 0;        ///< index into CamSource::sections
};

struct CamPath {
  std::vector<CamPoint> points;
  std::vector<CamCutter> cutters;  ///< in the file's order
  std::vector<CamHole> holes_left_out;
  std::vector<std::string> notes;  ///< what was taken over, skipped or converted, one sentence each
  CamSource source;
  std::set<std::string>
      keys_used;  ///< of unit, frame, cycle_point and offsets_mm: those that decided anything
};

/// What decides which way round an APT circle with an axis goes.
enum class CircleSense : uint8_t {
  kBoth,     ///< the tangent of the motion before and the sign of the axis, which must not contradict
  kTangent,  ///< the tangent where it tells, else the sign
  kAxis,     ///< the sign alone
};

/// What places the points of a CAM path in the workpiece frame.
enum class CamFrame : uint8_t {
  kStated,   ///< frames that comments state as well (CATIA0, CSYS), with their columns as axes
  kAsGiven,  ///< nothing but MSYS and the frames of G-code: points stand as they are written
};

/// How a CAM path is read. What is not set follows from the file, or is asked for.
struct CamReadOptions {
  double chord_tolerance =
      0.01;                ///< mm: how far arcs and the ways under turning rotary axes may bend from chords
  RotaryAxes rotary_axes;  ///< of the machine that a G-code program was written for
  CircleSense circle = CircleSense::kBoth;
  std::optional<bool> tip_programming;   ///< whether a G-code program begins with the tip's coordinates
  std::map<int, bool> kinematics_codes;  ///< M codes that switch: from then on X, Y, Z are the tip's, or not
  std::optional<CamSender> sender;
  std::optional<double> unit;  ///< mm, where the file states none
  std::optional<CamFrame> frame;
  std::optional<CyclePoint> cycle_point;
  /// Where the zero of each zero offset ("G54", "G54.1 P2", "G505") lies in the workpiece frame, mm; axes are
  /// parallel. Empty: not stated.
  std::map<std::string, Eigen::Vector3d> offsets;
};

/// Reads a CAM tool path: APT CLDATA (CATIA, NX and others), G-code (ISO, SINUMERIK 840D, Heidenhain DIN/ISO)
/// or CSV, told from the content. Every word is evaluated, known to say nothing about the motion (then it is
/// counted in the notes), or refused: throws InputError with line and column, all unknown words at once.
CamPath ReadCamPath(std::string_view bytes, const std::string& name, const CamReadOptions& options);

/// Whether bytes are more likely a CAM path than a mesh: text with a CSV's header, blocks of G-code or
/// GOTO of CLDATA.
bool LooksLikeCamPath(std::string_view bytes);

/// The cuts and holes of one section with the ways to them. Precondition: it is below their number.
CamPath TakeSection(const CamPath& path, size_t section);

/// Refuses points beyond ±1e9 mm (a wrong unit, or nonsense that would become endless ways). Every reader
/// calls it with what it read. Throws InputError with the line.
void CheckReach(const CamPath& path, const std::string& name);

/// The formats one by one.
CamPath ReadApt(std::string_view bytes, const std::string& name, const CamReadOptions& options);
CamPath ReadCamCsv(std::string_view bytes, const std::string& name);
CamPath ReadGcode(std::string_view bytes, const std::string& name, const CamReadOptions& options);

}  // namespace millpose
