// SPDX-License-Identifier: GPL-3.0-or-later
// Reads URScript as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/reader.hpp"
#include "program/urscript/urscript.hpp"
#include "program/urscript/urscript_words.hpp"

namespace millpose {
namespace {

using urscript::ReadNamed;
using urscript::ReadPose;
using urscript::Word;

using Numbers = std::map<std::string, double>;

constexpr const char* kTcp = "set_tcp";
constexpr const char* kPayload = "set_payload";
constexpr double kLeastAcceleration = 0.1;  // of what the plan reckons with
constexpr double kLastDigit = 0.5e-4;       // of accelerations and speeds, by rounding
constexpr double kSameLoad = 1e-6;          // kg, m
constexpr double kSamePlace = 1e-9;         // of a frame stated again

class UrScriptReader : public ProgramReader {
 public:
  UrScriptReader(const ProgramFiles& files, const Arm& arm, const PostSettings& settings,
                 const UrScriptOptions& options)
      : ProgramReader(
            files, settings,
            Templates(UrScriptTexts(settings), settings.texts, ToolOf(settings), {.numbers = false})),
        arm_(arm),
        options_(options) {
    program_.R_TC = settings.R_TC();
    program_.X_BP = Pose::Identity();  // poses are stated in the robot's base
    program_.blend_is_distance = true;
    program_.corner_assumption = kUrScriptCorner;
  }

 private:
  std::optional<std::string_view> Comment(std::string_view line) const override {
    return line.starts_with('#') ? std::optional(line.substr(1)) : std::nullopt;
  }

  /// '#' begins a comment where it does not stand in a text.
  std::string_view WithoutComment(std::string_view line) const override {
    bool inside = false;
    for (size_t i = 0; i < line.size(); ++i) {
      if (line[i] == '#' && !inside) return line.substr(0, i);
      if (line[i] == '"') inside = !inside;
    }
    return line;
  }

  void BeginFile() override {
    defined_ = false;
    loops_ = 0;
  }
  std::vector<std::string> Needed() const override { return {kTcp, kPayload}; }

  void ReadCode(LineScanner& scan) override {
    if (InText()) {
      if (!ReadTextWord(scan)) ReadOther(scan);
      return scan.ExpectEnd();
    }
    if (loops_ > 0) scan.Fail("the end of a while that a text of the cell has begun expected");
    if (!defined_) return ReadDefinition(scan);
    const size_t start = scan.Next();
    if (Word(scan, "movej")) {
      ReadJoints(scan);
    } else if (Word(scan, "movep")) {
      ReadLine(scan, false);
    } else if (Word(scan, "movel")) {
      ReadLine(scan, true);
    } else if (Word(scan, "end")) {
      ExpectNoBlend(scan, start);
      EndFile();
    } else if (!ReadSetting(scan, start) && !ReadPause(scan, start)) {
      ReadOther(scan);
    }
    scan.ExpectEnd();
  }

  void ReadDefinition(LineScanner& scan) {
    if (!Word(scan, "def")) scan.Fail("def expected");
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (!name || *name != FileStem())
      scan.FailFrom(start, fmt::format("the file's name {} expected", FileStem()));
    for (const char* sign : {"(", ")", ":"}) scan.Expect(sign);
    scan.ExpectEnd();
    program_.name = *name;
    defined_ = true;
  }

  bool ReadTextWord(LineScanner& scan) override {
    if (urscript::ReadTextStatement(scan, loops_)) return true;
    if (!Word(scan, "sleep")) return false;
    ReadSeconds(scan);
    return true;
  }

  static double ReadSeconds(LineScanner& scan) {
    scan.Expect("(");
    const size_t number = scan.Next();
    const double seconds = urscript::ReadNumber(scan);
    if (seconds < 0) scan.FailFrom(number, "0 or more seconds expected");
    scan.Expect(")");
    return seconds;
  }

  /// The call of a program of the plant.
  void ReadOther(LineScanner& scan) {
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    const bool declared = name && std::ranges::find(settings_.calls, *name, &DeclaredCall::name) !=
                                      settings_.calls.end();  // capitals count
    if (declared) {
      scan.Expect("(");
      const std::string arguments = ReadArguments(scan);
      ReadDeclaredCall(scan, start, *name, arguments);
      return;
    }
    static const std::vector<std::string> statements = {"movej",   "movep",       "movel",
                                                        "set_tcp", "set_payload", "set_standard_digital_out",
                                                        "sleep",   "popup",       "textmsg"};
    scan.FailFrom(start, fmt::format("{} or end expected (spindle and other outputs: the cell's texts)",
                                     fmt::join(statements, ", ")));
  }

  /// One tool and one load for all poses; stated again, they say the same.
  bool ReadSetting(LineScanner& scan, size_t start) {
    if (Word(scan, kTcp)) {
      scan.Expect("(");
      Pose X_FT = ReadPose(scan);
      scan.Expect(")");
      X_FT.linear() = X_FT.linear() * settings_.R_TC().transpose();
      if (posed_ && !X_FT.matrix().isApprox(program_.X_FT->matrix(), kSamePlace))
        scan.FailFrom(start, "one tool for all poses of the program expected");
      program_.X_FT = X_FT;
      Stated(kTcp);
    } else if (Word(scan, kPayload)) {
      ReadPayload(scan, start);
      Stated(kPayload);
    } else {
      return false;
    }
    Allow(scan, start, kOutsideCuts);
    return true;
  }

  void ReadPayload(LineScanner& scan, size_t start) {
    scan.Expect("(");
    const double mass = urscript::ReadNumber(scan);
    scan.Expect(",");
    const std::vector<double> centre = urscript::ReadList(scan, 3);
    scan.Expect(")");
    const Eigen::Vector3d off =
        Eigen::Vector3d(centre[0], centre[1], centre[2]) - settings_.load->centre / 1000;
    if (std::abs(mass - settings_.load->mass) > kSameLoad || off.cwiseAbs().maxCoeff() > kSameLoad)
      scan.FailFrom(start,
                    fmt::format("{} expected, as the cell's tool.load has it", UrScriptPayload(settings_)));
  }

  /// What is switched, said and waited for where the arm stands still.
  bool ReadPause(LineScanner& scan, size_t start) {
    if (Word(scan, "set_standard_digital_out")) {
      scan.Expect("(");
      const int number = urscript::ReadWhole(scan, 0, kUrScriptOutputs - 1);
      scan.Expect(",");
      const bool on = urscript::ReadTruth(scan);
      scan.Expect(")");
      Allow(scan, start, kAtStops);
      AddOutput({number, on, 0, true});
    } else if (Word(scan, "sleep")) {
      ReadDwell(scan, start, ReadSeconds(scan));
    } else if (Word(scan, "textmsg")) {
      ReadMessage(scan, start);
    } else if (Word(scan, "popup")) {
      ReadQuestion(scan, start);
    } else {
      return false;
    }
    return true;
  }

  void ReadMessage(LineScanner& scan, size_t start) {
    scan.Expect("(");
    const std::string text = urscript::ReadString(scan);
    scan.Expect(")");
    Allow(scan, start, kAtStops);
    const size_t events = program_.events.size();
    LineScanner mark(text, "", 0);
    const bool begin = Word(mark, "PASS");
    if (!text.starts_with(' ') && (begin || Word(mark, "END OF PASS"))) ReadPassMark(mark, begin);
    if (program_.events.size() == events) AddHandEvent(ProgramEvent::Kind::kMessage, text);
  }

  void ReadQuestion(LineScanner& scan, size_t start) {
    const bool stops = urscript::ReadPopup(scan);
    if (InHead() && scan.TakenFrom(start) == Notice()) {
      program_.notice = kCompensatedNotice;
      return;
    }
    ReadHandEvent(scan, start, stops ? ProgramEvent::Kind::kStop : ProgramEvent::Kind::kMessage,
                  kOutsideCuts);
  }

  static std::string Notice() {
    return fmt::format("popup(\"{}\", title=\"millpose\", warning=True, blocking=True)", kCompensatedNotice);
  }

  /// A blend leads into a motion of the same kind alone.
  void ExpectNoBlend(const LineScanner& scan, size_t start) const {
    if (!program_.motions.empty() && program_.motions.back().blend > 0)
      scan.FailFrom(start, "r=0 in the motion before expected: its blend leads nowhere");
  }

  static double Within(const LineScanner& scan, size_t start, const Numbers& named, const std::string& name,
                       double least, double most) {
    const auto found = named.find(name);
    if (found == named.end()) scan.FailFrom(start, fmt::format("{}= expected", name));
    if (found->second < least || found->second > most + kLastDigit)
      scan.FailFrom(start, fmt::format("{} from {} to {} expected", name, Fixed(least, 4), Fixed(most, 4)));
    return found->second;
  }

  /// All joints together, from a stop to a stop.
  void ReadJoints(LineScanner& scan) {
    const size_t start = scan.Next();
    ExpectNoBlend(scan, start);
    scan.Expect("(");
    if (Word(scan, "p")) scan.Fail("six joint angles expected: a pose leaves the configuration open");
    const std::vector<double> angles = urscript::ReadList(scan, 6);
    const Numbers named = ReadNamed(scan, {"a", "v", "r"});
    scan.Expect(")");
    const double acceleration = UrScriptMovejAcceleration(arm_), speed = UrScriptMovejSpeed(arm_, options_);
    Within(scan, start, named, "a", kLeastAcceleration * acceleration, acceleration);
    Within(scan, start, named, "v", kLeastAcceleration * speed, speed);
    if (named.contains("r") && named.at("r") != 0)
      scan.FailFrom(start, "r=0 expected: ways stop at each of their points");
    Motion& motion = AddMotion(MotionType::kJoint);
    motion.q = settings_.axes.ToArm(Eigen::Map<const Joints>(angles.data()));
    motion.exact = true;
  }

  /// mm: where the tip stands, in the base.
  Eigen::Vector3d Tip() const {
    const Motion& last = program_.motions.back();
    if (!last.q) return last.X_PT.translation();
    return (ForwardFlange(arm_, *last.q) * program_.X_FT.value_or(settings_.X_FT)).translation();
  }

  void ReadLine(LineScanner& scan, bool movel) {
    const size_t start = scan.Next();
    scan.Expect("(");
    Pose X_BC = ReadPose(scan);
    const Numbers named = ReadNamed(scan, {"a", "v", "r"});
    scan.Expect(")");
    if (InHead()) scan.FailFrom(start, "movej before it expected: where this motion begins is not known");
    const double acceleration = UrScriptAcceleration(settings_, options_) / 1000;
    Within(scan, start, named, "a", kLeastAcceleration * acceleration, acceleration);
    const double feed = 1000 * Within(scan, start, named, "v", 0, 10);
    if (feed <= 0) scan.FailFrom(start, "v above 0 expected");
    const double radius = named.contains("r") ? 1000 * named.at("r") : 0;
    CheckBlends(scan, start, X_BC.translation(), radius, movel);
    posed_ = true;
    movel_ = movel;
    Motion& motion = AddMotion(MotionType::kLinear);
    X_BC.linear() = X_BC.linear() * settings_.R_TC().transpose();
    motion.X_PT = X_BC;
    motion.feed = feed;
    motion.blend = radius;
    motion.exact = radius == 0;
  }

  /// Blends that meet make the controller leave a point out; from movep to movel (or back) none leads.
  void CheckBlends(const LineScanner& scan, size_t start, const Eigen::Vector3d& tip, double radius,
                   bool movel) const {
    if (radius < 0) scan.FailFrom(start, "r of 0 or more expected");
    const double before = program_.motions.back().blend, distance = (tip - Tip()).norm();
    if (before > 0 && movel != movel_)
      scan.FailFrom(start,
                    fmt::format("{} expected: the motion before blends into it", movel_ ? "movel" : "movep"));
    if (before + radius > 0 && before + radius >= distance)
      scan.FailFrom(start,
                    fmt::format("r of this motion and the one before below {:.4f} mm together expected, the "
                                "distance of their ends: blends that meet make the controller skip a move",
                                distance));
  }

  const Arm& arm_;
  const UrScriptOptions& options_;
  int loops_ = 0;         // that a text has open
  bool defined_ = false;  // def was read
  bool posed_ = false;    // a pose was approached
  bool movel_ = false;    // which it was, of the last pose
};

}  // namespace

std::vector<Problem> UrScriptPost::CheckTexts(const Arm& arm, const PostSettings& settings) const {
  return UrScriptReader({}, arm, settings, options_).CheckTexts();
}

MotionProgram UrScriptPost::Read(const ProgramFiles& files, const Arm& arm,
                                 const PostSettings& settings) const {
  return UrScriptReader(files, arm, settings, options_).Read(Endings());
}

}  // namespace millpose
