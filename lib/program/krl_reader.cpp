// SPDX-License-Identifier: GPL-3.0-or-later
// Reads KRL as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/krl.hpp"
#include "program/scanner.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

using Fields = std::map<std::string, double>;

constexpr double kDefaultFeed = 2000;  // mm/s, $VEL.CP after BAS(#INITMOV,0)
constexpr double kDefaultBlend = 3;    // mm, $APO.CDIS after BAS(#INITMOV,0)

class KrlReader {
 public:
  KrlReader(const PostSettings& settings, const std::string& file)
      : settings_(settings), file_(file), templates_(KrlTexts(), settings.texts) {
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
    if (!ended_) problems_.push_back({{file_, static_cast<int>(lines_.size()), 0, -1}, "END is missing"});
    if (!problems_.empty()) throw InputError(problems_);
    return std::move(program_);
  }

 private:
  /// Reads the statement at lines_[i]; how many lines it took.
  size_t ReadAt(size_t i) {
    line_ = static_cast<int>(i) + 1;
    if (const auto match = templates_.Recognise(lines_, i)) {
      AddEvent(match->kind, match->value, 0);
      return match->lines;
    }
    const std::string_view line = Trim(lines_[i]);
    if (line.starts_with(';')) {
      ReadComment(line.substr(1));
    } else if (!line.empty() && line[0] != '&') {
      LineScanner scan(lines_[i].substr(0, lines_[i].find(';')), file_, line_);
      if (ended_) scan.Fail("nothing expected after END");
      ReadStatement(scan);
    }
    return 1;
  }

  void ReadComment(std::string_view comment) {
    LineScanner scan(comment, file_, line_);
    const bool begin = scan.Accept("FOLD PASS");
    if (begin || scan.Accept("ENDFOLD (PASS")) {
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

  void ReadStatement(LineScanner& scan) {
    if (program_.name.empty()) {
      scan.Expect("DEF");
      const auto name = scan.AcceptName();
      if (!name) scan.Fail("the program's name expected");
      program_.name = *name;
      scan.Expect("(");
      scan.Expect(")");
    } else if (scan.Accept("PTP")) {
      ReadPtp(scan);
    } else if (scan.Accept("LIN")) {
      ReadLin(scan);
    } else if (scan.Accept("END")) {
      ended_ = true;
    } else {
      ReadSetting(scan);
      return;
    }
    scan.ExpectEnd();
    in_head_ = in_head_ && program_.motions.empty();
  }

  void ReadSetting(LineScanner& scan) {
    in_head_ = false;
    if (scan.Accept("$BASE")) {
      if (posed_) scan.Fail("one base for all poses of the program expected");
      program_.X_BP = ReadFrame(scan);
    } else if (scan.Accept("$TOOL")) {
      if (posed_) scan.Fail("one tool for all poses of the program expected");
      Pose X_FT = ReadFrame(scan);
      X_FT.linear() = X_FT.linear() * settings_.R_TC.transpose();
      program_.X_FT = X_FT;
    } else if (scan.Accept("$VEL.CP")) {
      scan.Expect("=");
      feed_ = scan.ExpectNumber() * 1000;
    } else if (scan.Accept("$APO.CDIS")) {
      scan.Expect("=");
      blend_ = scan.ExpectNumber();
    } else if (scan.Accept("$ADVANCE")) {
      scan.Expect("=");
      scan.ExpectNumber();
    } else if (scan.Accept("$ORI_TYPE")) {
      scan.Expect("=");
      scan.Expect("#VAR");
    } else if (scan.Accept("BAS")) {
      ReadBas(scan);
    } else if (scan.Accept("WAIT SEC")) {
      scan.ExpectNumber();
    } else if (scan.Accept("GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM")) {
      scan.Expect("(");
      scan.Expect(")");
    } else if (!scan.Accept("INTERRUPT ON 3") && !scan.Accept("HALT")) {
      scan.Fail(
          "PTP, LIN, $BASE, $TOOL, $VEL.CP, $APO.CDIS or another statement of a milling program expected");
    }
    scan.ExpectEnd();
  }

  void ReadBas(LineScanner& scan) {
    scan.Expect("(");
    if (!scan.Accept("#INITMOV")) scan.Expect("#VEL_PTP");
    scan.Expect(",");
    scan.ExpectNumber();
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

  Pose ReadFrame(LineScanner& scan) {
    scan.Expect("=");
    const std::vector<std::string> names = {"X", "Y", "Z", "A", "B", "C"};
    const Fields fields = ReadFields(scan, "FRAME", names);
    ExpectAll(scan, fields, names);
    return PoseOf(fields);
  }

  /// The tool in the workpiece frame of a motion's fields; what it leaves out stays as the motion before had
  /// it.
  Pose Target(LineScanner& scan, Fields fields) {
    const bool first = !std::exchange(posed_, true);
    if (first && !program_.X_BP) scan.Fail("$BASE must be set before the first pose");
    if (first && !program_.X_FT) scan.Fail("$TOOL must be set before the first pose");
    for (const std::string name : {"X", "Y", "Z", "A", "B", "C"}) {
      if (!fields.contains(name) && last_.contains(name)) fields[name] = last_[name];
    }
    ExpectAll(scan, fields, {"X", "Y", "Z", "A", "B", "C"});
    last_ = fields;
    Pose X_PT = PoseOf(fields);
    X_PT.linear() = X_PT.linear() * settings_.R_TC.transpose();
    return X_PT;
  }

  void ReadPtp(LineScanner& scan) {
    Motion& motion = AddMotion(MotionType::kJoint);
    const Fields fields = ReadFields(
        scan, "E6POS", {"X", "Y", "Z", "A", "B", "C", "S", "T", "A1", "A2", "A3", "A4", "A5", "A6"});
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
    motion.X_PT = Target(scan, ReadFields(scan, "E6POS", {"X", "Y", "Z", "A", "B", "C", "S", "T"}));
    motion.feed = feed_;
    motion.exact = !scan.Accept("C_DIS");
    motion.blend = motion.exact ? 0 : blend_;
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
  Fields last_;  // of the last Cartesian motion
  double feed_ = kDefaultFeed;
  double blend_ = kDefaultBlend;
  int pass_ = -1;
  int line_ = 0;
  bool posed_ = false;  // a pose was approached
  bool in_head_ = true;
  bool ended_ = false;
};

}  // namespace

MotionProgram KrlPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  const auto source =
      std::find_if(files.begin(), files.end(), [](const auto& file) { return file.first.ends_with(".src"); });
  if (source == files.end()) throw InputError(Place{}, "a KRL program needs a .src file");
  return KrlReader(settings, source->first).Read(source->second);
}

}  // namespace millpose
