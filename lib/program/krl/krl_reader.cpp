// SPDX-License-Identifier: GPL-3.0-or-later
// Reads KRL as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/krl/krl.hpp"
#include "program/krl/krl_head.hpp"
#include "program/krl/krl_words.hpp"
#include "program/reader.hpp"

namespace millpose {
namespace {

using krl::ExpectAll;
using krl::Fields;
using krl::ReadPositive;

constexpr const char* kDefaults = "BAS (#INITMOV,0 )";
constexpr const char* kPtpSpeed = "BAS (#VEL_PTP,…)";
constexpr const char* kFollowsBase = "$IPO_MODE = #BASE";
constexpr const char* kLoad = "$LOAD as in the cell";
constexpr double kExternalSlack = 1e-4;     // mm or degrees
constexpr double kLeastAcceleration = 0.1;  // of what the plan reckons with
constexpr double kSameSetting = 1e-6;       // relative: written with four decimals and more
constexpr double kSamePlace = 1e-9;         // of a frame stated again

class KrlReader : public ProgramReader {
 public:
  KrlReader(const ProgramFiles& files, const PostSettings& settings, const KrlOptions& options)
      : ProgramReader(files, settings,
                      Templates(KrlTexts(settings), settings.texts, ToolOf(settings), {.numbers = false})),
        options_(options) {
    program_.blend_is_distance = true;
    program_.swivel = settings.R_TC() * DirectionOf(options.tool_direction);
  }

 private:
  /// The check of the controller's frame with its data: before every motion, as written.
  size_t ReadBlock(const std::vector<std::string_view>& lines, size_t first) override {
    if (!program_.motions.empty() || !defined_) return 0;
    if (const size_t taken = begun_ ? 0 : KrlLines(KrlDeclarations(), lines, first)) {
      declared_ = true;
      return taken;
    }
    if (const size_t taken = declared_ ? KrlLines(check_, lines, first) : 0) {
      program_.frames_checked = true;
      return taken;
    }
    if (const size_t taken = declared_ ? KrlLines(notice_, lines, first) : 0) {
      program_.notice = kCompensatedNotice;
      return taken;
    }
    return 0;
  }

  void BeginFile() override { defined_ = false; }

  std::vector<std::string> Needed() const override {
    std::vector<std::string> needed = {kDefaults, "$ADVANCE"};
    if (!load_.empty()) needed.emplace_back(kLoad);
    return needed;
  }

  /// Defaults count for nothing once each setting must be stated by itself.
  void Forgotten() override {
    Stated(kDefaults);
    last_.clear();
  }

  void ReadComment(std::string_view comment) override {
    LineScanner scan(comment, "", 0);
    const bool begin = scan.Accept("FOLD PASS");
    if (!begin && !scan.Accept("ENDFOLD (PASS")) return ProgramReader::ReadComment(comment);
    ReadPassMark(scan, begin);
  }

  void ReadCode(LineScanner& scan) override {
    begun_ = begun_ || defined_ || InText();
    if (!defined_ && !InText()) {
      ReadDefinition(scan);
    } else if (InText() && ReadTextWord(scan)) {
      return scan.ExpectEnd();
    } else if (scan.Accept("PTP")) {
      ReadPtp(scan);
    } else if (scan.Accept("LIN")) {
      ReadLin(scan);
    } else if (scan.Accept("END")) {
      EndFile();
    } else if (!ReadFrames(scan) && !ReadSetting(scan) && !ReadPause(scan)) {
      ReadSubprogram(scan);
    }
    scan.ExpectEnd();
  }

  /// Lines such as &ACCESS, from their first column on, stand before DEF alone.
  void ReadDefinition(LineScanner& scan) {
    if (scan.Peek() == '&') {
      if (scan.Next() != 0) scan.Fail("& in the first column expected");
      scan.Rest();
      return;
    }
    if (!scan.Accept("GLOBAL DEF")) scan.Expect("DEF");
    const auto name = scan.AcceptName();
    if (!name || !SameWords(*name, FileStem()))
      scan.Fail(fmt::format("the file's name {} expected", FileStem()));
    if (!InSubprogram()) program_.name = *name;
    scan.Expect("(");
    scan.Expect(")");
    defined_ = true;
  }

  bool ReadTextWord(LineScanner& scan) override { return krl::ReadOutput(scan); }

  void ReadSubprogram(LineScanner& scan) {
    static const std::vector<std::string> statements = {
        "PTP",   "LIN",       "TRIGGER WHEN", "WAIT SEC",   "WAIT FOR",  "HALT",
        "$BASE", "$TOOL",     "$VEL.CP",      "$VEL.ORI1",  "$VEL.ORI2", "$ACC.CP",
        "BAS",   "$ACC.ORI1", "$ACC.ORI2",    "$APO.CDIS",  "$ADVANCE",  "$ORI_TYPE",
        "$LOAD", "$OV_PRO",   "$IPO_MODE",    "$CIRC_TYPE", "INTERRUPT", "END"};
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (name && scan.Accept(":")) return AddLabel(scan, start, *name);
    if (name && IsDeclared(*name)) {
      scan.Expect("(");
      const std::string arguments = ReadArguments(scan);
      ReadDeclaredCall(scan, start, *name, arguments);
      return;
    }
    if (name && scan.Accept("(") && scan.Accept(")") && ReadCall(scan, *name)) {
      defined_ = true;
      return;
    }
    const std::string word =
        name.value_or("") + (scan.Accept(".") ? "." + scan.AcceptName().value_or("") : "");
    const std::string nearest = NearestName(word, statements);
    scan.FailFrom(start, fmt::format("{}, a label or the call of a file of the program expected (spindle and "
                                     "outputs: the cell's texts, TRIGGER){}",
                                     fmt::join(statements, ", "),
                                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }

  /// $BASE: one for all poses, as long as no external axes are planned: then each station may have its own.
  void ReadBase(LineScanner& scan, size_t start) {
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

  /// On a coupled table the statement with which $BASE turns with it; else a frame.
  std::optional<Pose> ReadBaseValue(LineScanner& scan) {
    if (!options_.external_base) return ReadFrame(scan, "BASE_DATA", options_.base_number);
    return krl::ReadTableBase(scan, options_.external_base->machine_def);
  }

  /// $BASE and $TOOL: one of each for all poses; stated again, they say the same.
  bool ReadFrames(LineScanner& scan) {
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

  static bool Same(const std::optional<Pose>& a, const std::optional<Pose>& b) {
    return a.has_value() == b.has_value() && (!a || a->matrix().isApprox(b->matrix(), kSamePlace));
  }

  /// Speeds, rounding, look-ahead: each is replayed, or must be what the cell says.
  bool ReadSetting(LineScanner& scan) {
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
    if (scan.Accept(
            "$IPO_MODE")) {  // without an external base the delivered state: the tool is on the flange
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

  /// An acceleration changes when the arm is where, not its path: more than the plan reckons with is
  /// nobody's, and with far less the feed is never reached.
  static void ExpectAccelerationOf(LineScanner& scan, const std::optional<double>& most, double unit,
                                   const char* key) {
    const size_t start = scan.Next();
    const double value = scan.ExpectNumber() * unit;
    if (!most) scan.FailFrom(start, fmt::format("no value expected: the cell gives no {}", key));
    if (value < kLeastAcceleration * *most || value > (1 + kSameSetting) * *most)
      scan.FailFrom(start, fmt::format("{} to {} expected (a tenth to all of the cell's {})",
                                       kLeastAcceleration * *most / unit, *most / unit, key));
  }

  void ReadPathAcceleration(LineScanner& scan) {
    ExpectAccelerationOf(scan, settings_.path_acceleration.value_or(PathDynamics().acceleration), 1000,
                         "path_acceleration_m_s2, or what is taken without it");
  }

  /// The cell's values, or, where programs need not state them, the controller's own load data of a number.
  void ReadLoad(LineScanner& scan, size_t start) {
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

  /// Usual settings that make no motion faster and lead none elsewhere: the override, which the operator has
  /// on the panel too; axes' speeds and accelerations of PTP; how circles turn the tool, of which there are
  /// none; when ways round their corners, which is taken as up to half of them whatever stands here; whether
  /// a start may go backwards.
  bool ReadSlower(LineScanner& scan) {
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

  /// With 0 nothing is computed ahead and every motion stops.
  void ReadAdvance(LineScanner& scan) {
    Stated("$ADVANCE");
    scan.Expect("=");
    const size_t start = scan.Next();
    const double motions = scan.ExpectNumber();
    if (motions < 1 || motions > 5 || motions != std::round(motions))
      scan.FailFrom(start, "1 to 5 expected (with 0 the arm stops at every point)");
  }

  /// #INITMOV resets what the controller's own bas.src has: from here on nothing is known.
  void ReadBas(LineScanner& scan) {
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

  /// What follows BAS (#BASE or BAS (#TOOL: the number that the cell says. The frame is then the
  /// controller's.
  void ReadNumbered(LineScanner& scan, int number, const char* frame, std::optional<Pose>& stated) {
    scan.Expect(",");
    const size_t start = scan.Next();
    if (number == 0) scan.FailFrom(start, "$BASE and $TOOL with values expected: the cell gives no number");
    if (scan.ExpectNumber() != number)
      scan.FailFrom(start, fmt::format("{} expected, as in the cell", number));
    scan.Expect(")");
    if (posed_ && stated) scan.FailFrom(start, fmt::format("one {} for all poses expected", frame));
    stated.reset();
    Stated(frame);
  }

  /// What stops the program for a while, and what handles its stops.
  bool ReadPause(LineScanner& scan) {
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

  /// A frame's values, or, where the cell says so, the number of one that the controller holds: empty.
  static std::optional<Pose> ReadFrame(LineScanner& scan, std::string_view list, int number) {
    scan.Expect("=");
    if (number > 0) {
      scan.Expect(fmt::format("{}[{}]", list, number));
      return std::nullopt;
    }
    return krl::ReadFrame(scan);
  }

  /// The tool in the workpiece frame of a motion's fields; what it leaves out stays as the motion before had
  /// it.
  Pose Target(LineScanner& scan, Fields fields) {
    posed_ = true;
    Require("$BASE");
    if (options_.external_base) Require(kFollowsBase);
    Require("$TOOL");
    for (const std::string name : {"X", "Y", "Z", "A", "B", "C"}) {
      if (!fields.contains(name) && last_.contains(name)) fields[name] = last_[name];
    }
    last_ = fields;
    for (const std::string name : {"X", "Y", "Z", "A", "B", "C"}) last_.try_emplace(name, 0);  // told once
    ExpectAll(scan, fields, {"X", "Y", "Z", "A", "B", "C"});
    Pose X_PT = krl::PoseOf(fields);
    X_PT.linear() = X_PT.linear() * settings_.R_TC().transpose();
    return X_PT;
  }

  /// The fields that a target may have, and the external axes that it must have; `motion` ends where they
  /// say.
  Fields ReadTarget(LineScanner& scan, std::vector<std::string> allowed, Motion& motion) {
    std::vector<std::string> external;
    for (const ControllerAxis& axis : settings_.controller_axes) external.push_back(axis.name);
    allowed.insert(allowed.end(), external.begin(), external.end());
    std::vector<std::string> types = {"E6POS", "POS", "FRAME"};
    if (allowed.front() == "A1") types.insert(types.end(), {"E6AXIS", "AXIS"});
    Fields fields = krl::ReadFields(scan, types, allowed);
    ExpectAll(scan, fields, external);
    for (const ControllerAxis& axis : settings_.controller_axes) {
      const double value = fields.at(axis.name);
      if (axis.axis.empty() && std::abs(value - axis.constant) > kExternalSlack)
        scan.Fail(
            fmt::format("{} stays at {} in this program; that value expected", axis.name, axis.constant));
      SetValue(settings_, axis, value, external_);
    }
    motion.external = external_;
    if (base_ && !external_.empty()) motion.X_BP = KrlBaseFrame(options_, settings_, external_, *base_);
    return fields;
  }

  void ReadPtp(LineScanner& scan) {
    Motion& motion = AddMotion(MotionType::kJoint);
    Require(kPtpSpeed);
    const std::vector<std::string> axes = {"A1", "A2", "A3", "A4", "A5", "A6"};
    const std::vector<std::string> place = {"X", "Y", "Z", "A", "B", "C", "S", "T"};
    std::vector<std::string> both = axes;
    both.insert(both.end(), place.begin(), place.end());
    const Fields fields = ReadTarget(scan, both, motion);
    const auto given = [&](const std::string& name) { return fields.contains(name); };
    if (std::any_of(axes.begin(), axes.end(), given)) {
      ExpectAll(scan, fields, axes);
      if (std::any_of(place.begin(), place.end(), given)) scan.Fail("axes or a pose expected, not both");
      Joints angles;
      for (int i = 0; i < 6; ++i) angles[i] = fields.at(fmt::format("A{}", i + 1)) * kRadPerDeg;
      motion.q = settings_.axes.ToArm(angles);
      last_.clear();
    } else {
      if (fields.contains("S")) motion.status = static_cast<int>(fields.at("S"));
      if (fields.contains("T")) motion.turn = static_cast<int>(fields.at("T"));
      motion.X_PT = Target(scan, fields);
    }
    motion.exact = !scan.Accept("C_PTP");
  }

  /// External axes that move along: the controller counts in them, so that $BASE holds all the way.
  void CoordinatedMotion(const LineScanner& scan, const ExternalPosition& before, Motion& motion) const {
    if (motion.external == before || !base_) return;
    if (const std::string name = UncoupledMove(settings_, before, motion.external); !name.empty())
      scan.Fail(
          fmt::format("{} moves in a LIN; the controller does not count in it (coupled: false in the "
                      "cell), so that it must stand still",
                      name));
    motion.X_BP_begin = KrlBaseFrame(options_, settings_, before, *base_);
  }

  void ReadLin(LineScanner& scan) {
    const ExternalPosition before = external_;
    Motion& motion = AddMotion(MotionType::kLinear);
    for (const char* setting : {"$VEL.CP", "$VEL.ORI1", "$VEL.ORI2", "$ORI_TYPE"}) Require(setting);
    motion.X_PT = Target(scan, ReadTarget(scan, {"X", "Y", "Z", "A", "B", "C", "S", "T"}, motion));
    CoordinatedMotion(scan, before, motion);
    motion.feed = feed_;
    motion.turn_speed = std::min(turn_speed_[0], turn_speed_[1]);
    motion.exact = !scan.Accept("C_DIS");
    if (motion.exact) return;
    Require("$APO.CDIS");
    motion.blend = blend_;
  }

  const KrlOptions& options_;
  std::optional<Pose> base_;                // what $BASE was given last
  Fields last_;                             // of the last Cartesian motion
  double feed_ = 0;                         // mm/s
  double blend_ = 0;                        // mm
  std::array<double, 2> turn_speed_{0, 0};  // rad/s
  bool defined_ = false;                    // DEF was read
  bool posed_ = false;                      // a pose was approached
  bool begun_ = false;                      // a statement was read: no declaration may follow
  bool declared_ = false;                   // the data of the frame check were read
  const std::string check_ = KrlFrameCheck(options_), load_ = KrlLoad(options_, settings_);
  const std::string notice_ = KrlNotice(kCompensatedNotice);
};

}  // namespace

std::vector<Problem> KrlPost::CheckTexts(const Arm&, const PostSettings& settings) const {
  return KrlReader({}, settings, options_).CheckTexts();
}

MotionProgram KrlPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  return KrlReader(files, settings, options_).Read({".src"});
}

}  // namespace millpose
