// SPDX-License-Identifier: GPL-3.0-or-later
// Who wrote a CAM path, and what its words mean then. Sources of the rules: docs/cam-import.md, "Senders".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

enum class CamSender : uint8_t {
  kPlain,  ///< nothing tells: what differs between senders is asked for
  kNx,
  kCatia,
  kCreo,
  kAutodesk,
  kSolidWorksCam,
  kMastercam,
  kLinuxCnc,
  kSinumerik,
  kHeidenhain,
};

/// What a GOTO of three numbers means behind one that leaned the tool.
enum class ThreeNumbers : uint8_t {
  kAsked,  ///< not known
  kKeep,   ///< the axis stays as it was
  kUp,     ///< the tool stands along +z of the system in force
};

/// What the place of a hole is under a cycle by places (CYCLE/DRILL,12,MMPM,120,5).
enum class CyclePoint : uint8_t {
  kTop,     ///< depth and clearance are counted from it
  kBottom,  ///< the hole's bottom; the clearance is a height of the file's system
};

/// What holds in the files of one sender.
struct SenderRules {
  CamSender sender = CamSender::kPlain;
  std::string_view key;   ///< of toolpath.cam.sender; empty: cannot be stated
  std::string_view name;  ///< for messages
  bool apt = false, gcode = false;
  ThreeNumbers three_numbers = ThreeNumbers::kAsked;
  bool cycle_point_asked = false;  ///< its cycles by places are written with either meaning
  bool turns_by_p = false;         ///< P in an arc counts the revolutions begun
  bool g58_shifts = false;         ///< G58 and G59 with coordinates shift the frame
  std::string_view offset = {};    ///< zero offset in force before one is named
};

const SenderRules& RulesOf(CamSender sender);
/// Those that can be stated as toolpath.cam.sender.
std::vector<CamSender> StatableSenders();
/// "nx, catia, creo, …": of APT CLDATA, or of G-code.
std::string SenderKeys(bool gcode);

/// Whose marks a file bears.
struct Recognised {
  CamSender sender = CamSender::kPlain;
  std::string conflict;  ///< "NX and Creo": marks of both, so neither
};

/// Looks for marks in the first 200,000 bytes: comments and words that one sender alone writes.
Recognised RecogniseSender(std::string_view bytes, bool gcode);

}  // namespace millpose
