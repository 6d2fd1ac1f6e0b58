// SPDX-License-Identifier: GPL-3.0-or-later
// Reads LS programs as far as robot programs of millpose and the usual hand edits go.
#include "base/text.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/fanuc/fanuc.hpp"
#include "program/fanuc/fanuc_corners.hpp"
#include "program/fanuc/fanuc_file.hpp"
#include "program/fanuc/fanuc_words.hpp"
#include "program/reader.hpp"

namespace millpose {
namespace {

using fanuc::ReadWhole;

constexpr double kSamePlace = 1e-9;  // of a frame stated again
constexpr const char* kFrameSet = "UFRAME[n]=PR[n] with the part's place";
constexpr const char* kToolSet = "UTOOL[n]=PR[n] with the tool";

class FanucReader : public ProgramReader {
 public:
  FanucReader(const ProgramFiles& statements, const std::map<std::string, FanucPositions>& positions,
              const PostSettings& settings, const FanucOptions& options)
      : ProgramReader(statements, settings,
                      Templates(FanucTexts(settings), settings.texts, ToolOf(settings), {.numbers = false})),
        positions_(positions),
        options_(options) {
    program_.blend_is_distance = true;
    program_.corner_assumption = FanucCornerAssumption(options, settings);
    program_.swivel = settings.R_TC() * Eigen::Vector3d::UnitZ();
    program_.any_turn = true;
  }

 private:
  std::optional<std::string_view> Comment(std::string_view line) const override {
    if (line.starts_with("--")) return line.substr(2);
    return line.starts_with('!') ? std::optional(line.substr(1)) : std::nullopt;
  }
  std::string_view WithoutComment(std::string_view line) const override { return line; }

  void ReadComment(std::string_view comment) override {
    LineScanner scan(comment, "", 0);
    const bool begin = scan.Accept("PASS");
    if (begin || scan.Accept("END OF PASS")) return ReadPassMark(scan, begin);
    const bool goes_on = comment.starts_with(':');
    if (goes_on && in_header_) {
      program_.header.back().second += comment.substr(1);  // with the blank that parts words
      return;
    }
    const size_t before = program_.header.size();
    if (!goes_on) ProgramReader::ReadComment(comment);
    in_header_ = program_.header.size() > before;
  }

  /// The notice, whose lines stand together.
  size_t ReadBlock(const std::vector<std::string_view>& lines, size_t first) override {
    if (!InHead()) return 0;
    for (size_t i = 0; i < kFanucNotice.size(); ++i)
      if (first + i >= lines.size() || !SameWords(lines[first + i], kFanucNotice[i])) return 0;
    program_.notice = kCompensatedNotice;
    return kFanucNotice.size();
  }

  std::vector<std::string> Needed() const override {
    std::vector<std::string> needed = {"UFRAME_NUM", "UTOOL_NUM"};
    if (options_.position_register > 0) needed.insert(needed.end(), {kFrameSet, kToolSet});
    return needed;
  }

  void Forgotten() override { register_.reset(); }

  void ReadCode(LineScanner& scan) override {
    in_header_ = false;
    const size_t start = scan.Next();
    if (InText() && fanuc::ReadTextWord(scan)) return scan.ExpectEnd();
    if (scan.Accept("/END")) {
      EndFile();
    } else if (scan.Accept("L")) {
      ReadLinear(scan);
    } else if (scan.Accept("J")) {
      ReadJoint(scan);
    } else if (scan.Accept("CALL")) {
      ReadCalled(scan, start);
    } else if (!ReadFrame(scan, start) && !ReadRegister(scan, start) && !ReadPause(scan, start)) {
      ReadOutput(scan, start);
    }
    scan.ExpectEnd();
  }

  bool ReadTextWord(LineScanner& scan) override { return fanuc::ReadTextWord(scan); }

  void ReadCalled(LineScanner& scan, size_t start) {
    const std::string name = scan.AcceptName().value_or("");
    if (IsDeclared(name)) {
      const std::string arguments = scan.Accept("(") ? ReadArguments(scan) : "";
      ReadDeclaredCall(scan, start, name, arguments);
      return;
    }
    if (!scan.AtEnd() || name.empty() || !ReadCall(scan, name))
      scan.FailFrom(start, "the call of a file of the program, or one that the cell declares, expected");
  }

  /// UFRAME_NUM and UTOOL_NUM select, UFRAME[n]=PR[m] and UTOOL[n]=PR[m] set what positions count in.
  bool ReadFrame(LineScanner& scan, size_t start) {
    for (const bool frame : {true, false}) {
      const int wanted = frame ? options_.user_frame : options_.tool_frame;
      const char* key = frame ? "user_frame" : "tool_frame";
      if (scan.Accept(frame ? "UFRAME_NUM" : "UTOOL_NUM")) {
        if (scan.Accept("[")) {
          scan.Expect("GP1");
          scan.Expect("]");
        }
        scan.Expect("=");
        const size_t number = scan.Next();
        if (ReadWhole(scan, 0, 100) != wanted)
          scan.FailFrom(number, fmt::format("{} expected, the cell's {}", wanted, key));
        Stated(frame ? "UFRAME_NUM" : "UTOOL_NUM");
      } else if (scan.Accept(frame ? "UFRAME" : "UTOOL")) {
        const Pose pose = ReadFrameValue(scan, start, wanted, key);
        frame ? SetUserFrame(scan, start, pose) : SetTool(scan, start, pose);
      } else {
        continue;
      }
      Allow(scan, start, kOutsideCuts);
      return true;
    }
    return false;
  }

  Pose ReadFrameValue(LineScanner& scan, size_t start, int wanted, const char* key) {
    if (options_.position_register == 0)
      scan.FailFrom(start,
                    "UFRAME_NUM or UTOOL_NUM expected: the frames' values are the controller's (the cell "
                    "gives no position_register)");
    scan.Expect("[");
    const size_t number = scan.Next();
    if (ReadWhole(scan, 1, 100) != wanted)
      scan.FailFrom(number, fmt::format("{} expected, the cell's {}", wanted, key));
    scan.Expect("]");
    scan.Expect("=");
    ReadRegisterNumber(scan);
    scan.Expect("]");
    std::array<double, 6> numbers{};
    for (size_t i = 0; i < 6; ++i) {
      if (!register_ || !(*register_)[i])
        scan.FailFrom(start, fmt::format("PR[{0}]=LPOS and then PR[{0},1] to PR[{0},6] expected before",
                                         options_.position_register));
      numbers[i] = *(*register_)[i];
    }
    return FromFanucNumbers(numbers);
  }

  void SetUserFrame(const LineScanner& scan, size_t start, const Pose& pose) {
    const Pose X_BP = FanucBase(options_).inverse() * pose;
    if (posed_ && external_.empty() && program_.X_BP &&
        !X_BP.matrix().isApprox(program_.X_BP->matrix(), kSamePlace))
      scan.FailFrom(start, "one user frame for all poses of the program expected");
    program_.X_BP = X_BP;
    Stated(kFrameSet);
  }

  void SetTool(const LineScanner& scan, size_t start, const Pose& pose) {
    const Pose X_FT = FanucFlangeTool(settings_, pose);
    if (posed_ && program_.X_FT && !X_FT.matrix().isApprox(program_.X_FT->matrix(), kSamePlace))
      scan.FailFrom(start, "one tool for all poses of the program expected");
    program_.X_FT = X_FT;
    Stated(kToolSet);
  }

  /// "PR[5" or "PR[5," is taken.
  void ReadRegisterNumber(LineScanner& scan) const {
    scan.Expect("PR");
    scan.Expect("[");
    const size_t number = scan.Next();
    if (options_.position_register == 0 || ReadWhole(scan, 1, 2000) != options_.position_register)
      scan.FailFrom(
          number, options_.position_register == 0
                      ? std::string("no register expected: the cell gives no position_register")
                      : fmt::format("{} expected, the cell's position_register", options_.position_register));
  }

  /// PR[5]=LPOS makes it a Cartesian one; PR[5,1]=(-12.5) sets X.
  bool ReadRegister(LineScanner& scan, size_t start) {
    LineScanner ahead = scan;
    if (!ahead.Accept("PR")) return false;
    ReadRegisterNumber(scan);
    if (scan.Accept("]")) {
      scan.Expect("=");
      scan.Expect("LPOS");
      register_.emplace();
    } else {
      scan.Expect(",");
      const int element = ReadWhole(scan, 1, 6);
      scan.Expect("]");
      scan.Expect("=");
      if (!register_)
        scan.FailFrom(
            start, fmt::format("PR[{}]=LPOS expected before: what its elements mean depends on what it holds",
                               options_.position_register));
      (*register_)[static_cast<size_t>(element - 1)] = fanuc::ReadConstant(scan);
    }
    Allow(scan, start, kOutsideCuts);
    return true;
  }

  bool ReadPause(LineScanner& scan, size_t start) {
    if (scan.Accept("PAUSE")) {
      ReadHandEvent(scan, start, ProgramEvent::Kind::kStop, kOutsideCuts);
    } else if (scan.Accept("MESSAGE")) {
      scan.Expect("[");
      scan.TakeUntil(']');
      scan.Expect("]");
      AddHandEvent(ProgramEvent::Kind::kMessage, scan.TakenFrom(start));
    } else if (scan.Accept("WAIT")) {
      if (const auto seconds = fanuc::ReadSeconds(scan)) {
        ReadDwell(scan, start, *seconds);
      } else {
        fanuc::ReadCondition(scan);
        ReadHandEvent(scan, start, ProgramEvent::Kind::kWait, kOutsideCuts);
      }
    } else {
      return false;
    }
    return true;
  }

  /// DO[3]=ON where the motion before has arrived.
  void ReadOutput(LineScanner& scan, size_t start) {
    static const std::vector<std::string> statements = {"L",      "J",     "UFRAME_NUM", "UTOOL_NUM",
                                                        "UFRAME", "UTOOL", "PR",         "DO",
                                                        "WAIT",   "PAUSE", "MESSAGE",    "CALL"};
    if (!scan.Accept("DO")) {
      const std::string near = NearestName(scan.AcceptName().value_or(""), statements);
      scan.FailFrom(start, fmt::format("{} expected (spindle and other outputs: the cell's texts){}",
                                       fmt::join(statements, ", "),
                                       near.empty() ? "" : "; did you mean " + near + "?"));
    }
    PathOutput output;
    output.number = fanuc::ReadIndex(scan);
    scan.Expect("=");
    output.on = fanuc::ReadOnOff(scan);
    AddOutput(output);
  }

  /// P[3] or P[3:name]: what stands under /POS of the same file.
  const FanucPosition& ReadPosition(LineScanner& scan, int& number) const {
    const size_t start = scan.Next();
    if (!scan.Accept("P")) scan.Fail("P[n] expected (what a register holds is not known)");
    scan.Expect("[");
    number = ReadWhole(scan, 1, 1000000);
    if (scan.Accept(":")) scan.TakeUntil(']');
    scan.Expect("]");
    const auto file = positions_.find(FileStem() + ".ls");
    if (file == positions_.end() || !file->second.contains(number))
      scan.FailFrom(start, "a position of this file's /POS expected");
    return file->second.at(number);
  }

  /// Where the external axes stand at the motion's end, and the frame that counts there.
  void Stand(const FanucPosition& position, Motion& motion) {
    for (const ControllerAxis& axis : settings_.controller_axes)
      SetValue(settings_, axis, position.external.at(axis.name), external_);
    motion.external = external_;
    if (program_.X_BP && !external_.empty()) motion.X_BP = FromCounted(settings_, external_, *program_.X_BP);
  }

  void ReadJoint(LineScanner& scan) {
    const size_t start = scan.Next();
    int number = 0;
    const FanucPosition& position = ReadPosition(scan, number);
    if (!position.joints)
      scan.FailFrom(
          start, fmt::format("joint angles expected: P[{}] at line {} has X, Y, Z", number, position.line));
    const size_t speed = scan.Next();
    if (scan.ExpectDecimal() > options_.joint_speed_percent)
      scan.FailFrom(speed, fmt::format("at most {} expected (the cell's joint_speed_percent)",
                                       options_.joint_speed_percent));
    if (scan.TakenFrom(speed).starts_with('-') || scan.TakenFrom(speed) == "0")
      scan.FailFrom(speed, "above 0 expected");
    scan.Expect("%");
    scan.Expect("FINE");
    Motion& motion = AddMotion(MotionType::kJoint);
    Joints angles;
    for (int i = 0; i < 6; ++i) angles[i] = position.numbers[static_cast<size_t>(i)] * kRadPerDeg;
    motion.q = settings_.axes.ToArm(angles);
    motion.exact = true;
    Stand(position, motion);
  }

  /// FINE; or 0 of CNT0, 1 of a CNTn above, y of CRy, where the cell knows what bounds them.
  std::pair<bool, double> ReadTermination(LineScanner& scan) const {
    const size_t start = scan.Next();
    const std::string how = scan.AcceptName().value_or("");
    if (SameWords(how, "FINE")) return {true, 0};
    const bool zeros = how.size() > 3 && how.find_first_not_of('0', 3) == std::string::npos;
    if (zeros && SameWords(how.substr(0, 3), "CNT")) return {false, 0};
    const bool known = !program_.corner_assumption.empty();
    const bool cnt = known && options_.acceleration_time && SameWords(how.substr(0, 3), "CNT"),
               region = known && options_.corner_region && SameWords(how.substr(0, 2), "CR");
    if (!cnt && !region)
      scan.FailFrom(start, fmt::format("FINE{} or CNT0 expected: the path of other corners is not documented",
                                       !known                       ? ""
                                       : options_.acceleration_time ? ", CNT1 to CNT100"
                                                                    : ", CR1 to CR1000"));
    const std::optional<double> number = ParseNumber(how.substr(cnt ? 3 : 2));
    if (!number || *number < 1 || *number > (cnt ? 100 : 1000) || *number != std::floor(*number))
      scan.FailFrom(start, cnt ? "CNT0 to CNT100 expected" : "CR1 to CR1000 expected");
    return {false, cnt ? 1 : *number};
  }

  void ReadLinear(LineScanner& scan) {
    const size_t start = scan.Next();
    int number = 0;
    const FanucPosition& position = ReadPosition(scan, number);
    if (position.joints)
      scan.FailFrom(start, fmt::format("X, Y, Z, W, P, R expected: P[{}] at line {} has joint angles", number,
                                       position.line));
    const double feed = fanuc::ReadFeed(scan);
    const auto [exact, blend] = ReadTermination(scan);
    const ExternalPosition before = external_;
    if (InHead() && !external_.empty())
      scan.FailFrom(start,
                    "a joint motion before the first pose expected: it says where the external axes stand");
    posed_ = true;
    Motion& motion = AddMotion(MotionType::kLinear);
    motion.exact = exact;
    motion.blend = blend;
    motion.feed = feed;
    motion.status = position.config.status;
    motion.least = FanucLeast(options_, position.config.turns);
    motion.X_PT = FromFanucNumbers(position.numbers);
    motion.X_PT.linear() = motion.X_PT.linear() * settings_.R_TC().transpose();
    Stand(position, motion);
    if (external_ == before) return;
    if (const std::string name = UncoupledMove(settings_, before, external_); !name.empty())
      scan.FailFrom(start,
                    fmt::format("{} moves in an L, by P[{}] at line {}; the controller does not count in it "
                                "(coupled: false in the cell), so that it must stand still",
                                name, number, position.line));
    if (program_.X_BP) motion.X_BP_begin = FromCounted(settings_, before, *program_.X_BP);
  }

  const std::map<std::string, FanucPositions>& positions_;
  const FanucOptions& options_;
  std::optional<std::array<std::optional<double>, 6>> register_;  // of position_register since PR[n]=LPOS
  bool in_header_ = false;                                        // the last remark was of the header
  bool posed_ = false;                                            // a pose was approached
};

}  // namespace

std::vector<Problem> FanucPost::CheckTexts(const Arm&, const PostSettings& settings) const {
  return FanucReader({}, {}, settings, options_).CheckTexts();
}

MotionProgram FanucPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  ProgramFiles statements;
  std::map<std::string, FanucPositions> positions;
  std::vector<Problem> problems;
  for (const auto& [name, text] : files) {
    if (!name.ends_with(".ls")) continue;
    FanucFile file = ReadFanucFile(name, name.substr(0, name.size() - 3), text, settings, options_, problems);
    statements[name] = std::move(file.statements);
    positions[name] = std::move(file.positions);
  }
  try {
    MotionProgram program = FanucReader(statements, positions, settings, options_).Read({".ls"});
    SettleFanucCorners(program, options_);
    if (problems.empty()) return program;
  } catch (const InputError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
  std::ranges::stable_sort(
      problems, {}, [](const Problem& problem) { return std::pair(problem.place.file, problem.place.line); });
  throw InputError(std::move(problems));
}

}  // namespace millpose
