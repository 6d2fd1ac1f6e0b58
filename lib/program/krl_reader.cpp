// SPDX-License-Identifier: GPL-3.0-or-later
// Reads KRL as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/krl.hpp"
#include "program/reader.hpp"

namespace millpose {
namespace {

using Fields = std::map<std::string, double>;

constexpr const char* kDefaults = "BAS (#INITMOV,0 )";
constexpr const char* kPtpSpeed = "BAS (#VEL_PTP,…)";
constexpr double kDefaultFeed = 2000;                   // mm/s, $VEL.CP after BAS(#INITMOV,0)
constexpr double kExternalSlack = 1e-4;                 // mm or degrees
constexpr double kDefaultBlend = 3;                     // mm, $APO.CDIS after BAS(#INITMOV,0)
constexpr double kDefaultTurnSpeed = 200 * kRadPerDeg;  // rad/s, $VEL.ORI1 and 2 after BAS(#INITMOV,0)

class KrlReader : public ProgramReader {
 public:
  KrlReader(const ProgramFiles& files, const PostSettings& settings)
      : ProgramReader(files, settings, Templates(KrlTexts(), settings.texts, settings.tool_name)) {
    program_.blend_is_distance = true;
  }

 private:
  std::optional<std::string_view> Comment(std::string_view line) const override {
    return line.starts_with('&') ? std::optional(std::string_view()) : ProgramReader::Comment(line);
  }

  void BeginFile() override { defined_ = false; }

  std::vector<std::string> Needed() const override { return {kDefaults, kPtpSpeed}; }

  void ReadComment(std::string_view comment) override {
    LineScanner scan(comment, "", 0);
    const bool begin = scan.Accept("FOLD PASS");
    if (!begin && !scan.Accept("ENDFOLD (PASS")) return ProgramReader::ReadComment(comment);
    ReadPassMark(scan, begin);
  }

  void ReadCode(LineScanner& scan) override {
    if (!defined_) {
      ReadDefinition(scan);
    } else if (scan.Accept("PTP")) {
      ReadPtp(scan);
    } else if (scan.Accept("LIN")) {
      ReadLin(scan);
    } else if (scan.Accept("END")) {
      EndFile();
    } else if (!ReadSetting(scan)) {
      ReadSubprogram(scan);
    }
    scan.ExpectEnd();
  }

  void ReadDefinition(LineScanner& scan) {
    scan.Expect("DEF");
    const auto name = scan.AcceptName();
    if (!name || !SameWords(*name, FileStem()))
      scan.Fail(fmt::format("the file's name {} expected", FileStem()));
    if (!InSubprogram()) program_.name = *name;
    scan.Expect("(");
    scan.Expect(")");
    defined_ = true;
  }

  void ReadSubprogram(LineScanner& scan) {
    static const std::vector<std::string> statements = {
        "PTP",       "LIN",       "TRIGGER WHEN", "WAIT SEC",  "WAIT FOR",  "HALT", "$BASE",
        "$TOOL",     "$VEL.CP",   "$VEL.ORI1",    "$VEL.ORI2", "$ACC.CP",   "BAS",  "$ACC.ORI1",
        "$ACC.ORI2", "$APO.CDIS", "$ADVANCE",     "$ORI_TYPE", "INTERRUPT", "END"};
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (name && scan.Accept(":")) return;  // a label
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

  /// Statements that set something, or wait; false when it is another.
  bool ReadSetting(LineScanner& scan) {
    if (scan.Accept("$BASE")) {
      if (posed_) scan.Fail("one base for all poses of the program expected");
      program_.X_BP = ReadFrame(scan, "BASE_DATA", settings_.base_number);
      framed_ = true;
    } else if (scan.Accept("$TOOL")) {
      if (posed_) scan.Fail("one tool for all poses of the program expected");
      program_.X_FT = ReadFrame(scan, "TOOL_DATA", settings_.tool_number);
      if (program_.X_FT) program_.X_FT->linear() = program_.X_FT->linear() * settings_.R_TC.transpose();
      tooled_ = true;
    } else if (scan.Accept("$VEL.CP")) {
      feed_ = ReadPositive(scan) * 1000;
    } else if (scan.Accept("$APO.CDIS")) {
      scan.Expect("=");
      blend_ = scan.ExpectNumber();
    } else if (scan.Accept("$VEL.ORI1")) {
      turn_speed_[0] = ReadPositive(scan) * kRadPerDeg;
    } else if (scan.Accept("$VEL.ORI2")) {
      turn_speed_[1] = ReadPositive(scan) * kRadPerDeg;
    } else if (scan.Accept("$ACC.CP") || scan.Accept("$ACC.ORI1") || scan.Accept("$ACC.ORI2")) {
      ReadPositive(scan);
    } else if (scan.Accept("TRIGGER WHEN")) {
      ReadTrigger(scan);
    } else if (scan.Accept("$ADVANCE")) {
      scan.Expect("=");
      const size_t start = scan.Next();
      const double motions = scan.ExpectNumber();
      if (motions < 0 || motions > 5 || motions != std::round(motions))
        scan.FailFrom(start, "0 to 5 expected");
    } else if (scan.Accept("$ORI_TYPE")) {
      scan.Expect("=");
      scan.Expect("#VAR");
    } else if (scan.Accept("BAS")) {
      ReadBas(scan);
    } else if (scan.Accept("WAIT SEC")) {
      scan.ExpectNumber();
    } else if (scan.Accept("WAIT FOR")) {
      if (scan.Rest().empty()) scan.Fail("what to wait for expected");
    } else if (scan.Accept("GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM")) {
      scan.Expect("(");
      scan.Expect(")");
    } else {
      return scan.Accept("INTERRUPT ON 3") || scan.Accept("HALT");
    }
    return true;
  }

  static double ReadPositive(LineScanner& scan) {
    scan.Expect("=");
    const size_t start = scan.Next();
    const double value = scan.ExpectNumber();
    if (!(value > 0)) scan.FailFrom(start, "a number above 0 expected");
    return value;
  }

  /// DISTANCE=0 DELAY=0 DO $OUT[3]=TRUE: at the start of the next motion.
  void ReadTrigger(LineScanner& scan) {
    scan.Expect("DISTANCE");
    scan.Expect("=");
    const size_t start = scan.Next();
    if (scan.ExpectNumber() != 0) scan.FailFrom(start, "0 expected (switching where the next motion begins)");
    PathOutput output;
    scan.Expect("DELAY");
    scan.Expect("=");
    output.delay = scan.ExpectNumber() / 1000;
    scan.Expect("DO");
    scan.Expect("$OUT");
    scan.Expect("[");
    output.number = static_cast<int>(scan.ExpectNumber());
    scan.Expect("]");
    scan.Expect("=");
    output.on = scan.Accept("TRUE");
    if (!output.on) scan.Expect("FALSE");
    AddOutput(output);
  }

  void ReadBas(LineScanner& scan) {
    scan.Expect("(");
    const bool speed = scan.Accept("#VEL_PTP");
    if (!speed) scan.Expect("#INITMOV");
    scan.Expect(",");
    const size_t start = scan.Next();
    const double value = scan.ExpectNumber();
    Stated(speed ? kPtpSpeed : kDefaults);
    const double most = std::round(settings_.ptp_share * 100);
    if (speed && (value <= 0 || value > most))
      scan.FailFrom(start, fmt::format("1 to {} % expected (the cell's ptp_speed_percent)", most));
    scan.Expect(")");
  }

  /// {X 1,Y 2,…} or {FRAME: X 1,…}: the fields by name in upper case.
  Fields ReadFields(LineScanner& scan, const std::string& type, const std::vector<std::string>& allowed) {
    Fields fields;
    scan.Expect("{");
    if (scan.Accept(type)) scan.Expect(":");
    do {
      const std::string* field = nullptr;
      for (const std::string& name : allowed) {
        if (scan.Accept(name)) field = &name;
        if (field) break;
      }
      if (!field) scan.Fail(fmt::format("one of the fields {} expected", fmt::join(allowed, ", ")));
      if (fields.contains(*field)) scan.Fail(fmt::format("field {} is given twice", *field));
      fields[*field] = *field == "S" || *field == "T" ? ReadBits(scan) : scan.ExpectNumber();
    } while (scan.Accept(","));
    scan.Expect("}");
    return fields;
  }

  static int ReadBits(LineScanner& scan) {
    return scan.Peek() == '\'' ? scan.ExpectBits() : static_cast<int>(scan.ExpectNumber());
  }

  static Pose PoseOf(const Fields& fields) {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(fields.at("X"), fields.at("Y"), fields.at("Z"));
    pose.linear() =
        FromAnglesZyx(Eigen::Vector3d(fields.at("A"), fields.at("B"), fields.at("C")) * kRadPerDeg);
    return pose;
  }

  static void ExpectAll(LineScanner& scan, const Fields& fields, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      if (!fields.contains(name)) scan.Fail(fmt::format("field {} is missing", name));
    }
  }

  /// A frame's values, or, where the cell says so, the number of one that the controller holds: empty.
  std::optional<Pose> ReadFrame(LineScanner& scan, std::string_view list, int number) {
    scan.Expect("=");
    if (number > 0) {
      scan.Expect(fmt::format("{}[{}]", list, number));
      return std::nullopt;
    }
    const std::vector<std::string> names = {"X", "Y", "Z", "A", "B", "C"};
    const Fields fields = ReadFields(scan, "FRAME", names);
    ExpectAll(scan, fields, names);
    return PoseOf(fields);
  }

  /// The tool in the workpiece frame of a motion's fields; what it leaves out stays as the motion before had
  /// it.
  Pose Target(LineScanner& scan, Fields fields) {
    const bool first = !std::exchange(posed_, true);
    if (first && !framed_) scan.Fail("$BASE must be set before the first pose");
    if (first && !tooled_) scan.Fail("$TOOL must be set before the first pose");
    for (const std::string name : {"X", "Y", "Z", "A", "B", "C"}) {
      if (!fields.contains(name) && last_.contains(name)) fields[name] = last_[name];
    }
    ExpectAll(scan, fields, {"X", "Y", "Z", "A", "B", "C"});
    last_ = fields;
    Pose X_PT = PoseOf(fields);
    X_PT.linear() = X_PT.linear() * settings_.R_TC.transpose();
    return X_PT;
  }

  /// The fields that a target may have, and the external axes that it must have.
  Fields ReadTarget(LineScanner& scan, std::vector<std::string> allowed) {
    std::vector<std::string> external;
    for (size_t i = 0; i < settings_.external.size(); ++i) external.push_back(fmt::format("E{}", i + 1));
    allowed.insert(allowed.end(), external.begin(), external.end());
    Fields fields = ReadFields(scan, allowed.front() == "A1" ? "E6AXIS" : "E6POS", allowed);
    ExpectAll(scan, fields, external);
    for (size_t i = 0; i < external.size(); ++i) {
      if (std::abs(fields.at(external[i]) - settings_.external[i]) > kExternalSlack) {
        scan.Fail(fmt::format("{} stays at {} in this program; that value expected", external[i],
                              settings_.external[i]));
      }
    }
    return fields;
  }

  void ReadPtp(LineScanner& scan) {
    Motion& motion = AddMotion(MotionType::kJoint);
    const Fields fields =
        ReadTarget(scan, {"A1", "A2", "A3", "A4", "A5", "A6", "X", "Y", "Z", "A", "B", "C", "S", "T"});
    if (fields.contains("A1")) {
      ExpectAll(scan, fields, {"A1", "A2", "A3", "A4", "A5", "A6"});
      Joints angles;
      for (int i = 0; i < 6; ++i) angles[i] = fields.at(fmt::format("A{}", i + 1)) * kRadPerDeg;
      motion.q = FromController(settings_.axes, angles);
      last_.clear();
    } else {
      if (fields.contains("S")) motion.status = static_cast<int>(fields.at("S"));
      if (fields.contains("T")) motion.turn = static_cast<int>(fields.at("T"));
      motion.X_PT = Target(scan, fields);
    }
    motion.exact = !scan.Accept("C_PTP");
  }

  void ReadLin(LineScanner& scan) {
    Motion& motion = AddMotion(MotionType::kLinear);
    motion.X_PT = Target(scan, ReadTarget(scan, {"X", "Y", "Z", "A", "B", "C", "S", "T"}));
    motion.feed = feed_;
    motion.turn_speed = std::min(turn_speed_[0], turn_speed_[1]);
    motion.exact = !scan.Accept("C_DIS");
    motion.blend = motion.exact ? 0 : blend_;
  }

  Fields last_;  // of the last Cartesian motion
  double feed_ = kDefaultFeed;
  double blend_ = kDefaultBlend;
  std::array<double, 2> turn_speed_ = {kDefaultTurnSpeed, kDefaultTurnSpeed};
  bool defined_ = false;                  // DEF was read
  bool framed_ = false, tooled_ = false;  // $BASE and $TOOL are set
  bool posed_ = false;                    // a pose was approached
};

}  // namespace

MotionProgram KrlPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  return KrlReader(files, settings).Read({".src"});
}

}  // namespace millpose
