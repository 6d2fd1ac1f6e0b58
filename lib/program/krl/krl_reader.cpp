// SPDX-License-Identifier: GPL-3.0-or-later
// Reads KRL as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/krl/krl.hpp"
#include "program/krl/krl_head.hpp"
#include "program/krl/krl_settings.hpp"
#include "program/krl/krl_words.hpp"

namespace millpose {
namespace {

using krl::ExpectAll;
using krl::Fields;

constexpr double kExternalSlack = 1e-4;  // mm or degrees

class KrlReader : public KrlSettings {
 public:
  KrlReader(const ProgramFiles& files, const PostSettings& settings, const KrlOptions& options)
      : KrlSettings(files, settings, options) {}

 private:
  /// The check of the controller's frame with its data: before every motion, as written.
  size_t ReadBlock(const std::vector<std::string_view>& lines, size_t first) override {
    if (!program_.motions.empty() || !defined_) return 0;
    if (const size_t taken = begun_ ? 0 : KrlLines(KrlDeclarations(), lines, first)) {
      declared_ = true;
      return taken;
    }
    if (const size_t taken = declared_ ? KrlLines(check_, lines, first) : 0) {
      program_.frames_checked = true;
      return taken;
    }
    if (const size_t taken = declared_ ? KrlLines(notice_, lines, first) : 0) {
      program_.notice = kCompensatedNotice;
      return taken;
    }
    return 0;
  }

  void BeginFile() override { defined_ = false; }

  void ReadComment(std::string_view comment) override {
    LineScanner scan(comment, "", 0);
    const bool begin = scan.Accept("FOLD PASS");
    if (!begin && !scan.Accept("ENDFOLD (PASS")) return ProgramReader::ReadComment(comment);
    ReadPassMark(scan, begin);
  }

  void ReadCode(LineScanner& scan) override {
    begun_ = begun_ || defined_ || InText();
    if (!defined_ && !InText()) {
      ReadDefinition(scan);
    } else if (InText() && ReadTextWord(scan)) {
      return scan.ExpectEnd();
    } else if (scan.Accept("PTP")) {
      ReadPtp(scan);
    } else if (scan.Accept("LIN")) {
      ReadLin(scan);
    } else if (scan.Accept("END")) {
      EndFile();
    } else if (!ReadFrames(scan) && !ReadSetting(scan) && !ReadPause(scan)) {
      ReadSubprogram(scan);
    }
    scan.ExpectEnd();
  }

  /// Lines such as &ACCESS, from their first column on, stand before DEF alone.
  void ReadDefinition(LineScanner& scan) {
    if (scan.Peek() == '&') {
      if (scan.Next() != 0) scan.Fail("& in the first column expected");
      scan.Rest();
      return;
    }
    if (!scan.Accept("GLOBAL DEF")) scan.Expect("DEF");
    const auto name = scan.AcceptName();
    if (!name || !SameWords(*name, FileStem()))
      scan.Fail(fmt::format("the file's name {} expected", FileStem()));
    if (!InSubprogram()) program_.name = *name;
    scan.Expect("(");
    scan.Expect(")");
    defined_ = true;
  }

  bool ReadTextWord(LineScanner& scan) override { return krl::ReadOutput(scan); }

  void ReadSubprogram(LineScanner& scan) {
    static const std::vector<std::string> statements = {
        "PTP",   "LIN",       "TRIGGER WHEN", "WAIT SEC",   "WAIT FOR",  "HALT",
        "$BASE", "$TOOL",     "$VEL.CP",      "$VEL.ORI1",  "$VEL.ORI2", "$ACC.CP",
        "BAS",   "$ACC.ORI1", "$ACC.ORI2",    "$APO.CDIS",  "$ADVANCE",  "$ORI_TYPE",
        "$LOAD", "$OV_PRO",   "$IPO_MODE",    "$CIRC_TYPE", "INTERRUPT", "END"};
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (name && scan.Accept(":")) return AddLabel(scan, start, *name);
    if (name && IsDeclared(*name)) {
      scan.Expect("(");
      const std::string arguments = ReadArguments(scan);
      ReadDeclaredCall(scan, start, *name, arguments);
      return;
    }
    if (name && scan.Accept("(") && scan.Accept(")") && ReadCall(scan, *name)) {
      defined_ = true;
      return;
    }
    const std::string word =
        name.value_or("") + (scan.Accept(".") ? "." + scan.AcceptName().value_or("") : "");
    const std::string nearest = NearestName(word, statements);
    scan.FailFrom(start, fmt::format("{}, a label or the call of a file of the program expected (spindle and "
                                     "outputs: the cell's texts, TRIGGER){}",
                                     fmt::join(statements, ", "),
                                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }

  /// The tool in the workpiece frame of a motion's fields; what it leaves out stays as the motion before had
  /// it.
  Pose Target(LineScanner& scan, Fields fields) {
    posed_ = true;
    Require("$BASE");
    if (options_.external_base) Require(kFollowsBase);
    Require("$TOOL");
    for (const std::string name : {"X", "Y", "Z", "A", "B", "C"}) {
      if (!fields.contains(name) && last_.contains(name)) fields[name] = last_[name];
    }
    last_ = fields;
    for (const std::string name : {"X", "Y", "Z", "A", "B", "C"}) last_.try_emplace(name, 0);  // told once
    ExpectAll(scan, fields, {"X", "Y", "Z", "A", "B", "C"});
    Pose X_PT = krl::PoseOf(fields);
    X_PT.linear() = X_PT.linear() * settings_.R_TC().transpose();
    return X_PT;
  }

  /// The fields that a target may have, and the external axes that it must have; `motion` ends where they
  /// say.
  Fields ReadTarget(LineScanner& scan, std::vector<std::string> allowed, Motion& motion) {
    std::vector<std::string> external;
    for (const ControllerAxis& axis : settings_.controller_axes) external.push_back(axis.name);
    allowed.insert(allowed.end(), external.begin(), external.end());
    std::vector<std::string> types = {"E6POS", "POS", "FRAME"};
    if (allowed.front() == "A1") types.insert(types.end(), {"E6AXIS", "AXIS"});
    Fields fields = krl::ReadFields(scan, types, allowed);
    ExpectAll(scan, fields, external);
    for (const ControllerAxis& axis : settings_.controller_axes) {
      const double value = fields.at(axis.name);
      if (axis.axis.empty() && std::abs(value - axis.constant) > kExternalSlack)
        scan.Fail(
            fmt::format("{} stays at {} in this program; that value expected", axis.name, axis.constant));
      SetValue(settings_, axis, value, external_);
    }
    motion.external = external_;
    if (base_ && !external_.empty()) motion.X_BP = KrlBaseFrame(options_, settings_, external_, *base_);
    return fields;
  }

  void ReadPtp(LineScanner& scan) {
    Motion& motion = AddMotion(MotionType::kJoint);
    Require(kPtpSpeed);
    const std::vector<std::string> axes = {"A1", "A2", "A3", "A4", "A5", "A6"};
    const std::vector<std::string> place = {"X", "Y", "Z", "A", "B", "C", "S", "T"};
    std::vector<std::string> both = axes;
    both.insert(both.end(), place.begin(), place.end());
    const Fields fields = ReadTarget(scan, both, motion);
    const auto given = [&](const std::string& name) { return fields.contains(name); };
    if (std::any_of(axes.begin(), axes.end(), given)) {
      ExpectAll(scan, fields, axes);
      if (std::any_of(place.begin(), place.end(), given)) scan.Fail("axes or a pose expected, not both");
      Joints angles;
      for (int i = 0; i < 6; ++i) angles[i] = fields.at(fmt::format("A{}", i + 1)) * kRadPerDeg;
      motion.q = settings_.axes.ToArm(angles);
      last_.clear();
    } else {
      if (fields.contains("S")) motion.status = static_cast<int>(fields.at("S"));
      if (fields.contains("T")) motion.turn = static_cast<int>(fields.at("T"));
      motion.X_PT = Target(scan, fields);
    }
    motion.exact = !scan.Accept("C_PTP");
  }

  /// External axes that move along: the controller counts in them, so that $BASE holds all the way.
  void CoordinatedMotion(const LineScanner& scan, const ExternalPosition& before, Motion& motion) const {
    if (motion.external == before || !base_) return;
    if (const std::string name = UncoupledMove(settings_, before, motion.external); !name.empty())
      scan.Fail(
          fmt::format("{} moves in a LIN; the controller does not count in it (coupled: false in the "
                      "cell), so that it must stand still",
                      name));
    motion.X_BP_begin = KrlBaseFrame(options_, settings_, before, *base_);
  }

  void ReadLin(LineScanner& scan) {
    const ExternalPosition before = external_;
    Motion& motion = AddMotion(MotionType::kLinear);
    for (const char* setting : {"$VEL.CP", "$VEL.ORI1", "$VEL.ORI2", "$ORI_TYPE"}) Require(setting);
    motion.X_PT = Target(scan, ReadTarget(scan, {"X", "Y", "Z", "A", "B", "C", "S", "T"}, motion));
    CoordinatedMotion(scan, before, motion);
    motion.feed = feed_;
    motion.turn_speed = std::min(turn_speed_[0], turn_speed_[1]);
    motion.exact = !scan.Accept("C_DIS");
    if (motion.exact) return;
    Require("$APO.CDIS");
    motion.blend = blend_;
  }

  bool defined_ = false;   // DEF was read
  bool begun_ = false;     // a statement was read: no declaration may follow
  bool declared_ = false;  // the data of the frame check were read
  const std::string check_ = KrlFrameCheck(options_);
  const std::string notice_ = KrlNotice(kCompensatedNotice);
};

}  // namespace

std::vector<Problem> KrlPost::CheckTexts(const Arm&, const PostSettings& settings) const {
  return KrlReader({}, settings, options_).CheckTexts();
}

MotionProgram KrlPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  return KrlReader(files, settings, options_).Read({".src"});
}

}  // namespace millpose
