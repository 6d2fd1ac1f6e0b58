// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl_settings.hpp"

#include "base/units.hpp"
#include "program/krl/krl.hpp"
#include "program/krl/krl_head.hpp"

namespace millpose {
namespace {

using krl::ReadPositive;

constexpr const char* kDefaults = "BAS (#INITMOV,0 )";
constexpr const char* kLoad = "$LOAD as in the cell";
constexpr double kLeastAcceleration = 0.1;  // of what the plan reckons with
constexpr double kSameSetting = 1e-6;       // relative: written with four decimals and more
constexpr double kSamePlace = 1e-9;         // of a frame stated again

}  // namespace

KrlSettings::KrlSettings(const ProgramFiles& files, const PostSettings& settings, const KrlOptions& options)
    : ProgramReader(files, settings,
                    Templates(KrlTexts(settings), settings.texts, ToolOf(settings), {.numbers = false})),
      options_(options),
      load_(KrlLoad(options, settings)) {
  program_.blend_is_distance = true;
  program_.swivel = settings.R_TC() * DirectionOf(options.tool_direction);
}

std::vector<std::string> KrlSettings::Needed() const {
  std::vector<std::string> needed = {kDefaults, "$ADVANCE"};
  if (!load_.empty()) needed.emplace_back(kLoad);
  return needed;
}

void KrlSettings::Forgotten() {
  Stated(kDefaults);
  last_.clear();
}

void KrlSettings::ReadBase(LineScanner& scan, size_t start) {
  const std::optional<Pose> value = ReadBaseValue(scan);
  std::optional<Pose> X_BP;
  if (value) X_BP = KrlBaseFrame(options_, settings_, {}, *value);
  const bool same = Same(X_BP, program_.X_BP);
  if (posed_ && !same && external_.empty())
    scan.FailFrom(start, "one base for all poses of the program expected");
  if (!same) last_.clear();
  base_ = value;
  program_.X_BP = X_BP;
  Stated("$BASE");
}

std::optional<Pose> KrlSettings::ReadBaseValue(LineScanner& scan) {
  if (!options_.external_base) return ReadFrame(scan, "BASE_DATA", options_.base_number);
  return krl::ReadTableBase(scan, options_.external_base->machine_def);
}

bool KrlSettings::ReadFrames(LineScanner& scan) {
  const size_t start = scan.Next();
  if (scan.Accept("$BASE")) {
    ReadBase(scan, start);
  } else if (scan.Accept("$TOOL")) {
    std::optional<Pose> X_FT = ReadFrame(scan, "TOOL_DATA", options_.tool_number);
    if (X_FT) X_FT->linear() = X_FT->linear() * settings_.R_TC().transpose();
    if (posed_ && !Same(X_FT, program_.X_FT))
      scan.FailFrom(start, "one tool for all poses of the program expected");
    program_.X_FT = X_FT;
    Stated("$TOOL");
  } else {
    return false;
  }
  Allow(scan, start, kAtStops);
  return true;
}

bool KrlSettings::Same(const std::optional<Pose>& a, const std::optional<Pose>& b) {
  return a.has_value() == b.has_value() && (!a || a->matrix().isApprox(b->matrix(), kSamePlace));
}

bool KrlSettings::ReadSetting(LineScanner& scan) {
  const size_t start = scan.Next();
  if (scan.Accept("$VEL.CP")) {  // a feed: anywhere
    Stated("$VEL.CP");
    feed_ = ReadPositive(scan) * 1000;
    return true;
  }
  if (scan.Accept("TRIGGER WHEN")) {
    AddOutput(krl::ReadTrigger(scan));
    return true;
  }
  if (scan.Accept("$APO.CDIS")) {  // of the next motions, as inline forms set it: anywhere
    Stated("$APO.CDIS");
    blend_ = ReadPositive(scan);
    return true;
  }
  Places places = kAtStops;
  if (scan.Accept("$IPO_MODE")) {  // without an external base the delivered state: the tool is on the flange
    scan.Expect("=");
    scan.Expect("#BASE");
    Stated(kFollowsBase);
    places = kOutsideCuts;
  } else if (scan.Accept("$VEL.ORI1")) {
    turn_speed_[0] = ReadPositive(scan) * kRadPerDeg;
    Stated("$VEL.ORI1");
  } else if (scan.Accept("$VEL.ORI2")) {
    turn_speed_[1] = ReadPositive(scan) * kRadPerDeg;
    Stated("$VEL.ORI2");
  } else if (scan.Accept("$ACC.CP")) {
    scan.Expect("=");
    ReadPathAcceleration(scan);
  } else if (scan.Accept("$ACC.ORI1") || scan.Accept("$ACC.ORI2")) {
    scan.Expect("=");
    ExpectAccelerationOf(scan, options_.orientation_acceleration, kRadPerDeg,
                         "orientation_acceleration_deg_s2");
  } else if (scan.Accept("$ADVANCE")) {
    ReadAdvance(scan);
    places = kOutsideCuts;
  } else if (scan.Accept("$ORI_TYPE")) {
    Stated("$ORI_TYPE");
    scan.Expect("=");
    scan.Expect("#VAR");
  } else if (scan.Accept("BAS")) {
    ReadBas(scan);
    places = kOutsideCuts;
  } else if (scan.Accept("$LOAD")) {
    ReadLoad(scan, start);
    places = kOutsideCuts;
  } else if (!ReadSlower(scan)) {
    return false;
  }
  Allow(scan, start, places);
  return true;
}

void KrlSettings::ExpectAccelerationOf(LineScanner& scan, const std::optional<double>& most, double unit,
                                       const char* key) {
  const size_t start = scan.Next();
  const double value = scan.ExpectNumber() * unit;
  if (!most) scan.FailFrom(start, fmt::format("no value expected: the cell gives no {}", key));
  if (value < kLeastAcceleration * *most || value > (1 + kSameSetting) * *most)
    scan.FailFrom(start, fmt::format("{} to {} expected (a tenth to all of the cell's {})",
                                     kLeastAcceleration * *most / unit, *most / unit, key));
}

void KrlSettings::ReadPathAcceleration(LineScanner& scan) {
  ExpectAccelerationOf(scan, settings_.path_acceleration.value_or(PathDynamics().acceleration), 1000,
                       "path_acceleration_m_s2, or what is taken without it");
}

void KrlSettings::ReadLoad(LineScanner& scan, size_t start) {
  LineScanner ahead = scan;
  if (ahead.Accept("=") && ahead.Accept("LOAD_DATA")) {
    scan = ahead;
    scan.Expect("[");
    const size_t number = scan.Next();
    const int given = krl::ReadWhole(scan, 1, 32);
    scan.Expect("]");
    if (!load_.empty()) scan.FailFrom(start, fmt::format("{} expected, as the cell gives it", load_));
    if (options_.tool_number > 0 && given != options_.tool_number)
      scan.FailFrom(number, fmt::format("{} expected, the cell's tool_number", options_.tool_number));
    return;
  }
  if (Spelled("$LOAD " + scan.Rest()) != Spelled(load_))
    scan.FailFrom(start, load_.empty() ? "LOAD_DATA[n] expected: the cell gives no values to be stated"
                                       : fmt::format("{} expected, as the cell gives it", load_));
  Stated(kLoad);
}

bool KrlSettings::ReadSlower(LineScanner& scan) {
  const auto percent = [&](int least, int most) {
    scan.Expect("=");
    krl::ReadWhole(scan, least, most);
  };
  const auto axis = [&] {
    scan.Expect("[");
    krl::ReadWhole(scan, 1, 12);
    scan.Expect("]");
  };
  if (scan.Accept("$OV_PRO")) {
    percent(1, 100);
  } else if (scan.Accept("$VEL_AXIS")) {
    axis();
    percent(1, options_.ptp_speed_percent);
  } else if (scan.Accept("$ACC_AXIS")) {
    axis();
    percent(1, 100);
  } else if (scan.Accept("$APO.CPTP") || scan.Accept("$APO.CVEL")) {
    percent(0, 100);
  } else if (scan.Accept("$APO.CORI")) {
    ReadPositive(scan);
  } else if (scan.Accept("$CIRC_TYPE")) {
    scan.Expect("=");
    if (!scan.Accept("#BASE")) scan.Expect("#PATH");
  } else if (scan.Accept("$BWDSTART")) {
    scan.Expect("=");
    krl::ReadTruth(scan);
  } else {
    return false;
  }
  return true;
}

void KrlSettings::ReadAdvance(LineScanner& scan) {
  Stated("$ADVANCE");
  scan.Expect("=");
  const size_t start = scan.Next();
  const double motions = scan.ExpectNumber();
  if (motions < 1 || motions > 5 || motions != std::round(motions))
    scan.FailFrom(start, "1 to 5 expected (with 0 the arm stops at every point)");
}

void KrlSettings::ReadBas(LineScanner& scan) {
  scan.Expect("(");
  if (scan.Accept("#BASE")) return ReadNumbered(scan, options_.base_number, "$BASE", program_.X_BP);
  if (scan.Accept("#TOOL")) return ReadNumbered(scan, options_.tool_number, "$TOOL", program_.X_FT);
  if (scan.Accept("#ACC_PTP")) {
    scan.Expect(",");
    krl::ReadWhole(scan, 1, 100);
    return scan.Expect(")");
  }
  if (scan.Accept("#VEL_CP")) {
    scan.Expect(",");
    feed_ = krl::ReadAboveZero(scan) * 1000;
    Stated("$VEL.CP");
    return scan.Expect(")");
  }
  if (scan.Accept("#ACC_CP")) {
    scan.Expect(",");
    ReadPathAcceleration(scan);
    return scan.Expect(")");
  }
  const bool speed = scan.Accept("#VEL_PTP");
  if (!speed) scan.Expect("#INITMOV");
  scan.Expect(",");
  const size_t start = scan.Next();
  const double value = scan.ExpectNumber();
  const int most = options_.ptp_speed_percent;
  if (!speed) Forget(kDefaults);
  Stated(speed ? kPtpSpeed : kDefaults);
  if (speed && (value < 1 || value > most))
    scan.FailFrom(start, fmt::format("1 to {} % expected (the cell's ptp_speed_percent)", most));
  if (!speed && value != 0) scan.FailFrom(start, "0 expected");
  scan.Expect(")");
}

void KrlSettings::ReadNumbered(LineScanner& scan, int number, const char* frame,
                               std::optional<Pose>& stated) {
  scan.Expect(",");
  const size_t start = scan.Next();
  if (number == 0) scan.FailFrom(start, "$BASE and $TOOL with values expected: the cell gives no number");
  if (scan.ExpectNumber() != number) scan.FailFrom(start, fmt::format("{} expected, as in the cell", number));
  scan.Expect(")");
  if (posed_ && stated) scan.FailFrom(start, fmt::format("one {} for all poses expected", frame));
  stated.reset();
  Stated(frame);
}

bool KrlSettings::ReadPause(LineScanner& scan) {
  const size_t start = scan.Next();
  Places places = kOutsideCuts;
  if (scan.Accept("WAIT SEC")) {
    const size_t number = scan.Next();
    const double seconds = scan.ExpectNumber();
    if (seconds < 0) scan.FailFrom(number, "0 or more seconds expected");
    ReadDwell(scan, start, seconds);
    return true;
  } else if (scan.Accept("WAIT FOR")) {
    krl::ReadCondition(scan);
    ReadHandEvent(scan, start, ProgramEvent::Kind::kWait, places);
    return true;
  } else if (scan.Accept("GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM")) {
    scan.Expect("(");
    scan.Expect(")");
    places = kHeadOnly;
  } else if (scan.Accept("INTERRUPT ON 3")) {
    places = kHeadOnly;
  } else if (scan.Accept("HALT")) {
    ReadHandEvent(scan, start, ProgramEvent::Kind::kStop, places);
    return true;
  } else {
    return false;
  }
  Allow(scan, start, places);
  return true;
}

std::optional<Pose> KrlSettings::ReadFrame(LineScanner& scan, std::string_view list, int number) {
  scan.Expect("=");
  if (number > 0) {
    scan.Expect(fmt::format("{}[{}]", list, number));
    return std::nullopt;
  }
  return krl::ReadFrame(scan);
}

}  // namespace millpose
