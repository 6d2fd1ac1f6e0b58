// SPDX-License-Identifier: GPL-3.0-or-later
// Reads RS-274/NGC as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/linuxcnc.hpp"
#include "program/scanner.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

class LinuxCncReader {
 public:
  LinuxCncReader(const Arm& arm, const PostSettings& settings, const std::string& file)
      : arm_(arm), settings_(settings), file_(file), templates_(LinuxCncTexts(), settings.texts) {
    program_.name = file.substr(0, file.rfind('.'));
    program_.axes = settings.axes;
    program_.files = {file};
  }

  MotionProgram Read(std::string_view text) {
    lines_ = SplitLines(text);
    for (size_t i = 0; i < lines_.size() && !ended_;) {
      try {
        i += ReadAt(i);
      } catch (const InputError& error) {
        problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
        ++i;
      }
    }
    if (!ended_) problems_.push_back({{file_, static_cast<int>(lines_.size()), 0, -1}, "M2 is missing"});
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
    } else if (!line.empty() && !(line.starts_with('(') && line.ends_with(')'))) {
      LineScanner scan(lines_[i].substr(0, lines_[i].find(';')), file_, line_);
      ReadBlock(scan);
      in_head_ = false;
    }
    return 1;
  }

  void ReadComment(std::string_view comment) {
    LineScanner scan(comment, file_, line_);
    const bool begin = scan.Accept("PASS");
    if (begin || scan.Accept("END OF PASS")) {
      const int pass = static_cast<int>(scan.ExpectNumber());
      scan.Expect("PIECE");
      AddEvent(begin ? ProgramEvent::Kind::kPassBegin : ProgramEvent::Kind::kPassEnd, pass,
               static_cast<int>(scan.ExpectNumber()));
      pass_ = begin ? pass : -1;
      return;
    }
    const size_t colon = comment.find(": ");
    if (!in_head_ || colon == std::string_view::npos) return;
    const std::string_view key = Trim(comment.substr(0, colon));
    if (key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") != std::string_view::npos) return;
    program_.header.emplace_back(key, Trim(comment.substr(colon + 2)));
  }

  void ReadBlock(LineScanner& scan) {
    std::array<std::optional<double>, 6> words;
    std::optional<double> feed, pause;
    bool dwell = false, moves = false;
    if (scan.AcceptAddress('N')) scan.ExpectNumber();
    while (!scan.AtEnd()) {
      if (scan.AcceptAddress('G')) {
        const double g = scan.ExpectNumber();
        dwell = dwell || g == 4;
        ReadG(scan, g);
      } else if (scan.AcceptAddress('F')) {
        feed = scan.ExpectNumber();
      } else if (scan.AcceptAddress('P')) {
        pause = scan.ExpectNumber();
      } else if (scan.AcceptAddress('Q')) {
        scan.ExpectNumber();
      } else if (scan.AcceptAddress('M')) {
        const double m = scan.ExpectNumber();
        ended_ = m == 2 || m == 30;
        if (!ended_ && m != 0 && m != 1) scan.Fail("M0, M1, M2 or M30 expected");
      } else {
        moves = ReadAxis(scan, words) || moves;
      }
    }
    if (blending_ && pause && !dwell) blend_ = *pause;
    if (feed && !inverse_time_) feed_ = *feed;
    if (moves) AddMotion(scan, words, feed);
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

  void ReadG(const LineScanner& scan, double g) {
    static const std::vector<double> neutral = {4, 17, 21, 40, 49, 90};
    if (g == 0 || g == 1) {
      rapid_ = g == 0;
    } else if (g == 93 || g == 94) {
      inverse_time_ = g == 93;
      feed_.reset();
    } else if (g == 64 || g == 61.1 || g == 61) {
      blending_ = g == 64;
    } else if (std::find(neutral.begin(), neutral.end(), g) == neutral.end()) {
      scan.Fail("G0, G1, G4, G17, G21, G40, G49, G61, G61.1, G64, G90, G93 or G94 expected");
    }
  }

  void AddMotion(const LineScanner& scan, const std::array<std::optional<double>, 6>& words,
                 std::optional<double> feed) {
    Joints angles = last_.value_or(Joints::Zero());
    for (int i = 0; i < 6; ++i) {
      if (words[i]) angles[i] = *words[i];
      if (!words[i] && !last_) scan.Fail(fmt::format("{} is missing in the first motion", "XYZABC"[i]));
    }
    Motion& motion = program_.motions.emplace_back();
    motion.q = FromController(settings_.axes, angles * kRadPerDeg);
    motion.pass = pass_;
    motion.line = line_;
    motion.exact = !blending_;
    if (blending_)
      motion.blend = settings_.blend * blend_ / BlendDegrees(settings_.blend, arm_, settings_.X_FT);
    if (!rapid_) motion.duration = Duration(scan, last_ ? FeedLength(*last_, angles) : 0, feed);
    last_ = angles;
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

  void AddEvent(ProgramEvent::Kind kind, double value, int piece) {
    program_.events.push_back({kind, program_.motions.size(), value, piece, 0, line_});
  }

  const Arm& arm_;
  const PostSettings& settings_;
  std::string file_;
  Templates templates_;
  MotionProgram program_;
  std::vector<std::string_view> lines_;
  std::vector<Problem> problems_;
  std::optional<Joints> last_;  // degrees
  std::optional<double> feed_;  // per minute, G94
  double blend_ = 0;            // degrees
  bool rapid_ = true, inverse_time_ = false, blending_ = true;
  int pass_ = -1;
  int line_ = 0;
  bool in_head_ = true;
  bool ended_ = false;
};

}  // namespace

MotionProgram LinuxCncPost::Read(const ProgramFiles& files, const Arm& arm,
                                 const PostSettings& settings) const {
  const auto source =
      std::find_if(files.begin(), files.end(), [](const auto& file) { return file.first.ends_with(".ngc"); });
  if (source == files.end()) throw InputError(Place{}, "a LinuxCNC program needs an .ngc file");
  return LinuxCncReader(arm, settings, source->first).Read(source->second);
}

}  // namespace millpose
