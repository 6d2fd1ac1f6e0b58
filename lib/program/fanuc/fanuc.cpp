// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/fanuc/fanuc.hpp"

#include <cassert>

#include "base/text.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/fanuc/fanuc_corners.hpp"
#include "program/fanuc/fanuc_file.hpp"
#include "program/program_name.hpp"
#include "program/scanner.hpp"
#include "program/writer.hpp"

namespace millpose {
namespace {

constexpr size_t kLongestFile = 36;  // a name, without the file's ending
constexpr char kData = '\x01';       // begins a line of a section that holds the position of the line before

class FanucWriter : public ProgramWriter {
 public:
  FanucWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
              const FanucOptions& options)
      : ProgramWriter(program, arm, settings, FanucTexts(settings)),
        options_(options),
        axes_(FanucAxes(settings)) {}

  ProgramFiles Write() {
    At(0);
    WriteSections();
    At(0);
    const size_t longest = FanucPost().Calling().longest;
    const std::string name = LegalName(program_.name, longest, 1);
    ProgramFiles files;
    std::string main = Head();
    const std::vector<std::string> parts = Parts();
    for (size_t i = 0; i < parts.size(); ++i) {
      const std::string part = SubprogramName(name, i, kLongestFile);
      files[part + ".ls"] = File(part, parts[i]);
      main += "CALL " + part + "\n";
    }
    files[name + ".ls"] = File(name, main + MainText(parts) + TextLines("footer"));
    return files;
  }

 private:
  /// What is written next belongs to motion `i`; the head states its user frame.
  void At(size_t i) {
    if (i >= program_.motions.size()) return;
    motion_ = &program_.motions[i];
    if (i == 0) frame_ = Frame();
  }

  /// What UFRAME is given where the motion counts, as it is written; empty where the controller holds it.
  std::optional<Pose> Frame() const {
    const std::optional<Pose> X_BP = FrameInBase();
    if (!X_BP || options_.position_register == 0) return std::nullopt;
    return FromFanucNumbers(FanucNumbers(FanucBase(options_) * *X_BP));
  }
  /// The part in the robot's base as the controller counts it.
  std::optional<Pose> FrameInBase() const {
    const std::optional<Pose> X_BP = motion_ ? FrameOf(program_, *motion_) : program_.X_BP;
    if (!X_BP) return std::nullopt;
    return AsCounted(settings_, motion_ ? motion_->external : ExternalPosition(), *X_BP);
  }

  void Begin() override {}
  void Forget() override { frame_ = Frame(); }

  std::string Head() const {
    std::string head = "!written by millpose for FANUC\n";
    for (const auto& [key, value] : program_.header)
      for (const std::string& remark : FanucRemarks(key, value)) head += "!" + remark + "\n";
    if (!program_.notice.empty())
      for (const char* line : kFanucNotice) head += std::string(line) + "\n";
    return head + Settings() + TextLines("header") + TextLines("tool_change");
  }

  std::string Settings() const override {
    std::string settings;
    if (const std::optional<Pose> frame = Frame())
      settings += SetFrame("UFRAME", options_.user_frame, *frame);
    if (options_.position_register > 0 && program_.X_FT)
      settings += SetFrame("UTOOL", options_.tool_frame, FanucTool(settings_, *program_.X_FT));
    return settings + fmt::format("UFRAME_NUM={}\nUTOOL_NUM={}\n", options_.user_frame, options_.tool_frame);
  }

  /// LPOS makes the register a Cartesian one, whose elements are X, Y, Z, W, P, R.
  std::string SetFrame(const char* what, int number, const Pose& pose) const {
    const int pr = options_.position_register;
    std::string lines = fmt::format("PR[{}]=LPOS\n", pr);
    const std::array<double, 6> numbers = FanucNumbers(pose);
    for (size_t i = 0; i < 6; ++i) {
      const std::string text = Fixed(numbers[i], kFanucDecimals);
      lines += fmt::format("PR[{},{}]={}\n", pr, i + 1, text.starts_with('-') ? "(" + text + ")" : text);
    }
    return lines + fmt::format("{}[{}]=PR[{}]\n", what, number, pr);
  }

  void AddMotion(size_t i) override {
    const Motion& motion = program_.motions[i];
    At(i);
    if (motion.type == MotionType::kLinear) return AddLinear(motion);
    FanucPosition position;
    position.joints = true;
    const Joints angles = settings_.axes.FromArm(*motion.q) * kDegPerRad;
    for (int k = 0; k < 6; ++k) position.numbers[static_cast<size_t>(k)] = angles[k];
    Add(fmt::format("J P[] {}% FINE", options_.joint_speed_percent), std::move(position));
  }

  void AddLinear(const Motion& motion) {
    const std::optional<Pose> frame = Frame();
    if (frame && !(frame_ && SameFrame(*frame, *frame_))) {
      const std::string lines = SetFrame("UFRAME", options_.user_frame, *frame);
      for (const std::string_view line : SplitLines(lines)) Line(std::string(line));
      frame_ = frame;
    }
    FanucPosition position;
    position.numbers = FanucNumbers(Target(motion, frame));
    position.config =
        motion.q ? FanucConfigOf(options_, settings_, arm_, *motion.q)
                 : FanucConfig{motion.status.value_or(0),
                               FanucTurns(options_, motion.least ? *motion.least : FanucLeast(options_, {}))};
    const FanucSpeed speed = FanucSpeedOf(motion.feed);
    Add(fmt::format("L P[] {}{} {}", speed.number, speed.per_second ? "mm/sec" : "cm/min",
                    FanucTermination(motion, options_)),
        std::move(position));
  }

  /// UTOOL in UFRAME as both are written: their rounding does not move the tip.
  Pose Target(const Motion& motion, const std::optional<Pose>& frame) const {
    Pose X_PC = motion.X_PT;
    X_PC.linear() = X_PC.linear() * settings_.R_TC();
    if (!frame) return X_PC;
    const Pose X_WorldP = FanucBase(options_) * *FrameInBase();
    const Pose tool = FanucTool(settings_, X_FT_);
    const Pose written = FromFanucNumbers(FanucNumbers(tool));
    return frame->inverse(Eigen::Isometry) * X_WorldP * X_PC * tool.inverse(Eigen::Isometry) * written;
  }

  /// A statement, P[] being `position`, which follows it until File().
  void Add(const std::string& statement, FanucPosition position) {
    for (const FanucAxis& axis : axes_)
      position.external[axis.axis->name] = ValueOf(settings_, *axis.axis, motion_->external);
    Line(statement);
    std::string record = FanucPositionText(0, position, settings_, options_);
    std::ranges::replace(record, '\n', kData);
    Line(kData + record);
  }

  /// Numbered lines, and their positions under /POS.
  std::string File(const std::string& name, const std::string& statements) const {
    std::string text = FanucHead(FanucGroups(settings_)), positions;
    text.replace(text.find("{name}"), 6, name);
    int line = 0, number = 0;
    for (const std::string_view statement : SplitLines(statements)) {
      if (statement.starts_with(kData)) {
        std::string record(statement.substr(1));
        std::ranges::replace(record, kData, '\n');
        positions += fmt::format("P[{}", number) + record.substr(3);  // in place of P[0
        continue;
      }
      const size_t place = statement.find(" P[] ");
      const bool motion = place == 1;
      text += motion ? fmt::format("{:4}:{} P[{}] {} ;\n", ++line, statement.substr(0, 1), ++number,
                                   statement.substr(6))
                     : fmt::format("{:4}:  {} ;\n", ++line, statement);
    }
    return text + "/POS\n" + positions + "/END\n";
  }

  void Event(const ProgramEvent& event) override {
    const std::string place = fmt::format("PASS {} PIECE {}", Fixed(event.value, 0), event.piece);
    if (event.kind == ProgramEvent::Kind::kPassBegin) {
      Line("!" + place);
    } else if (event.kind == ProgramEvent::Kind::kPassEnd) {
      Line("!END OF " + place);
    } else if (event.kind == ProgramEvent::Kind::kDwell) {
      Line(fmt::format("WAIT {}(sec)", Fixed(std::ceil(event.value * 100 - 1e-6) / 100, 2)));
    } else if (event.kind == ProgramEvent::Kind::kOutput) {
      // Done when the motion before, which is FINE, has arrived.
      Line(fmt::format("DO[{}]={}", event.output.number, event.output.on ? "ON" : "OFF"));
    }
    AddTexts(event);
  }

  const FanucOptions& options_;
  const std::vector<FanucAxis> axes_;
  const Motion* motion_ = nullptr;  // that is being written, or the first
  std::optional<Pose> frame_;       // UFRAME as it was set last
};

}  // namespace

std::vector<std::string> FanucRemarks(const std::string& key, const std::string& value) {
  std::string rest = PlainAscii(key + ": " + value);
  std::ranges::replace(rest, ';', ',');
  std::vector<std::string> remarks;
  std::string begin;
  while (true) {
    const size_t room = kFanucRemark - begin.size();
    if (rest.size() <= room) {
      remarks.push_back(begin + rest);
      return remarks;
    }
    const size_t blank = rest.rfind(' ', room);
    const bool at_blank = blank != std::string::npos && blank > 0;
    remarks.push_back(begin + rest.substr(0, at_blank ? blank : room));
    rest.erase(0, at_blank ? blank + 1 : room);
    begin = at_blank ? ": " : ":";
  }
}

std::map<std::string, std::string> FanucTexts(const PostSettings& settings) {
  std::map<std::string, std::string> texts = {
      {"spindle_on", "!SPINDLE ON {rpm} 1/min\n!switch it on, then start again\nPAUSE"},
      {"spindle_off", "!SPINDLE OFF\n!switch it off, then start again\nPAUSE"}};
  if (settings.ChangesTool()) texts["tool_change"] = "!TOOL {tool}\n!put it in, then start again\nPAUSE";
  return texts;
}

ProgramFiles FanucPost::Write(const MotionProgram& program, const Arm& arm,
                              const PostSettings& settings) const {
  assert(IsWellFormed(program));
  if (program.blend_is_distance) return FanucWriter(program, arm, settings, options_).Write();
  MotionProgram rounded = program;
  Round(rounded, arm, settings);
  return FanucWriter(rounded, arm, settings, options_).Write();
}

CallingSyntax FanucPost::Calling() const {
  std::string head = FanucHead("1,*,*,*,*") + ":  !written by millpose for FANUC ;\n";
  return {.longest = kLongestFile - 4,
          .letters = 1,
          .ending = ".ls",
          .head = head,
          .call = ":  CALL {name} ;\n",
          .tail = "/END\n",
          .closing = "/POS\n",
          .called_ending = ".ls",
          .called_tail = "/END\n",
          .comment_begin = ":  !",
          .comment_end = " ;",
          .comment_width = kFanucRemark};
}

}  // namespace millpose
