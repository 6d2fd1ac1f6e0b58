// SPDX-License-Identifier: GPL-3.0-or-later
// Reads RS-274/NGC as LinuxCNC does, as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/linuxcnc/linuxcnc_block.hpp"
#include "program/reader.hpp"

namespace millpose {
namespace {

constexpr const char* kPathMode = "G61, G61.1 or G64";
constexpr const char* kFeedMode = "G93 or G94";
constexpr const char* kKinematics = "the cell's text joints_on or cartesian_on";
// rs274 of LinuxCNC 2.9 takes 252 characters and says "Command too long" from 253 on, comments included.
constexpr size_t kLongestLine = 250;
class LinuxCncReader : public ProgramReader {
 public:
  LinuxCncReader(const ProgramFiles& files, const Arm& arm, const PostSettings& settings,
                 const LinuxCncOptions& options)
      : ProgramReader(
            files, settings,
            Templates(LinuxCncTexts(settings), settings.texts, ToolOf(settings), {.blanks = false})),
        arm_(arm),
        options_(options) {
    program_.rotation = settings.rotation;
    program_.R_TC = settings.R_TC();
    for (const ControllerAxis& axis : settings.controller_axes) axes_ += axis.name;
    program_.blend_overlaps = true;
    if (options.cartesian) program_.X_BP = Pose::Identity();  // poses are stated in the robot's base
  }

 private:
  /// A line that is one comment: "(a) G1 (b)" is code between two.
  std::optional<std::string_view> Comment(std::string_view line) const override {
    const bool bracketed = line.starts_with('(') && line.find(')') == line.size() - 1;
    return bracketed ? std::optional(line.substr(1, line.size() - 2)) : ProgramReader::Comment(line);
  }

  /// ';' begins a comment where it does not stand in one.
  std::string_view WithoutComment(std::string_view line) const override {
    bool inside = false;
    for (size_t i = 0; i < line.size(); ++i) {
      if (line[i] == ';' && !inside) return line.substr(0, i);
      if (line[i] == '(') inside = true;
      if (line[i] == ')') inside = false;
    }
    return line;
  }

  void ReadComment(std::string_view comment) override {
    // rs274 shows what stands behind "MSG,".
    if (InHead() && comment == fmt::format("MSG, {}", kCompensatedNotice)) {
      program_.notice = kCompensatedNotice;
      return;
    }
    LineScanner scan(comment, "", 0);
    const bool begin = scan.Accept("PASS");
    if (!begin && !scan.Accept("END OF PASS")) {
      ReadMessage(comment);
      return ProgramReader::ReadComment(comment);
    }
    ReadPassMark(scan, begin);
  }

  /// Comments that the interpreter acts on begin with one of these words and a comma.
  void ReadMessage(std::string_view comment) {
    LineScanner scan(comment, "", 0);
    for (const std::string_view word : {"MSG", "DEBUG", "PRINT", "LOG", "LOGOPEN", "LOGAPPEND", "LOGCLOSE",
                                        "PROBEOPEN", "PROBECLOSE", "PY", "ABORT"}) {
      if (scan.Accept(word) && (scan.Peek() == ',' || scan.AtEnd()))
        return AddHandEvent(ProgramEvent::Kind::kMessage, comment);
    }
  }

  std::vector<std::string> Needed() const override {
    std::vector<std::string> needed = {"G21", "G40", "G49", "G90", no_offsets_, "G59.3", "G92.1", kPathMode};
    if (options_.cartesian) needed.emplace_back(kKinematics);
    return needed;
  }

  size_t LongestLine() const override { return kLongestLine; }
  void BeginFile() override { percent_ = false; }
  bool MayFollowEnd(std::string_view line) const override { return percent_ && line == "%"; }

  void Forgotten() override {
    feed_.reset();
    motion_ = -1;
    rounds_ = false;
    inverse_time_.reset();
    last_.reset();
    external_known_ = false;
  }

  void TextRead(const std::string& name) override {
    if (name != "cartesian_on" && name != "joints_on") return;
    cartesian_ = name == "cartesian_on";
    Stated(kKinematics);
    last_.reset();
  }

  void ReadCode(LineScanner& scan) override {
    const size_t start = scan.Next();
    if (scan.Accept("%")) return ReadPercent(scan, start);
    if (scan.AcceptAddress('N')) scan.ExpectDecimal(kLinuxCncBlanks);
    LinuxCncBlock block;
    while (!scan.AtEnd()) {
      if (scan.Peek() == '(') {
        SkipComment(scan);
      } else if (!InText() || !ReadTextWord(scan)) {
        ReadWord(scan, block);
      }
    }
    Apply(scan, start, block);
  }

  /// A pair of % may enclose a program: its first line and the last one.
  void ReadPercent(LineScanner& scan, size_t start) {
    scan.ExpectEnd();
    if (scan.number() != 1 && !percent_) scan.FailFrom(start, "% in the first line of the file expected");
    if (scan.number() != 1) EndFile();
    percent_ = true;
  }

  /// Comments do not nest.
  void SkipComment(LineScanner& scan) {
    scan.Expect("(");
    const size_t start = scan.Next();
    while (scan.Peek() != ')' && scan.Peek() != '\0') {
      if (scan.Peek() == '(') scan.Fail("a comment without another one in it expected");
      scan.Skip();
    }
    ReadMessage(scan.TakenFrom(start));
    scan.Expect(")");
  }

  void ReadWord(LineScanner& scan, LinuxCncBlock& block) {
    const size_t start = scan.Next();
    std::string arguments;
    if (const auto name = AcceptLinuxCncCall(scan, arguments)) {
      if (!ReadDeclaredCall(scan, start, *name, arguments))
        scan.FailFrom(start, "a call that the cell declares expected");
      block.calls = true;
      return;
    }
    if (scan.AcceptAddress('G')) return block.AddG(scan, start, scan.ExpectDecimal(kLinuxCncBlanks));
    if (scan.AcceptAddress('M')) return block.AddM(scan, start, scan.ExpectDecimal(kLinuxCncBlanks));
    if (block.AcceptWord(scan, axes_ + "FPQLR")) return;
    scan.Fail("a word of a milling program expected");
  }

  /// Spindle, coolant, outputs, waits: what a text of the cell may switch.
  bool ReadTextWord(LineScanner& scan) override {
    LineScanner ahead = scan;
    if (ahead.AcceptAddress('M')) {
      const double code = ahead.ExpectDecimal(kLinuxCncBlanks);
      for (const double known : {3, 4, 5, 6, 7, 8, 9, 62, 63, 64, 65, 66, 67, 68}) {
        if (code != known) continue;
        scan = ahead;
        return true;
      }
    }
    for (const char letter : {'S', 'T', 'E', 'L', 'P', 'Q'}) {
      if (!scan.AcceptAddress(letter)) continue;
      scan.ExpectDecimal(kLinuxCncBlanks);
      return true;
    }
    return false;
  }

  /// In the order in which the interpreter carries a block out: feed mode, feed, outputs, dwell, settings,
  /// motion, end.
  void Apply(const LineScanner& scan, size_t start, const LinuxCncBlock& block) {
    CheckParameters(scan, start, block);
    FeedMode(block);
    if (const auto feed = block.Word('F'); feed && inverse_time_ != true) feed_ = *feed;
    for (const double m : block.m) Miscellaneous(scan, start, m, block);
    for (const double g : block.g) Setting(scan, start, g, block);
    if (inverse_time_ == true && block.HasG(1) && !block.Has('F'))
      scan.FailFrom(start, "G93 needs F in every block with G1");
    const bool moves = std::ranges::any_of(axes_, [&](char c) { return block.Has(c); });
    if (moves && !block.HasG(10)) Move(scan, block);
    if (block.HasM(2) || block.HasM(30)) EndFile();
  }

  /// Words that belong to a code must not stand without it: the interpreter stops there.
  void CheckParameters(const LineScanner& scan, size_t start, const LinuxCncBlock& block) const {
    const bool output = block.HasM(62) || block.HasM(63);
    const auto number = block.Word('P');
    if (output && (!number || *number < 0 || *number != std::floor(*number)))
      scan.FailFrom(start, "P and the whole number of an output expected");
    if (block.HasG(4) && !InText() && (!number || *number < 0))
      scan.FailFrom(start, "G4 needs P and 0 or more seconds");
    const int uses =
        (output ? 1 : 0) + (block.HasG(4) ? 1 : 0) + (block.HasG(10) ? 1 : 0) + (block.HasG(64) ? 1 : 0);
    if (block.Has('P') && uses != 1) scan.FailFrom(start, "P for one of G4, G10, G64, M62 and M63 expected");
    if (block.Has('Q') && !block.HasG(64)) scan.FailFrom(start, "Q with G64 alone expected");
    if ((block.Has('L') || block.Has('R')) && !block.HasG(10))
      scan.FailFrom(start, "L and R with G10 alone expected");
  }

  /// G94 sets the feed to 0, also where it holds already.
  void FeedMode(const LinuxCncBlock& block) {
    if (!block.HasG(93) && !block.HasG(94)) return;
    inverse_time_ = block.HasG(93);
    Stated(kFeedMode);
    feed_.reset();
  }

  void Miscellaneous(const LineScanner& scan, size_t start, double m, const LinuxCncBlock& block) {
    if (m == 0 || m == 1) {
      Allow(scan, start, kOutsideCuts);
      AddHandEvent(ProgramEvent::Kind::kStop, fmt::format("M{}", m));
    }
    if (m == 62 || m == 63) AddOutput({static_cast<int>(*block.Word('P')), m == 62, 0, true});
  }

  void Setting(const LineScanner& scan, size_t start, double g, const LinuxCncBlock& block) {
    if (g == 0 || g == 1) {
      motion_ = static_cast<int>(g);
    } else if (g == 61 || g == 61.1) {
      rounds_ = false;
      Stated(kPathMode);
    } else if (g == 64) {
      Rounding(scan, start, block);
    } else if (g == 10) {
      NoOffsets(scan, start, block);
    } else if (g == 4) {
      ReadDwell(scan, start, block.Word('P').value_or(0));
    } else {
      // Coordinate systems and tool lengths wait for the motion to end; the rest changes nothing.
      if (g == 49 || g == 59.3 || g == 92.1) Allow(scan, start, kOutsideCuts);
      Stated(fmt::format("G{}", g));
    }
  }

  /// G64 P Q: without P corners are rounded without bound, without Q0 nearly straight points are left out by
  /// up to P.
  void Rounding(const LineScanner& scan, size_t start, const LinuxCncBlock& block) {
    const auto bound = block.Word('P'), merged = block.Word('Q');
    if (!bound || *bound <= 0)
      scan.FailFrom(start, "G64 needs P above 0: without it corners are rounded without bound");
    if (!merged || *merged != 0)
      scan.FailFrom(start, "G64 needs Q0: else points are left out where the path is nearly straight");
    blend_ = *bound;
    rounds_ = true;
    Stated(kPathMode);
    Allow(scan, start, kAtStops);
  }

  void NoOffsets(const LineScanner& scan, size_t start, const LinuxCncBlock& block) {
    std::map<char, double> wanted = {{'L', 2}, {'P', 9}, {'R', 0}};
    for (const char letter : axes_) wanted[letter] = 0;
    if (block.words != wanted || block.g.size() != 1 || !block.m.empty())
      scan.FailFrom(start, fmt::format("{} expected", no_offsets_));
    Stated(no_offsets_);
    Allow(scan, start, kOutsideCuts);
  }

  void Move(const LineScanner& scan, const LinuxCncBlock& block) {
    if (motion_ < 0) scan.Fail("G0 or G1 before words of axes expected");
    if (motion_ == 0 && rounds_) scan.Fail("ways between cuts keep to their path: G61.1 before G0 expected");
    const ExternalPosition before = external_;
    MoveExternal(scan, block);
    if (cartesian_) {
      AddPose(scan, block, before);
    } else {
      AddTarget(scan, block, before);
    }
  }

  /// In cuts they move along as joints, or where the kinematics counts in them.
  void MoveExternal(const LineScanner& scan, const LinuxCncBlock& block) {
    for (const ControllerAxis& axis : settings_.controller_axes) {
      const auto word = block.Word(axis.name.front());
      if (!word && external_known_) continue;
      if (!word) scan.Fail(fmt::format("{} is missing in the first motion", axis.name));
      if (motion_ != 0 && (!external_known_ || (cartesian_ && !axis.coupled)))
        scan.Fail(fmt::format("{} moves with G0 alone{}", axis.name,
                              external_known_
                                  ? ": the kinematics does not count in it (coupled: false in the cell)"
                                  : " before it is known where it stands"));
      SetValue(settings_, axis, *word, external_);
    }
    external_known_ = true;
  }

  /// The six words as they hold: those of this block, else the last ones.
  Joints Complete(const LineScanner& scan, const LinuxCncBlock& block) const {
    Joints values = last_.value_or(Joints::Zero());
    for (int i = 0; i < 6; ++i) {
      const auto word = block.Word("XYZABC"[i]);
      if (word) values[i] = *word;
      if (!word && !last_) scan.Fail(fmt::format("{} is missing in the first motion", "XYZABC"[i]));
    }
    return values;
  }

  /// The joints (degrees) where the arm stands; also behind a call, which leaves them where it is said to.
  std::optional<Joints> SourceLocation() const {
    if (last_) return last_;
    if (program_.motions.empty() || !program_.motions.back().q) return std::nullopt;
    return settings_.axes.FromArm(*program_.motions.back().q) * kDegPerRad;
  }

  /// What U, V, W move by in this block.
  Eigen::Vector3d ExternalWay(const ExternalPosition& before) const {
    return ExternalWords(settings_, external_) - ExternalWords(settings_, before);
  }

  void AddTarget(const LineScanner& scan, const LinuxCncBlock& block,
                 const ExternalPosition& external_before) {
    const Joints angles = Complete(scan, block);
    const std::optional<Joints> before = SourceLocation();
    if (motion_ == 1 && !before) scan.Fail("G0 expected: where this motion begins is not known");
    Motion& motion = AddMotion(MotionType::kJoint);
    motion.q = settings_.axes.ToArm(angles * kRadPerDeg);
    motion.exact = !rounds_;
    if (rounds_) {
      motion.blend = settings_.blend * blend_ / BlendDegrees(settings_.blend, arm_, settings_.X_FT);
      motion.angle_blend = blend_ * kRadPerDeg;
    }
    if (motion_ == 1) Require(kFeedMode);
    if (motion_ == 1)
      motion.duration =
          Duration(scan, FeedLength(*before, angles, ExternalWay(external_before)), block.Word('F'));
    last_ = angles;
  }

  /// A pose of the tool in the robot's base, mm and degrees.
  void AddPose(const LineScanner& scan, const LinuxCncBlock& block, const ExternalPosition& external_before) {
    const Joints values = Complete(scan, block);
    if (motion_ == 0) scan.Fail("tool poses are approached at a feed: G1 expected");
    const bool moves = !last_ || (values - *last_).head<3>().norm() > 0;
    Require(kFeedMode);
    if (!last_ && inverse_time_ == true) scan.Fail("the first pose of a cut at a feed expected: G94");
    Motion& motion = AddMotion(MotionType::kLinear);
    motion.angles = values.tail<3>() * kRadPerDeg;
    motion.X_PT.translation() = values.head<3>();
    motion.X_PT.linear() = FromToolAngles(settings_.rotation, *motion.angles) * settings_.R_TC().transpose();
    if (!external_.empty()) motion.X_BP = FromCounted(settings_, external_, Pose::Identity());
    if (external_ != external_before)
      motion.X_BP_begin = FromCounted(settings_, external_before, Pose::Identity());
    motion.exact = !rounds_;
    motion.blend = rounds_ ? blend_ : 0;
    const double length = last_ ? FeedLength(*last_, values, ExternalWay(external_before)) : 0;
    if (moves && inverse_time_ != true) {
      if (!feed_ || *feed_ <= 0) scan.Fail("G1 needs F");
      motion.feed = *feed_ / 60;
    } else {
      motion.duration = Duration(scan, length, block.Word('F'));
      if (moves) motion.feed = length / std::exchange(motion.duration, 0);
    }
    last_ = values;
  }

  /// s, as the interpreter makes it of F.
  double Duration(const LineScanner& scan, double length, std::optional<double> feed) const {
    if (length == 0) return 0;
    if (inverse_time_ == true) {
      if (!feed || *feed <= 0) scan.Fail("G93 needs F in every block");
      return length / std::max(length * *feed, kInverseTimeFloor) * 60;
    }
    if (!feed_ || *feed_ <= 0) scan.Fail("G1 needs F");
    return length / *feed_ * 60;
  }

  const Arm& arm_;
  const LinuxCncOptions& options_;
  const std::string no_offsets_ = millpose::NoOffsets(settings_);
  std::string axes_ = "XYZABC";  // letters of all axes
  bool external_known_ = false;  // where the external axes stand
  std::optional<Joints> last_;   // degrees, or mm and degrees of a tool pose
  std::optional<double> feed_;   // per minute, G94
  double blend_ = 0;             // degrees; mm of tool poses
  bool cartesian_ = false;       // tool poses, not joints
  int motion_ = -1;              // of G0 and G1 the one that holds; −1: unknown
  std::optional<bool> inverse_time_;
  bool rounds_ = false;
  bool percent_ = false;  // the file began with %
};

}  // namespace

std::vector<Problem> LinuxCncPost::CheckTexts(const Arm& arm, const PostSettings& settings) const {
  return LinuxCncReader({}, arm, settings, options_).CheckTexts();
}

MotionProgram LinuxCncPost::Read(const ProgramFiles& files, const Arm& arm,
                                 const PostSettings& settings) const {
  return LinuxCncReader(files, arm, settings, options_).Read(Endings());
}

}  // namespace millpose
