// SPDX-License-Identifier: GPL-3.0-or-later
// Reads SINUMERIK programs as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/reader.hpp"
#include "program/sinumerik/sinumerik.hpp"
#include "program/sinumerik/sinumerik_block.hpp"
#include "program/sinumerik/sinumerik_words.hpp"

namespace millpose {
namespace {

constexpr double kSamePlace = 1e-9;  // of a frame stated again

class SinumerikReader : public ProgramReader {
 public:
  SinumerikReader(const ProgramFiles& files, const PostSettings& settings, const SinumerikOptions& options)
      : ProgramReader(files, settings, Templates(SinumerikTexts(), settings.texts, ToolOf(settings))),
        options_(options) {
    program_.swivel = settings.R_TC() * Eigen::Vector3d::UnitZ();
    program_.any_turn = !options.ori_ipo_with_g_code;
    for (const ControllerAxis& axis : settings.controller_axes) external_names_.push_back(axis.name);
    program_.rotation = settings.rotation;
    program_.R_TC = settings.R_TC();
  }

 private:
  std::vector<std::string> Needed() const override { return {"G17", "G40", "G90", "G94", "G710"}; }

  size_t LongestLine() const override { return kLongestBlock; }

  void Forgotten() override {
    frame_known_ = false;
    transformed_.reset();
    SinceTransformation();
    last_ = {};
    feed_ = 0;
    motion_ = -1;
    ptp_.reset();
  }

  /// TRAORI and TRAFOOF deselect the frame and end rounding (Transformations, Function Manual); which of the
  /// words of orientation outlive them is machine data.
  void SinceTransformation() {
    settings_since_.clear();
    tolerances_ = {};
  }

  void ReadCode(LineScanner& scan) override {
    const size_t start = scan.Next();
    SinumerikBlock block(options_.axis_names, words_, external_names_);
    if (scan.AcceptAddress('N', false)) scan.ExpectDecimal();
    ReadLabel(scan);
    while (!scan.AtEnd()) {
      if (InText() && ReadTextWord(scan)) continue;
      if (!block.Accept(scan) && !ReadStatement(scan, block)) ReadName(scan, block);
    }
    Apply(scan, start, block);
  }

  /// A label stands first in its block.
  void ReadLabel(LineScanner& scan) {
    LineScanner ahead = scan;
    const size_t start = ahead.Next();
    const auto name = ahead.AcceptName();
    if (!name || !ahead.Accept(":")) return;
    AddLabel(ahead, start, *name);
    scan = ahead;
  }

  /// The call of a sub-program.
  void ReadName(LineScanner& scan, const SinumerikBlock& block) {
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (name && IsDeclared(*name)) {
      const std::string arguments = scan.Accept("(") ? ReadArguments(scan) : "";
      ReadDeclaredCall(scan, start, *name, arguments);
      return scan.ExpectEnd();
    }
    const char* message = "a word of a milling program or the call of a file of the program expected";
    if (!name) scan.Fail(message);
    if (!scan.AtEnd() || !block.IsEmpty() || !ReadCall(scan, *name)) scan.FailFrom(start, message);
  }

  /// Spindle, coolant, outputs: what a text of the cell may switch.
  bool ReadTextWord(LineScanner& scan) override {
    for (const std::string_view word : {"M3", "M4", "M5", "M7", "M8", "M9", "STOPRE"}) {
      if (scan.Accept(word)) return true;
    }
    if (scan.Accept("$A_OUT") || scan.Accept("$A_OUTA")) {
      scan.Expect("[");
      scan.ExpectDecimal();
      scan.Expect("]");
      scan.Expect("=");
      scan.ExpectDecimal();
      return true;
    }
    if (!scan.AcceptAddress('S')) return false;
    scan.Accept("=");
    scan.ExpectDecimal();
    return true;
  }

  /// Statements that stand in a block of their own.
  bool ReadStatement(LineScanner& scan, SinumerikBlock& block) {
    const size_t start = scan.Next();
    if (scan.Accept("TRAORI") || scan.Accept("TRAFOOF")) {
      transformed_ = scan.TakenFrom(start).size() == 6;
      SinceTransformation();
      Allow(scan, start, kAtStops);
    } else if (scan.Accept("CYCLE832")) {
      tolerances_ = sinumerik::ReadTolerances(scan);
      for (const char* word : {"COMPOF", "G642"}) settings_since_.erase(word);
      Allow(scan, start, kAtStops);
    } else if (scan.Accept("MSG")) {
      ReadMessage(scan);
    } else if (scan.Accept("WHEN TRUE DO")) {
      AddOutput(sinumerik::ReadOutput(scan));
    } else if (scan.Accept("$P_UIFR")) {
      ReadFrame(scan, start);
      Allow(scan, start, kOutsideCuts);
    } else {
      return false;
    }
    block.StandsAlone(scan, start);
    return true;
  }

  void ReadMessage(LineScanner& scan) {
    const size_t events = program_.events.size();
    scan.Expect("(");
    if (scan.Accept(")")) return AddHandEvent(ProgramEvent::Kind::kMessage, "");
    scan.Expect("\"");
    const size_t start = scan.Next();
    const bool begin = !InText() && scan.Accept("PASS");
    if (begin || (!InText() && scan.Accept("END OF PASS"))) ReadPassMark(scan, begin);
    if (InHead() && !InText() && scan.Accept(kCompensatedNotice)) program_.notice = kCompensatedNotice;
    while (scan.Peek() != '"' && scan.Peek() != '\0') scan.Skip();
    if (program_.events.size() == events) AddHandEvent(ProgramEvent::Kind::kMessage, scan.TakenFrom(start));
    scan.Expect("\"");
    scan.Expect(")");
  }

  /// $P_UIFR[5]=…: takes effect with the next G505.
  void ReadFrame(LineScanner& scan, size_t start) {
    scan.Expect("[");
    const double index = scan.ExpectDecimal();
    scan.Expect("]");
    if (index != options_.Frame() - 500)
      scan.FailFrom(start, fmt::format("$P_UIFR[{}] expected: the cell's settable frame is G{}",
                                       options_.Frame() - 500, options_.Frame()));
    scan.Expect("=");
    const Pose X_BP = sinumerik::ReadFrame(scan);  // with the coupled axes at 0
    const bool same = program_.X_BP && X_BP.matrix().isApprox(program_.X_BP->matrix(), kSamePlace);
    if (external_.empty() && posed_ && program_.X_BP && !same)
      scan.FailFrom(start, "one frame for all poses of the program expected");
    program_.X_BP = X_BP;
    frame_known_ = true;
    settings_since_.erase(FrameWord());
  }

  /// The tool is changed before the program's frame holds, or where the cell has it changed.
  Places ChangePlaces() const { return settings_.change_at ? Places{ProgramPlace::kWay} : kHeadOnly; }

  std::string FrameWord() const { return fmt::format("G{}", options_.Frame()); }

  /// The words of a block, in the order in which they take effect: settings, then the motion.
  void Apply(LineScanner& scan, size_t start, const SinumerikBlock& block) {
    for (const std::string& word : block.g_words()) Setting(scan, start, word);
    if (const auto& tool = block.tool()) {
      if (*tool != settings_.tool_name)
        scan.FailFrom(start, fmt::format("tool {} expected", settings_.tool_name));
      Allow(scan, start, ChangePlaces());
      AddHandEvent(ProgramEvent::Kind::kTool, "T " + *tool);
    }
    if (const auto edge = block.Word("D")) {
      if (*edge != 1) scan.FailFrom(start, "D1 expected: another edge or none puts the tip elsewhere");
      Allow(scan, start, ChangePlaces());
      AddHandEvent(ProgramEvent::Kind::kTool, "D1");
    }
    Tolerances(scan, start, block);
    if (block.Has("G4")) {
      if (block.HasPose() || block.HasAxes()) scan.FailFrom(start, "G4 in a block of its own expected");
      const double seconds = block.Word("F").value_or(-1);
      if (seconds < 0) scan.FailFrom(start, "G4 needs F and 0 or more seconds");
      ReadDwell(scan, start, seconds);
    } else if (const auto feed = block.Word("F")) {
      if (*feed <= 0) scan.FailFrom(start, "F above 0 expected");
      feed_ = *feed / 60;
    }
    const bool rides = block.HasPose() && !block.HasRobotAxes() && transformed_ == true;
    if (block.HasAxes() && !rides) {
      AddAxes(scan, start, block);
    } else if (block.HasPose()) {
      AddPose(scan, start, block);
    } else if (block.Has("SUPA") || block.Has("G9") || block.Word("STAT") || block.Word("TU")) {
      scan.FailFrom(start, "a motion in the block of G9, SUPA, STAT or TU expected");
    }
    for (const int m : block.m_codes()) Miscellaneous(scan, start, m);
  }

  void Tolerances(const LineScanner& scan, size_t start, const SinumerikBlock& block) {
    const auto position = block.Word("CTOL"), orientation = block.Word("OTOL");
    if (!position && !orientation) return;
    if (position.value_or(1) <= 0 || orientation.value_or(1) <= 0)
      scan.FailFrom(start, "CTOL and OTOL above 0 expected");
    if (position) tolerances_.position = *position;
    if (orientation) tolerances_.orientation = *orientation * kRadPerDeg;
    Allow(scan, start, kAtStops);
  }

  void Setting(const LineScanner& scan, size_t start, const std::string& word) {
    if (word == "G0" || word == "G1") {
      motion_ = word == "G0" ? 0 : 1;
    } else if (word == "PTP" || word == "CP") {
      ptp_ = word == "PTP";
    } else if (word == FrameWord()) {
      settings_since_.insert(word);
      if (!std::exchange(frame_known_, true)) {  // reported once
        if (!program_.X_BP) program_.X_BP = Pose::Identity();
        scan.FailFrom(start, fmt::format("$P_UIFR[{}] before {} expected", options_.Frame() - 500, word));
      }
      Allow(scan, start, kAtStops);
    } else if (SinumerikBlock::GroupOf(word) == SinumerikBlock::kFrameGroup) {
      scan.FailFrom(start, fmt::format("{} expected, the cell's settable frame", FrameWord()));
    } else if (word.starts_with("ORI") && SinumerikBlock::GroupOf(word) == SinumerikBlock::kAngleGroup) {
      if (word != AngleWord())
        scan.FailFrom(start, fmt::format("{} expected, as the cell's orientation_words say", AngleWord()));
      settings_since_.insert(word);
      Allow(scan, start, kAtStops);
    } else if (word == "ORIVECT" || word == "ORIWKS" || word == "G642" || word == "COMPOF") {
      settings_since_.insert(word);
      Allow(scan, start, kAtStops);
    } else {
      Stated(word);
    }
  }

  std::string AngleWord() const { return SinumerikAngleWord(settings_.rotation); }

  void Miscellaneous(const LineScanner& scan, size_t start, int m) {
    const int end = InSubprogram() ? 17 : 30;
    if (m == 0 || m == 1) {
      AddHandEvent(ProgramEvent::Kind::kStop, fmt::format("M{}", m));
      return Allow(scan, start, kOutsideCuts);
    }
    if (m == 6) {
      AddHandEvent(ProgramEvent::Kind::kTool, "M6");
      return Allow(scan, start, ChangePlaces());
    }
    if (m != end)
      scan.FailFrom(start,
                    fmt::format("M0, M1, M6 or M{} expected (spindle and coolant: the cell's texts)", end));
    EndFile();
  }

  /// What must have been stated since the last TRAORI; reported once after each.
  void ExpectSince(const LineScanner& scan, size_t start, const std::vector<std::string>& words) {
    std::vector<std::string> missing;
    for (const std::string& word : words) {
      if (settings_since_.insert(word).second) missing.push_back(word);
    }
    if (missing.empty()) return;
    scan.FailFrom(
        start, fmt::format("{} between the last TRAORI and this motion expected", fmt::join(missing, ", ")));
  }

  void AddAxes(const LineScanner& scan, size_t start, const SinumerikBlock& block) {
    if (transformed_ != false)
      scan.FailFrom(start, "axes cannot be moved by themselves while TRAORI holds: TRAFOOF expected before");
    if (motion_ != 0) scan.FailFrom(start, "axes are moved with G0 here");
    if (!block.Has("SUPA"))
      scan.FailFrom(start, "SUPA expected: without it a frame, and the tool's length, may act on the axes");
    if (block.HasPose()) scan.FailFrom(start, "axes or a pose expected");
    Joints angles;
    for (int i = 0; i < 6; ++i) {
      if (!block.axis(i)) scan.FailFrom(start, fmt::format("{} is missing", options_.axis_names[i]));
      angles[i] = *block.axis(i) * kRadPerDeg;
    }
    for (const ControllerAxis& axis : settings_.controller_axes) {
      const auto value = block.Word(axis.name);
      if (!value) scan.FailFrom(start, fmt::format("{} is missing", axis.name));
      SetValue(settings_, axis, *value, external_);
    }
    Motion& motion = AddMotion(MotionType::kJoint);
    motion.q = settings_.axes.ToArm(angles);
    motion.exact = true;
    Stand(motion);
    last_ = {};
  }

  /// The frame that counts where the external axes stand.
  void Stand(Motion& motion) const {
    if (program_.X_BP && !external_.empty()) motion.X_BP = FromCounted(settings_, external_, *program_.X_BP);
  }

  /// External axes beside a pose: the transformation keeps the tip where it is on the part. What it does not
  /// count in must stand still.
  void CoordinatedAlong(const LineScanner& scan, size_t start, const SinumerikBlock& block) {
    for (const ControllerAxis& axis : settings_.controller_axes) {
      const auto value = block.Word(axis.name);
      if (!value) continue;
      if (!axis.coupled)
        scan.FailFrom(start,
                      fmt::format("{} stands still while TRAORI holds: the transformation does not count "
                                  "in it (coupled: false in the cell)",
                                  axis.name));
      if (*ptp_) scan.FailFrom(start, fmt::format("{} moves with a pose in G1 alone", axis.name));
      SetValue(settings_, axis, *value, external_);
    }
  }

  void AddPose(const LineScanner& scan, size_t start, const SinumerikBlock& block) {
    if (transformed_ != true) scan.FailFrom(start, "a pose can only be approached while TRAORI holds");
    if (block.Has("SUPA"))
      scan.FailFrom(start, "a pose without SUPA expected: it would count from elsewhere");
    for (int i = 0; i < 6; ++i) {
      if (block.pose(i)) last_[i] = block.pose(i);
      if (!last_[i]) scan.FailFrom(start, fmt::format("{} is missing", block.PoseWord(i)));
    }
    if (InHead() && !external_.empty())
      scan.FailFrom(start,
                    "a joint block before the first pose expected: it says where the external axes stand");
    posed_ = true;
    ExpectSince(scan, start, {FrameWord(), AngleWord(), "ORIVECT", "ORIWKS"});
    if (!ptp_) scan.FailFrom(start, "PTP or CP expected");
    if (*ptp_ != (motion_ == 0)) scan.FailFrom(start, "G0 with PTP or G1 with CP expected");
    if (!*ptp_ && (block.Word("STAT") || block.Word("TU")))
      scan.FailFrom(start, "STAT and TU with PTP alone expected");
    const bool rounds = !*ptp_ && !block.Has("G9");
    if (rounds) {
      ExpectSince(scan, start, {"COMPOF", "G642"});
      if (!tolerances_.position || !tolerances_.orientation) {
        tolerances_.position = tolerances_.orientation = 0;  // reported once
        scan.FailFrom(
            start,
            "the tolerances of rounded corners expected before, since TRAORI: CYCLE832 with _ORI_FINISH, or "
            "_FINISH and OTOL=");
      }
    }
    const ExternalPosition before = external_;
    if (block.HasAxes()) CoordinatedAlong(scan, start, block);
    Motion& motion = AddMotion(*ptp_ ? MotionType::kJoint : MotionType::kLinear);
    motion.X_PT.translation() = Eigen::Vector3d(*last_[0], *last_[1], *last_[2]);
    motion.angles = Eigen::Vector3d(*last_[3], *last_[4], *last_[5]) * kRadPerDeg;
    motion.X_PT.linear() = FromToolAngles(settings_.rotation, *motion.angles) * settings_.R_TC().transpose();
    motion.exact = !rounds;
    Stand(motion);
    if (external_ != before && program_.X_BP)
      motion.X_BP_begin = FromCounted(settings_, before, *program_.X_BP);
    if (*ptp_) {
      if (const auto stat = block.bits("STAT")) motion.status = options_.Stat(*stat);
      motion.turn = block.bits("TU");
      return;
    }
    if (feed_ <= 0) scan.FailFrom(start, "G1 needs F");
    motion.feed = feed_;
    if (!rounds) return;
    motion.blend = *tolerances_.position;
    motion.angle_blend = *tolerances_.orientation;
  }

  const SinumerikOptions& options_;
  const std::array<std::string, 3> words_ = options_.Words();
  std::vector<std::string> external_names_;
  std::array<std::optional<double>, 6> last_;  // X, Y, Z, A, B, C as they hold
  double feed_ = 0;                            // mm/s
  sinumerik::Tolerances tolerances_;           // of rounded corners
  std::set<std::string> settings_since_;       // the last TRAORI or TRAFOOF
  bool frame_known_ = false;                   // the settable frame was set, and no call came since
  bool posed_ = false;                         // a pose was approached
  std::optional<bool> transformed_;            // TRAORI holds
  std::optional<bool> ptp_;                    // PTP holds, not CP
  int motion_ = -1;                            // of G0 and G1 the one that holds; −1: unknown
};

}  // namespace

std::vector<Problem> SinumerikPost::CheckTexts(const Arm&, const PostSettings& settings) const {
  return SinumerikReader({}, settings, options_).CheckTexts();
}

MotionProgram SinumerikPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  return SinumerikReader(files, settings, options_).Read({".mpf", ".spf"});
}

}  // namespace millpose
