// SPDX-License-Identifier: GPL-3.0-or-later
// Reads SINUMERIK programs as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/scanner.hpp"
#include "program/sinumerik.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

/// What one block programs.
struct Block {
  std::array<std::optional<double>, 6> pose;  ///< X, Y, Z mm, A, B, C degrees
  std::array<std::optional<double>, 6> axes;  ///< degrees
  std::optional<int> status, turn;
  bool exact = false;
  bool dwell = false;

  bool HasPose() const {
    return std::any_of(pose.begin(), pose.end(), [](const auto& word) { return word.has_value(); });
  }
  bool HasAxes() const {
    return std::any_of(axes.begin(), axes.end(), [](const auto& word) { return word.has_value(); });
  }
};

class SinumerikReader {
 public:
  SinumerikReader(const PostSettings& settings, const std::string& file)
      : settings_(settings), file_(file), templates_(SinumerikTexts(), settings.texts) {
    program_.name = file.substr(0, file.rfind('.'));
    program_.axes = settings.axes;
    program_.files = {file};
  }

  MotionProgram Read(std::string_view text) {
    lines_ = SplitLines(text);
    for (size_t i = 0; i < lines_.size();) {
      try {
        i += ReadAt(i);
      } catch (const InputError& error) {
        problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
        ++i;
      }
    }
    if (!ended_) problems_.push_back({{file_, static_cast<int>(lines_.size()), 0, -1}, "M30 is missing"});
    if (!problems_.empty()) throw InputError(problems_);
    return std::move(program_);
  }

 private:
  size_t ReadAt(size_t i) {
    line_ = static_cast<int>(i) + 1;
    if (const auto match = templates_.Recognise(lines_, i)) {
      AddEvent(match->kind, match->value, 0);
      return match->lines;
    }
    const std::string_view line = Trim(lines_[i]);
    if (line.starts_with(';')) {
      ReadComment(line.substr(1));
    } else if (!line.empty()) {
      LineScanner scan(lines_[i].substr(0, lines_[i].find(';')), file_, line_);
      if (ended_) scan.Fail("nothing expected after M30");
      ReadBlock(scan);
      in_head_ = false;
    }
    return 1;
  }

  void ReadComment(std::string_view comment) {
    const size_t colon = comment.find(": ");
    if (!in_head_ || colon == std::string_view::npos) return;
    const std::string_view key = Trim(comment.substr(0, colon));
    if (key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") != std::string_view::npos) return;
    program_.header.emplace_back(key, Trim(comment.substr(colon + 2)));
  }

  void ReadBlock(LineScanner& scan) {
    AcceptAddress(scan, 'N');
    Block block;
    while (!scan.AtEnd()) {
      if (!ReadMove(scan, block) && !ReadStatement(scan, block)) {
        scan.Fail("a word of a milling program expected");
      }
    }
    if (block.HasAxes()) {
      AddAxes(scan, block);
    } else if (block.HasPose()) {
      AddPose(scan, block);
    }
  }

  /// A letter directly followed by a number (X1.5) or by '=' and a number (A=1.5).
  static std::optional<double> AcceptAddress(LineScanner& scan, char letter) {
    if (!scan.AcceptAddress(letter)) return std::nullopt;
    scan.Accept("=");
    return scan.ExpectNumber();
  }

  bool ReadMove(LineScanner& scan, Block& block) {
    for (int i = 0; i < 6; ++i) {
      if (scan.Accept(settings_.axis_names[i])) {
        scan.Expect("=");
        block.axes[i] = scan.ExpectNumber();
        return true;
      }
    }
    for (int i = 0; i < 6; ++i) {
      if (const auto value = AcceptAddress(scan, "XYZABC"[i])) {
        if (block.pose[i]) scan.Fail(fmt::format("{} is given twice", "XYZABC"[i]));
        block.pose[i] = value;
        return true;
      }
    }
    if (scan.Accept("STAT=")) {
      block.status = scan.ExpectBits();
    } else if (scan.Accept("TU=")) {
      block.turn = scan.ExpectBits();
    } else if (scan.Accept("PTP")) {
      ptp_ = true;
    } else if (scan.Accept("CP")) {
      ptp_ = false;
    } else {
      return false;
    }
    return true;
  }

  bool ReadStatement(LineScanner& scan, Block& block) {
    if (scan.Accept("TRAORI")) {
      transformed_ = true;
    } else if (scan.Accept("TRAFOOF")) {
      transformed_ = false;
    } else if (scan.Accept("CYCLE832")) {
      scan.Expect("(");
      blend_ = scan.ExpectNumber();
      scan.Expect(",");
      if (!scan.Accept("_FINISH")) scan.Expect("_OFF");
      scan.Expect(",");
      scan.ExpectNumber();
      scan.Expect(")");
    } else if (scan.Accept("MSG")) {
      ReadMessage(scan);
    } else if (scan.Accept("$P_UIFR[1]")) {
      ReadFrame(scan);
    } else if (scan.Accept("T=\"")) {
      const auto tool = scan.AcceptName();
      if (tool != settings_.tool_name) scan.Fail(fmt::format("tool {} expected", settings_.tool_name));
      scan.Expect("\"");
    } else if (scan.Accept("ORIWKS")) {
    } else if (const auto feed = AcceptAddress(scan, 'F')) {
      if (!block.dwell) feed_ = *feed / 60;
    } else if (const auto g = AcceptAddress(scan, 'G')) {
      ReadG(scan, *g, block);
    } else if (const auto m = AcceptAddress(scan, 'M')) {
      ended_ = *m == 30;
      if (*m != 30 && *m != 6 && *m != 0 && *m != 1) scan.Fail("M0, M1, M6 or M30 expected");
    } else {
      return AcceptAddress(scan, 'D').has_value();
    }
    return true;
  }

  void ReadG(LineScanner& scan, double g, Block& block) {
    static const std::vector<double> allowed = {17, 40, 54, 90, 94, 642, 710};
    if (g == 0 || g == 1) {
      rapid_ = g == 0;
    } else if (g == 9) {
      block.exact = true;
    } else if (g == 4) {
      block.dwell = true;
    } else if (std::find(allowed.begin(), allowed.end(), g) == allowed.end()) {
      scan.Fail("G0, G1, G4, G9, G17, G40, G54, G90, G94, G642 or G710 expected");
    }
  }

  void ReadMessage(LineScanner& scan) {
    scan.Expect("(");
    if (scan.Accept(")")) return;
    scan.Expect("\"");
    const bool begin = scan.Accept("PASS");
    if (begin || scan.Accept("END OF PASS")) {
      const int pass = static_cast<int>(scan.ExpectNumber());
      scan.Expect("PIECE");
      AddEvent(begin ? ProgramEvent::Kind::kPassBegin : ProgramEvent::Kind::kPassEnd, pass,
               static_cast<int>(scan.ExpectNumber()));
      pass_ = begin ? pass : -1;
    }
    while (scan.Peek() != '"' && scan.Peek() != '\0') scan.Skip();
    scan.Expect("\"");
    scan.Expect(")");
  }

  Eigen::Vector3d ReadTriple(LineScanner& scan, std::string_view function) {
    scan.Expect(function);
    scan.Expect("(");
    Eigen::Vector3d values;
    for (int i = 0; i < 3; ++i) {
      if (i) scan.Expect(",");
      scan.Expect(std::string(1, "XYZ"[i]));
      scan.Expect(",");
      values[i] = scan.ExpectNumber();
    }
    scan.Expect(")");
    return values;
  }

  void ReadFrame(LineScanner& scan) {
    if (posed_) scan.Fail("one frame for all poses of the program expected");
    scan.Expect("=");
    Pose X_BP = Pose::Identity();
    X_BP.translation() = ReadTriple(scan, "CTRANS");
    scan.Expect(":");
    X_BP.linear() = FromAnglesZyx(ReadTriple(scan, "CROT").reverse() * kRadPerDeg);
    program_.X_BP = X_BP;
  }

  void AddAxes(const LineScanner& scan, const Block& block) {
    if (transformed_)
      scan.Fail("axes cannot be moved by themselves while TRAORI holds: TRAFOOF expected before");
    if (!rapid_) scan.Fail("axes are moved with G0 here, G1");
    Joints angles;
    for (int i = 0; i < 6; ++i) {
      if (!block.axes[i]) scan.Fail(fmt::format("{} is missing", settings_.axis_names[i]));
      angles[i] = *block.axes[i] * kRadPerDeg;
    }
    Motion& motion = AddMotion(MotionType::kJoint);
    motion.q = FromController(settings_.axes, angles);
    motion.exact = true;
    last_ = {};
  }

  void AddPose(const LineScanner& scan, const Block& block) {
    const bool first = !std::exchange(posed_, true);
    if (first && !program_.X_BP) scan.Fail("$P_UIFR[1] must be set before the first pose");
    if (!transformed_) scan.Fail("a pose can only be approached while TRAORI holds");
    for (int i = 0; i < 6; ++i) {
      if (block.pose[i]) last_[i] = block.pose[i];
      if (!last_[i]) scan.Fail(fmt::format("{} is missing", "XYZABC"[i]));
    }
    if (rapid_ && !ptp_) scan.Fail("G0 without PTP: the path to the pose is not defined; PTP expected");
    Motion& motion = AddMotion(ptp_ ? MotionType::kJoint : MotionType::kLinear);
    motion.X_PT.translation() = Eigen::Vector3d(*last_[0], *last_[1], *last_[2]);
    const Eigen::Vector3d abc(*last_[3], *last_[4], *last_[5]);
    motion.X_PT.linear() =
        FromSinumerikAngles(settings_.rotation, abc * kRadPerDeg) * settings_.R_TC.transpose();
    motion.exact = ptp_ || block.exact;
    if (ptp_) {
      motion.status = block.status;
      motion.turn = block.turn;
    } else {
      motion.feed = feed_;
      motion.blend = motion.exact ? 0 : blend_;
    }
  }

  Motion& AddMotion(MotionType type) {
    Motion& motion = program_.motions.emplace_back();
    motion.type = type;
    motion.pass = pass_;
    motion.line = line_;
    return motion;
  }

  void AddEvent(ProgramEvent::Kind kind, double value, int piece) {
    program_.events.push_back({kind, program_.motions.size(), value, piece, 0, line_});
  }

  const PostSettings& settings_;
  std::string file_;
  Templates templates_;
  MotionProgram program_;
  std::vector<std::string_view> lines_;
  std::vector<Problem> problems_;
  std::array<std::optional<double>, 6> last_;  // X, Y, Z, A, B, C as they hold
  double feed_ = 0;                            // mm/s
  double blend_ = 0;                           // mm
  bool transformed_ = false, rapid_ = true, ptp_ = false;
  int pass_ = -1;
  int line_ = 0;
  bool posed_ = false;  // a pose was approached
  bool in_head_ = true;
  bool ended_ = false;
};

}  // namespace

MotionProgram SinumerikPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  const auto source =
      std::find_if(files.begin(), files.end(), [](const auto& file) { return file.first.ends_with(".mpf"); });
  if (source == files.end()) throw InputError(Place{}, "a SINUMERIK program needs an .mpf file");
  return SinumerikReader(settings, source->first).Read(source->second);
}

}  // namespace millpose
