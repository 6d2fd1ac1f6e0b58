// SPDX-License-Identifier: GPL-3.0-or-later
// Reads RS-274/NGC as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/linuxcnc.hpp"
#include "program/reader.hpp"

namespace millpose {
namespace {

constexpr const char* kPathMode = "G61, G61.1 or G64";
constexpr const char* kFeedMode = "G93 or G94";
constexpr const char* kKinematics = "the cell's text joints_on or cartesian_on";

class LinuxCncReader : public ProgramReader {
 public:
  LinuxCncReader(const ProgramFiles& files, const Arm& arm, const PostSettings& settings)
      : ProgramReader(files, settings, Templates(LinuxCncTexts(), settings.texts, settings.tool_name)),
        arm_(arm) {
    program_.rotation = settings.rotation;
    program_.R_TC = settings.R_TC;
    program_.blend_overlaps = true;
    if (settings.cartesian) program_.X_BP = Pose::Identity();  // poses are stated in the robot's base
  }

 private:
  std::optional<std::string_view> Comment(std::string_view line) const override {
    const bool bracketed = line.starts_with('(') && line.ends_with(')');
    return bracketed ? std::optional(line.substr(1, line.size() - 2)) : ProgramReader::Comment(line);
  }

  void ReadComment(std::string_view comment) override {
    LineScanner scan(comment, "", 0);
    const bool begin = scan.Accept("PASS");
    if (!begin && !scan.Accept("END OF PASS")) return ProgramReader::ReadComment(comment);
    ReadPassMark(scan, begin);
  }

  std::vector<std::string> Needed() const override {
    std::vector<std::string> needed = {"G21", "G40", "G49", "G90", kNoOffsets, "G59.3", "G92.1", kPathMode};
    if (settings_.cartesian) needed.emplace_back(kKinematics);
    return needed;
  }

  void Forgotten() override {
    last_.reset();
    feed_.reset();
  }

  void TextRead(const std::string& name) override {
    if (name != "cartesian_on" && name != "joints_on") return;
    cartesian_ = name == "cartesian_on";
    Stated(kKinematics);
    last_.reset();
  }

  void ReadCode(LineScanner& scan) override {
    std::array<std::optional<double>, 6> words;
    std::optional<double> feed, pause;
    bool dwell = false, moves = false, rounds = false;
    if (scan.AcceptAddress('N')) scan.ExpectNumber();
    if (scan.Accept(kNoOffsets)) {
      Stated(kNoOffsets);
      return scan.ExpectEnd();
    }
    while (!scan.AtEnd()) {
      const size_t start = scan.Next();
      if (InText() && ReadTextWord(scan)) continue;
      if (const auto name = AcceptCall(scan)) {
        if (!ReadDeclaredCall(scan, start, *name))
          scan.FailFrom(start, "a call that the cell declares expected");
      } else if (scan.Accept("(")) {
        SkipComment(scan);
      } else if (scan.AcceptAddress('G')) {
        const double g = scan.ExpectNumber();
        dwell = dwell || g == 4;
        rounds = rounds || g == 64;
        ReadG(scan, g, start);
      } else if (scan.AcceptAddress('F')) {
        feed = scan.ExpectNumber();
      } else if (scan.AcceptAddress('P')) {
        pause = scan.ExpectNumber();
      } else if (scan.AcceptAddress('Q')) {
        scan.ExpectNumber();
      } else if (scan.AcceptAddress('M')) {
        const double m = scan.ExpectNumber();
        if (m == 2 || m == 30) {
          EndFile();
        } else if (m == 62 || m == 63) {
          if (!scan.AcceptAddress('P')) scan.Fail("P and the number of an output expected");
          AddOutput({static_cast<int>(scan.ExpectNumber()), m == 62, 0, true});
        } else if (m != 0 && m != 1) {
          scan.FailFrom(start,
                        "M0, M1, M2, M30, M62 or M63 expected (spindle and coolant: the cell's texts)");
        }
      } else {
        moves = ReadAxis(scan, words) || moves;
      }
    }
    if (rounds) {
      if (!pause || *pause <= 0)
        scan.Fail("G64 needs P above 0: without it corners are rounded without bound");
      blend_ = *pause;
    }
    if (feed && !inverse_time_) feed_ = *feed;
    if (moves && cartesian_) AddPose(scan, words, feed);
    if (moves && !cartesian_) AddTarget(scan, words, feed);
  }

  /// Spindle, coolant, outputs, waits: what a text of the cell may switch.
  bool ReadTextWord(LineScanner& scan) override {
    for (const std::string_view word :
         {"M3", "M4", "M5", "M7", "M8", "M9", "M62", "M63", "M64", "M65", "M66", "M67", "M68"}) {
      if (scan.Accept(word)) return true;
    }
    for (const char letter : {'S', 'E', 'L'}) {
      if (!scan.AcceptAddress(letter)) continue;
      scan.ExpectNumber();
      return true;
    }
    return false;
  }

  /// O<name> CALL [1] [2], or a user's M101: the name.
  static std::optional<std::string> AcceptCall(LineScanner& scan) {
    if (scan.Accept("O<")) {
      auto name = scan.AcceptName();
      if (!name) scan.Fail("the name of a program expected");
      scan.Expect(">");
      scan.Expect("CALL");
      while (scan.Accept("[")) {
        scan.ExpectNumber();
        scan.Expect("]");
      }
      return name;
    }
    for (int code = 100; code < 200; ++code) {
      const std::string word = fmt::format("M{}", code);
      if (scan.Accept(word)) return word;
    }
    return std::nullopt;
  }

  static void SkipComment(LineScanner& scan) {
    while (scan.Peek() != ')' && scan.Peek() != '\0') scan.Skip();
    scan.Expect(")");
  }

  bool ReadAxis(LineScanner& scan, std::array<std::optional<double>, 6>& words) {
    for (int i = 0; i < 6; ++i) {
      if (!scan.AcceptAddress("XYZABC"[i])) continue;
      if (words[i]) scan.Fail(fmt::format("{} is given twice", "XYZABC"[i]));
      words[i] = scan.ExpectNumber();
      return true;
    }
    scan.Fail("a word of a milling program expected");
  }

  void ReadG(const LineScanner& scan, double g, size_t start) {
    static const std::vector<double> neutral = {4, 17, 21, 40, 49, 59.3, 90, 92.1};
    Stated(fmt::format("G{}", g));
    if (g == 0 || g == 1) {
      rapid_ = g == 0;
    } else if (g == 93 || g == 94) {
      inverse_time_ = g == 93;
      Stated(kFeedMode);
      feed_.reset();
    } else if (g == 64 || g == 61.1 || g == 61) {
      blending_ = g == 64;
      Stated(kPathMode);
    } else if (std::find(neutral.begin(), neutral.end(), g) == neutral.end()) {
      scan.FailFrom(
          start, "G0, G1, G4, G17, G21, G40, G49, G59.3, G61, G61.1, G64, G90, G92.1, G93 or G94 expected");
    }
  }

  /// The six words as they hold: those of this block, else the last ones.
  Joints Complete(const LineScanner& scan, const std::array<std::optional<double>, 6>& words) const {
    Joints values = last_.value_or(Joints::Zero());
    for (int i = 0; i < 6; ++i) {
      if (words[i]) values[i] = *words[i];
      if (!words[i] && !last_) scan.Fail(fmt::format("{} is missing in the first motion", "XYZABC"[i]));
    }
    return values;
  }

  void AddTarget(const LineScanner& scan, const std::array<std::optional<double>, 6>& words,
                 std::optional<double> feed) {
    const Joints angles = Complete(scan, words);
    Motion& motion = AddMotion(MotionType::kJoint);
    motion.q = FromController(settings_.axes, angles * kRadPerDeg);
    motion.exact = !blending_;
    if (blending_) {
      motion.blend = settings_.blend * blend_ / BlendDegrees(settings_.blend, arm_, settings_.X_FT);
      motion.angle_blend = blend_ * kRadPerDeg;
    }
    if (!rapid_) Require(kFeedMode);
    if (!rapid_) motion.duration = Duration(scan, last_ ? FeedLength(*last_, angles) : 0, feed);
    last_ = angles;
  }

  /// A pose of the tool in the robot's base, mm and degrees.
  void AddPose(const LineScanner& scan, const std::array<std::optional<double>, 6>& words,
               std::optional<double> feed) {
    const Joints values = Complete(scan, words);
    if (rapid_) scan.Fail("tool poses are approached at a feed: G1 expected");
    Require(kFeedMode);
    const bool moves = !last_ || (values - *last_).head<3>().norm() > 0;
    if (!last_ && inverse_time_) scan.Fail("the first pose of a cut at a feed expected: G94");
    Motion& motion = AddMotion(MotionType::kLinear);
    motion.angles = values.tail<3>() * kRadPerDeg;
    motion.X_PT.translation() = values.head<3>();
    motion.X_PT.linear() = FromToolAngles(settings_.rotation, *motion.angles) * settings_.R_TC.transpose();
    motion.exact = !blending_;
    motion.blend = blending_ ? blend_ : 0;
    const double length = last_ ? FeedLength(*last_, values) : 0;
    if (moves && !inverse_time_) {
      if (!feed_ || *feed_ <= 0) scan.Fail("G1 needs F");
      motion.feed = *feed_ / 60;
    } else {
      motion.duration = Duration(scan, length, feed);
      if (moves) motion.feed = length / std::exchange(motion.duration, 0);
    }
    last_ = values;
  }

  /// s, as the interpreter makes it of F.
  double Duration(const LineScanner& scan, double length, std::optional<double> feed) const {
    if (length == 0) return 0;
    if (inverse_time_) {
      if (!feed || *feed <= 0) scan.Fail("G93 needs F in every block");
      return length / std::max(length * *feed, kInverseTimeFloor) * 60;
    }
    if (!feed_ || *feed_ <= 0) scan.Fail("G1 needs F");
    return length / *feed_ * 60;
  }

  const Arm& arm_;
  std::optional<Joints> last_;  // degrees, or mm and degrees of a tool pose
  std::optional<double> feed_;  // per minute, G94
  double blend_ = 0;            // degrees; mm of tool poses
  bool cartesian_ = false;      // tool poses, not joints
  bool rapid_ = true, inverse_time_ = false, blending_ = true;
};

}  // namespace

std::vector<Problem> LinuxCncPost::CheckTexts(const Arm& arm, const PostSettings& settings) const {
  return LinuxCncReader({}, arm, settings).CheckTexts();
}

MotionProgram LinuxCncPost::Read(const ProgramFiles& files, const Arm& arm,
                                 const PostSettings& settings) const {
  return LinuxCncReader(files, arm, settings).Read({".ngc"});
}

}  // namespace millpose
