// SPDX-License-Identifier: GPL-3.0-or-later
// Reads RAPID as far as robot programs of millpose and the usual hand edits go.
#include "base/text.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/rapid/rapid_configuration.hpp"
#include "program/rapid/rapid_module.hpp"

namespace millpose {
namespace {

constexpr double kExternalSlack = 1e-3;  // mm or degrees; a num holds 4000.0005 no better
constexpr double kSameSetting = 1e-6;    // relative
constexpr double kSamePlace = 1e-9;      // of a frame stated again
constexpr int kMostQuarters = 40;        // of a configuration: ten revolutions

class RapidReader : public RapidModuleReader {
 public:
  RapidReader(const ProgramFiles& files, const Arm& arm, const PostSettings& settings,
              const RapidOptions& options)
      : RapidModuleReader(files, settings, options), arm_(arm) {}

 private:
  std::vector<std::string> Needed() const override { return settings_needed_; }

  void ReadStatement(LineScanner& scan) override {
    if (InText() && ReadTextWord(scan)) return;
    const size_t start = scan.Next();
    if (scan.Accept("MoveL")) return ReadMoveL(scan);
    if (scan.Accept("MoveAbsJ")) return ReadMoveAbsJ(scan);
    if (ReadSetting(scan) || ReadPause(scan, start) || ReadLoading(scan, start)) return;
    if (scan.Accept("SetDO")) return ReadOutput(scan, start);
    ReadName(scan, start);
  }

  /// Only texts of the cell may hold these, each as a whole statement.
  bool ReadTextWord(LineScanner& scan) override {
    if (scan.Accept("SetDO")) {
      ReadSignal(scan);
      scan.Expect(",");
      ReadBit(scan);
    } else if (scan.Accept("Set") || scan.Accept("Reset") || scan.Accept("PulseDO")) {
      ReadSignal(scan);
    } else if (scan.Accept("SetAO") || scan.Accept("SetGO")) {
      ReadSignal(scan);
      scan.Expect(",");
      do {
        rapid::ReadNum(scan);
      } while (scan.Accept("*") || scan.Accept("/"));
    } else {
      return false;
    }
    return true;
  }

  static std::string ReadSignal(LineScanner& scan) {
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (!name || name->size() > 32) scan.FailFrom(start, "the name of a signal expected");
    return Spelled(*name);
  }

  static bool ReadBit(LineScanner& scan) {
    const size_t start = scan.Next();
    const double bit = scan.ExpectNumber();
    if (bit != 0 && bit != 1) scan.FailFrom(start, "0 or 1 expected");
    return bit == 1;
  }

  /// Statements that say one thing and must say it: what RapidSettings() lists.
  bool ReadSetting(LineScanner& scan) {
    for (const std::string& setting : settings_needed_) {
      LineScanner ahead = scan;
      const size_t start = ahead.Next();
      LineScanner wanted(setting, "", 0);
      const std::string word = wanted.AcceptName().value_or("");
      if (!ahead.Accept(word)) continue;
      if (word == "ActUnit" && !SameSettings(ahead, wanted)) continue;
      scan = ahead;
      if (word != "ActUnit" && !SameSettings(scan, wanted))
        scan.FailFrom(start, fmt::format("{} expected", setting));
      Stated(setting);
      Allow(scan, start, kOutsideCuts);
      return true;
    }
    return false;
  }

  /// What is left of `wanted` comes next; numbers by their value.
  static bool SameSettings(LineScanner& scan, LineScanner& wanted) {
    while (!wanted.AtEnd()) {
      const char c = wanted.Peek();
      if (c >= '0' && c <= '9') {
        const double value = wanted.ExpectNumber();
        if (scan.ExpectNumber() != value) return false;
      } else if (const auto word = wanted.AcceptName()) {
        if (!scan.Accept(*word)) return false;
      } else {
        if (!scan.Accept(std::string(1, c))) return false;
        wanted.Skip();
      }
    }
    return true;
  }

  /// What stops the program for a while, and what it says.
  bool ReadPause(LineScanner& scan, size_t start) {
    using Kind = ProgramEvent::Kind;
    if (scan.Accept("WaitTime")) {
      if (scan.Accept("\\")) {
        scan.Expect("InPos");
        scan.Expect(",");
      }
      const size_t number = scan.Next();
      const double seconds = rapid::ReadNum(scan);
      if (seconds < 0) scan.FailFrom(number, "0 or more seconds expected");
      ReadDwell(scan, start, seconds);
    } else if (scan.Accept("WaitDI")) {
      ReadSignal(scan);
      scan.Expect(",");
      ReadBit(scan);
      ReadHandEvent(scan, start, Kind::kWait, kOutsideCuts);
    } else if (scan.Accept("Stop")) {
      ReadHandEvent(scan, start, Kind::kStop, kOutsideCuts);
    } else if (scan.Accept("TPWrite")) {
      ReadMessage(scan, start);
    } else {
      return false;
    }
    return true;
  }

  void ReadMessage(LineScanner& scan, size_t start) {
    scan.Expect("\"");
    const std::string text = scan.TakeUntil('"');
    scan.Expect("\"");
    const bool notice = InHead() && !InText() && program_.notice.empty() && !InSubprogram() &&
                        SameWords(text, kCompensatedNotice);
    if (notice)
      program_.notice = kCompensatedNotice;
    else
      ReadHandEvent(scan, start, ProgramEvent::Kind::kMessage, kOutsideCuts);
  }

  /// An output of the cell, switched on the path where the arm stands anyway.
  void ReadOutput(LineScanner& scan, size_t start) {
    const std::string signal = ReadSignal(scan), prefix = Spelled(options_.signal_prefix);
    const std::string digits = signal.starts_with(prefix) ? signal.substr(prefix.size()) : std::string();
    const bool whole =
        !digits.empty() && digits.size() <= 4 && digits.find_first_not_of("0123456789") == std::string::npos;
    const int number = whole ? std::stoi(digits) : 0;
    if (!whole || std::to_string(number) != digits)
      scan.FailFrom(start, fmt::format("a signal {}n expected (signal_prefix; others: the cell's texts)",
                                       options_.signal_prefix));
    scan.Expect(",");
    PathOutput output;
    output.number = number;
    output.on = ReadBit(scan);
    Allow(scan, start, {ProgramPlace::kStop});
    AddOutput(output);
  }

  /// A value for a persistent, the call of a file of the program or of a routine of the plant.
  void ReadName(LineScanner& scan, size_t start) {
    static const std::vector<std::string> statements = {
        "MoveL",      "MoveAbsJ",    "SetDO",    "WaitTime", "WaitDI",    "Stop",   "TPWrite", "ConfJ",
        "ConfL",      "SingArea",    "PDispOff", "EOffsOff", "SoftDeact", "VelSet", "AccSet",  "GripLoad",
        "PathAccLim", "WorldAccLim", "ActUnit",  "Load",     "UnLoad",    "ENDPROC"};
    const auto name = scan.AcceptName();
    if (name && scan.Accept(":=")) return Assign(scan, start, *name);
    if (name && IsDeclared(*name)) {
      const std::string arguments = ReadPlantArguments(scan);
      ReadDeclaredCall(scan, start, *name, arguments);
      return;
    }
    if (name && scan.Peek() == ';' && ReadSubprogram(scan, *name)) return;
    const std::string nearest = NearestName(name.value_or(""), statements);
    scan.FailFrom(start, fmt::format("{} or the call of a file of the program expected (spindle and outputs: "
                                     "the cell's texts){}",
                                     fmt::join(statements, ", "),
                                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }

  /// Numbers, words and texts up to the end of the statement.
  static std::string ReadPlantArguments(LineScanner& scan) {
    std::string arguments;
    if (scan.Peek() == ';' || scan.AtEnd()) return arguments;
    do {
      const size_t start = scan.Next();
      if (scan.Accept("\"")) {
        scan.TakeUntil('"');
        scan.Expect("\"");
        arguments += scan.TakenFrom(start);
      } else if (scan.AcceptName()) {
        arguments += Spelled(scan.TakenFrom(start));
      } else {
        arguments += ShortestNumber(rapid::ReadNum(scan));
      }
      arguments += ",";
    } while (scan.Accept(","));
    arguments.pop_back();
    return arguments;
  }

  /// Where the axes beside the arm's six go; the rest must be 9E9.
  void ReadExternal(LineScanner& scan, Motion& motion) {
    scan.Expect("[");
    for (const std::string& name : RapidAxisNames()) {
      if (name != RapidAxisNames().front()) scan.Expect(",");
      const size_t start = scan.Next();
      const auto axis = std::ranges::find(settings_.controller_axes, name, &ControllerAxis::name);
      const bool none =
          scan.Accept("9E9") || scan.Accept("9E+9") || scan.Accept("9E+09") || scan.Accept("9E09");
      if (axis == settings_.controller_axes.end()) {
        if (!none) scan.Fail(fmt::format("9E9 expected: the cell has no axis {}", name));
        continue;
      }
      if (none) scan.FailFrom(start, fmt::format("where {} goes expected", name));
      const double value = rapid::ReadNum(scan);
      if (axis->axis.empty() && std::abs(value - axis->constant) > kExternalSlack)
        scan.FailFrom(
            start, fmt::format("{} stays at {} in this program; that value expected", name, axis->constant));
      SetValue(settings_, *axis, value, external_);
    }
    scan.Expect("]");
    motion.external = external_;
  }

  /// ",mp_tool\WObj:=mp_wobj": the frames that a motion counts in.
  void ReadFrames(LineScanner& scan, Motion& motion, const ExternalPosition& before) {
    scan.Expect(",");
    const size_t start = scan.Next();
    Pose X_FT = DatumOf(scan, Type::kTool, "tooldata").frame;
    X_FT.linear() = X_FT.linear() * settings_.R_TC().transpose();
    if (posed_ && !Same(X_FT, program_.X_FT))
      scan.FailFrom(start, "one tool for all motions of the program expected");
    program_.X_FT = X_FT;
    scan.Expect("\\");
    scan.Expect("WObj");
    scan.Expect(":=");
    const size_t at = scan.Next();
    const Pose object = DatumOf(scan, Type::kObject, "wobjdata").object.frame;
    const Pose X_BP = RapidBaseFrame(options_, settings_, {}, object);
    if (posed_ && external_.empty() && !Same(X_BP, program_.X_BP))
      scan.FailFrom(at, "one work object for all motions of the program expected");
    program_.X_BP = X_BP;
    posed_ = true;
    if (external_.empty()) return;
    motion.X_BP = FromCounted(settings_, external_, X_BP);
    if (motion.type == MotionType::kLinear && before != motion.external)
      motion.X_BP_begin = FromCounted(settings_, before, X_BP);
  }

  static bool Same(const Pose& a, const std::optional<Pose>& b) {
    return b && a.matrix().isApprox(b->matrix(), kSamePlace);
  }

  void ReadMoveAbsJ(LineScanner& scan) {
    Motion& motion = AddMotion(MotionType::kJoint);
    scan.Expect("[");
    const std::array<double, 6> degrees = rapid::ReadNums<6>(scan);
    scan.Expect(",");
    const ExternalPosition before = external_;
    ReadExternal(scan, motion);
    scan.Expect("]");
    scan.Expect("\\");
    scan.Expect("NoEOffs");
    scan.Expect(",");
    Joints angles;
    for (int i = 0; i < 6; ++i) angles[i] = degrees[static_cast<size_t>(i)] * kRadPerDeg;
    motion.q = settings_.axes.ToArm(angles);
    const size_t start = scan.Next();
    const rapid::Speed speed = DatumOf(scan, Type::kSpeed, "speeddata").speed;
    if (speed.tip > options_.way_speed * (1 + kSameSetting) ||
        speed.turn > options_.orientation_speed * (1 + kSameSetting))
      scan.FailFrom(start,
                    fmt::format("at most {} mm/s and {} deg/s expected (the cell's way_speed_mm_s and "
                                "orientation_speed_deg_s)",
                                options_.way_speed, Short(options_.orientation_speed * kDegPerRad, 4)));
    scan.Expect(",");
    scan.Expect("fine");
    motion.exact = true;
    ReadFrames(scan, motion, before);
  }

  void ReadMoveL(LineScanner& scan) {
    const ExternalPosition before = external_;
    Motion& motion = AddMotion(MotionType::kLinear);
    scan.Expect("[");
    const std::array<double, 3> p = rapid::ReadNums<3>(scan);
    scan.Expect(",");
    motion.X_PT.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
    motion.X_PT.linear() = rapid::ReadOrient(scan) * settings_.R_TC().transpose();
    scan.Expect(",");
    const size_t start = scan.Next();
    const RapidConfiguration configuration = ReadConfiguration(scan);
    scan.Expect(",");
    ReadExternal(scan, motion);
    scan.Expect("]");
    scan.Expect(",");
    const rapid::Speed speed = DatumOf(scan, Type::kSpeed, "speeddata").speed;
    motion.feed = speed.tip;
    motion.turn_speed = speed.turn;
    scan.Expect(",");
    motion.exact = scan.Accept("fine");
    if (!motion.exact) motion.blend = DatumOf(scan, Type::kZone, "fine or zonedata").zone;
    ReadFrames(scan, motion, before);
    if (const std::string name = UncoupledMove(settings_, before, motion.external); !name.empty())
      scan.Fail(
          fmt::format("{} moves in a MoveL; the controller does not count in it (coupled: false in the "
                      "cell), so that it must stand still",
                      name));
    CheckConfiguration(scan, start, configuration, motion);
  }

  static RapidConfiguration ReadConfiguration(LineScanner& scan) {
    const size_t start = scan.Next();
    const std::array<double, 4> given = rapid::ReadNums<4>(scan);
    RapidConfiguration configuration{};
    for (size_t i = 0; i < given.size(); ++i) {
      if (given[i] != std::round(given[i]) || std::abs(given[i]) > kMostQuarters)
        scan.FailFrom(start, "whole numbers [cf1,cf4,cf6,cfx] expected");
      configuration[i] = static_cast<int>(given[i]);
    }
    if (configuration[3] < 0 || configuration[3] > 7) scan.FailFrom(start, "cfx 0 to 7 expected");
    return configuration;
  }

  /// Under ConfL\On a straight motion that ends in another configuration than its target says stops the
  /// program. A place that is out of reach is told where it is replayed. `motion` gets its joints.
  void CheckConfiguration(const LineScanner& scan, size_t start, const RapidConfiguration& given,
                          Motion& motion) {
    const size_t count = program_.motions.size();
    const Motion* before = count > 1 ? &program_.motions[count - 2] : nullptr;
    const std::optional<Pose>& X_BP = FrameOf(program_, motion);
    if (!before || !before->q || !X_BP || !program_.X_FT) return;
    const Joints& from = *before->q;
    motion.q = InverseNear(arm_, *X_BP * motion.X_PT * program_.X_FT->inverse(), Status(arm_, from), from);
    if (!motion.q || FitsRapidConfiguration(given, arm_, settings_.axes, *motion.q)) return;
    scan.FailFrom(start,
                  fmt::format("{} expected: so the arm stands at the end of this motion",
                              RapidConfigurationText(RapidConfigurationOf(arm_, settings_.axes, *motion.q))));
  }

  const Arm& arm_;
  const std::vector<std::string> settings_needed_ = RapidSettings(options_);
  bool posed_ = false;  // a motion has said its tool and work object
};

}  // namespace

std::vector<Problem> RapidPost::CheckTexts(const Arm& arm, const PostSettings& settings) const {
  return RapidReader({}, arm, settings, options_).CheckTextsAlone();
}

MotionProgram RapidPost::Read(const ProgramFiles& files, const Arm& arm, const PostSettings& settings) const {
  return RapidReader(files, arm, settings, options_).Read({".mod"});
}

}  // namespace millpose
