// SPDX-License-Identifier: GPL-3.0-or-later
// What KRL programs set: frames, speeds, rounding, loads, pauses. Each is replayed, or must be what the cell
// says.
#pragma once

#include <array>
#include <map>
#include <optional>

#include "program/krl/krl_options.hpp"
#include "program/krl/krl_words.hpp"
#include "program/reader.hpp"

namespace millpose {

/// Reads the settings of a KRL program and keeps what holds at the present statement. Its Read…() functions
/// return false where another statement comes next; what is wrong they tell by the scanner's Fail().
class KrlSettings : public ProgramReader {
 protected:
  KrlSettings(const ProgramFiles& files, const PostSettings& settings, const KrlOptions& options);

  std::vector<std::string> Needed() const override;
  /// Defaults count for nothing once each setting must be stated by itself.
  void Forgotten() override;

  /// $BASE and $TOOL: one of each for all poses; stated again, they say the same.
  bool ReadFrames(LineScanner& scan);
  /// Speeds, rounding, look-ahead: each is replayed, or must be what the cell says.
  bool ReadSetting(LineScanner& scan);
  /// What stops the program for a while, and what handles its stops.
  bool ReadPause(LineScanner& scan);

  static constexpr const char* kPtpSpeed = "BAS (#VEL_PTP,…)";
  static constexpr const char* kFollowsBase = "$IPO_MODE = #BASE";

  const KrlOptions& options_;
  std::optional<Pose> base_;                // what $BASE was given last
  krl::Fields last_;                        // of the last Cartesian motion
  double feed_ = 0;                         // mm/s
  double blend_ = 0;                        // mm
  std::array<double, 2> turn_speed_{0, 0};  // rad/s
  bool posed_ = false;                      // a pose was approached

 private:
  /// $BASE: one for all poses, as long as no external axes are planned: then each station may have its own.
  void ReadBase(LineScanner& scan, size_t start);
  /// On a coupled table the statement with which $BASE turns with it; else a frame.
  std::optional<Pose> ReadBaseValue(LineScanner& scan);
  static bool Same(const std::optional<Pose>& a, const std::optional<Pose>& b);
  /// An acceleration changes when the arm is where, not its path: more than the plan reckons with is
  /// nobody's, and with far less the feed is never reached.
  static void ExpectAccelerationOf(LineScanner& scan, const std::optional<double>& most, double unit,
                                   const char* key);
  void ReadPathAcceleration(LineScanner& scan);
  /// The cell's values, or, where programs need not state them, the controller's own load data of a number.
  void ReadLoad(LineScanner& scan, size_t start);
  /// Usual settings that make no motion faster and lead none elsewhere: the override, which the operator has
  /// on the panel too; axes' speeds and accelerations of PTP; how circles turn the tool, of which there are
  /// none; when ways round their corners, which is taken as up to half of them whatever stands here; whether
  /// a start may go backwards.
  bool ReadSlower(LineScanner& scan);
  /// With 0 nothing is computed ahead and every motion stops.
  void ReadAdvance(LineScanner& scan);
  /// #INITMOV resets what the controller's own bas.src has: from here on nothing is known.
  void ReadBas(LineScanner& scan);
  /// What follows BAS (#BASE or BAS (#TOOL: the number that the cell says. The frame is then the
  /// controller's.
  void ReadNumbered(LineScanner& scan, int number, const char* frame, std::optional<Pose>& stated);
  /// A frame's values, or, where the cell says so, the number of one that the controller holds: empty.
  static std::optional<Pose> ReadFrame(LineScanner& scan, std::string_view list, int number);

  const std::string load_;  // the cell's; empty: programs need not state it
};

}  // namespace millpose
