// SPDX-License-Identifier: GPL-3.0-or-later
// KRL as the KRC4 runs it, after KUKA System Software 8.3, Operating and Programming Instructions for System
// Integrators (KSS 8.3 SI V4), chapter "Programming for user group Expert (KRL syntax)"; its sections are
// named at each rule. What BAS does: bas.src of the controller, as the issue's facts have it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "tests/campaign/krl_files.hpp"
#include "tests/campaign/krl_values.hpp"

namespace millpose::campaign {
namespace {

class Krl : public Mover {
 public:
  Krl(const Files& files, const Machine& machine) : Mover(machine) {
    for (const auto& [name, text] : files)
      if (name.ends_with(".src")) files_[Upper(name.substr(0, name.size() - 4))] = text;
  }

  Trace Run() {
    try {
      RunFile(KrlMain(files_));
      Event(Step::Kind::kSwitch, "end");
    } catch (const Standing&) {
      Event(Step::Kind::kStop, "stands for ever");
    } catch (const Refusal& refusal) {
      trace.refused = fmt::format("{}: {}", line, refusal.why);
    }
    return std::move(trace);
  }

 private:
  struct Standing {};  // a loop without an end

  /// "Structure of a KRL program": & lines, DEF NAME ( ), declarations, statements, END; nothing behind it.
  void RunFile(const std::string& name) {
    if (++depth_ > 8) throw Refusal{"calls too deep"};
    const std::vector<std::string> lines = LinesOf(files_.at(name));
    CheckKrlLabels(lines);
    bool defined = false, ended = false;
    for (size_t i = 0; i < lines.size(); ++i) {
      line = static_cast<int>(i) + 1;
      const std::string text = lines[i];
      if (!defined && text.starts_with("&")) continue;
      const std::string code = Upper(text.substr(0, text.find(';')));
      Cursor at(code);
      if (at.Done()) {
        Mark(text);
        continue;
      }
      if (ended) throw Refusal{"a statement after END"};
      if (!defined) {
        at.Need(at.Take("DEF"), "DEF");
        at.Need(at.Name() == name, "the file's name");
        at.Need(at.TakeChar('(') && at.TakeChar(')') && at.Done(), "( )");
        defined = true;
      } else if (at.Take("END")) {
        at.Need(at.Done(), "the end of the line");
        if (ifs_ > 0 || skipped_ > 0 || loops_ > 0) throw Refusal{"ENDIF or ENDLOOP is missing"};
        ended = true;
      } else if (at.Take("DECL")) {  // "Variables and declarations": before the first statement
        if (begun_) throw Refusal{"a declaration behind statements"};
        variables_.Declare(at);
      } else if (!Branch(at)) {
        begun_ = true;
        Statement(at, code);
        line = static_cast<int>(i) + 1;
      }
    }
    if (!ended) throw Refusal{"END is missing"};
    if (spline_) throw Refusal{"ENDSPLINE is missing"};
    --depth_;
  }

  /// "IF … THEN … ENDIF": true when the line belongs to one, or is passed over.
  bool Branch(Cursor& at) {
    if (skipped_ > 0) {
      skipped_ += at.Take("IF") ? 1 : at.Take("ENDIF") ? -1 : 0;
      return true;
    }
    if (at.Take("IF")) {
      begun_ = true;
      ++(variables_.Holds(at) ? ifs_ : skipped_);
      return true;
    }
    if (!at.Take("ENDIF")) return false;
    at.Need(at.Done() && ifs_-- > 0, "IF before");
    return true;
  }

  /// "LOOP … ENDLOOP": nothing that the posts write leaves one.
  void Loop(Cursor& at, bool begins) {
    at.Need(at.Done() && (begins || loops_ > 0), "LOOP before");
    if (!begins) throw Standing{};
    ++loops_;
  }

  void Statement(Cursor& at, const std::string& code) {
    const Cursor start = at;
    if (spline_ && !(at.Take("SLIN") || at.Take("ENDSPLINE") || at.Take("TRIGGER")))
      throw Refusal{"not allowed within SPLINE"};  // "SPLINE … ENDSPLINE"
    at = start;
    if (at.Take("PTP")) return Ptp(at);
    if (at.Take("LIN")) return Lin(at, false);
    if (at.Take("SLIN")) return Lin(at, true);
    if (at.Take("SPLINE")) return BeginSpline(at);
    if (at.Take("ENDSPLINE")) return EndSpline(at);
    if (at.Take("TRIGGER")) return Trigger(at);
    if (at.Take("BAS")) return Bas(at);
    if (at.Take("HALT") || at.Take("WAIT")) return Wait(at, code);
    if (at.Take("GLOBAL") || at.Take("INTERRUPT")) return Interrupt(at, code);
    if (at.Peek() == '$') return Assign(at, code);
    if (at.Take("LOOP")) return Loop(at, true);
    if (at.Take("ENDLOOP")) return Loop(at, false);
    if (variables_.Assign(at, machine_.robroot)) return;
    // Valid statements that change what runs ("Program execution control", "Motion programming").
    for (const char* word : {"GOTO", "RETURN", "EXIT", "CONTINUE", "LIN_REL", "PTP_REL", "CIRC", "SPL",
                             "SCIRC", "SPTP", "PULSE", "BRAKE"}) {
      if (!at.Take(word)) continue;
      Event(Step::Kind::kSwitch, code);
      return;
    }
    const std::string name = at.Name();
    at.Need(!name.empty(), "a statement");
    if (name.size() > 24) throw Refusal{"a name of more than 24 characters"};
    if (name.find('.') != std::string::npos) throw Refusal{"no name"};
    if (at.TakeChar(':')) return at.Need(at.Done(), "the end of the line");
    if (machine_.plant.contains(name)) return Plant(at, name);
    at.Need(at.TakeChar('(') && at.TakeChar(')') && at.Done(), "( )");
    if (!files_.contains(name)) throw Refusal{"unknown program " + name};
    RunFile(name);
  }

  /// What a program of the plant leaves set is not known.
  void Plant(Cursor& at, const std::string& name) {
    at.Need(at.TakeChar('('), "(");
    std::string arguments = at.Rest();
    at.Need(arguments.ends_with(')'), ")");
    arguments.pop_back();
    PlantCall(name, arguments);
    Reset();
  }

  /// bas.src: all of these as delivered, base and tool by the plant.
  void Reset() {
    base_.reset();
    tool_.reset();
    modal_ = {{"$ORI_TYPE", "#VAR"}};
    feed_ = 2;
    turn_ = {200, 200};
    stated_.clear();
    blend_ = 3;
    advance_ = 3;
    way_speed_ = 1;
  }

  /// "WAIT SEC", "WAIT FOR", "HALT": all stop the advance run, so the motion before ends exactly.
  void Wait(Cursor& at, const std::string& code) {
    if (code.find("HALT") != std::string::npos) {
      at.Need(at.Done(), "the end of the line");
    } else if (at.Take("SEC")) {
      const auto seconds = at.Number(true);
      at.Need(seconds.has_value() && at.Done(), "seconds");
      if (*seconds <= 0) return;  // "values ≤ 0 have no effect"
    } else {
      at.Need(at.Take("FOR") && !at.Done(), "FOR and a condition");
    }
    Event(Step::Kind::kStop, Squeezed(code));
  }

  /// "Interrupt programming": no motion; what runs on a stop message is the controller's own.
  void Interrupt(Cursor& at, const std::string& code) {
    const std::string text = Squeezed(code);
    const bool known =
        text == "GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM()" || text == "INTERRUPT ON 3";
    if (!known) Event(Step::Kind::kSwitch, text);
    at.Rest();
  }

  void Bas(Cursor& at) {
    at.Need(at.TakeChar('(') && at.TakeChar('#') && !at.AtBlank(), "(#");
    const std::string command = at.Name();
    at.Need(at.TakeChar(','), ",");
    const auto value = at.Number(true);
    at.Need(value.has_value() && at.TakeChar(')') && at.Done(), "a number and )");
    if (command == "INITMOV" && *value != 0)
      trace.open = "what a plant's BAS does with the number of #INITMOV";
    if (command == "INITMOV") {
      Reset();
    } else if (command == "TOOL" || command == "BASE") {  // bas.src: with $LOAD, $ACT_TOOL, $ACT_BASE
      const int number = command == "TOOL" ? machine_.tool_number : machine_.base_number;
      const bool known = number > 0 && *value == number;
      (command == "TOOL" ? tool_ : base_) =
          !known ? std::nullopt : std::optional(command == "TOOL" ? Tool() : machine_.X_BP);
    } else if (command == "VEL_PTP") {
      if (*value <= 0 || *value > 100) throw Refusal{"a speed of 1 to 100 % expected"};
      way_speed_ = *value / 100;
    } else if (command == "VEL_CP") {  // bas.src: $VEL.CP
      feed_ = Positive(*value);
    } else if (command == "ACC_CP") {  // bas.src: $ACC.CP
      Set("$ACC.CP", *value);
    } else if (command == "ACC_PTP") {  // $ACC_AXIS of all: how long ways take
      if (*value <= 0 || *value > 100) throw Refusal{"an acceleration of 1 to 100 % expected"};
    } else {
      modal_["BAS " + command] = fmt::format("{}", *value);
    }
  }

  /// "Variables and declarations", system variables.
  void Assign(Cursor& at, const std::string& code) {
    const std::string name = at.Name();
    const bool indexed = at.Peek() == '[';
    if (indexed || name == "$OUT" || name == "$ANOUT") {  // "Inputs/outputs": stops the advance run
      if (code.find('=') == std::string::npos) throw Refusal{"= expected"};
      Output(at, name);
      return;
    }
    static const std::set<std::string> known = {
        "$BASE",     "$TOOL",      "$ORI_TYPE", "$VEL.CP",   "$VEL.ORI1", "$VEL.ORI2", "$APO.CDIS",
        "$APO.CVEL", "$APO.CORI",  "$APO.CPTP", "$ADVANCE",  "$ACC.CP",   "$ACC.ORI1", "$ACC.ORI2",
        "$OV_PRO",   "$CIRC_TYPE", "$IPO_MODE", "$ACT_TOOL", "$ACT_BASE", "$LOAD.M",   "$LOAD"};
    if (!known.contains(name)) throw Refusal{"an unknown variable " + name};
    at.Need(at.TakeChar('='), "=");
    if (name == "$BASE" || name == "$TOOL") {
      if (name == "$BASE") on_table_ = at.Take("EK");
      if (on_table_ && name == "$BASE") return static_cast<void>(base_ = MovingBase(at, machine_.coupled));
      if (name == "$BASE")
        base_ = FrameOf(at, "BASE_DATA", machine_.base_number, machine_.X_BP);
      else
        tool_ = FrameOf(at, "TOOL_DATA", machine_.tool_number, Tool());
      return;
    }
    if (name == "$LOAD") {
      load_ = Canonical(at);
      return;
    }
    if (name == "$ORI_TYPE" || name == "$CIRC_TYPE" || name == "$IPO_MODE") {
      const std::string word = at.Rest();
      if (name == "$CIRC_TYPE" && (word == "#BASE" || word == "#PATH")) return;  // no circle follows
      // As delivered, and as INITMOV leaves it; a moving base must have it stated.
      if (name == "$IPO_MODE" && word == "#BASE" && !machine_.coupled) return;
      modal_[name] = word;
      return;
    }
    const auto value = at.Number(true);
    at.Need(value.has_value() && at.Done(), "a number");
    if (name == "$VEL.CP")
      feed_ = Positive(*value);
    else if (name == "$VEL.ORI1" || name == "$VEL.ORI2")
      turn_[name.back() - '1'] = Positive(*value), stated_.insert(name);
    else if (name == "$APO.CDIS")
      blend_ = *value;
    else if (name == "$OV_PRO" && *value >= 1 && *value <= 100)
      return;  // the operator's too: all is slower alike
    else if (name == "$APO.CPTP" || name == "$APO.CVEL" || name == "$APO.CORI")
      return;  // of C_PTP, which is taken as far as it can go, C_VEL and C_ORI, which stand in `words`
    else if (name == "$ADVANCE")
      SetAdvance(*value);
    else
      Set(name, *value);  // $ACC, $APO.CVEL, …: as they are for every motion after
  }

  /// The base in the robot's foot, where the axes beside it stand as a target says.
  Pose BaseAt(const Fields& fields) const {
    if (!machine_.coupled) return *base_;
    const auto value = [&](const char* name) {
      if (!fields.contains(name)) throw Refusal{std::string("where is ") + name};
      return fields.at(name);
    };
    const Pose foot = machine_.robroot * Frame(0, value("E1"), 0, Zyx(0, 0, 0)) * machine_.carriage;
    const Pose table = machine_.root * Frame(0, 0, 0, Zyx(value("E2"), 0, 0)) * machine_.flange;
    return foot.inverse() * (on_table_ ? table * *base_ : *base_);
  }

  /// "Inputs/outputs": a whole number in brackets; stops the advance run.
  void Output(Cursor& at, const std::string& name) {
    at.Need(at.TakeChar('['), "[");
    const auto number = at.Number();
    at.Need(number && *number == static_cast<int>(*number) && at.TakeChar(']'), "a whole number and ]");
    at.Need(at.TakeChar('='), "=");
    const auto value = at.Number(true);
    const std::string word = value ? fmt::format("{:.0f}", *value) : at.Name();
    at.Need(!word.empty() && at.Done(), "a value");
    Event(Step::Kind::kSwitch, fmt::format("{}[{}]={}", name, *number, word));
  }

  /// What is set and not modelled. $ACC changes times at stops alone, by v/2a, which is far below a tenth of
  /// a second at milling feeds.
  void Set(const std::string& name, double value) {
    if (name.starts_with("$ACC") && !(value > 0)) throw Refusal{"an acceleration above 0 expected"};
    modal_[name] = fmt::format("{:.6f}", value);
  }

  static double Positive(double value) {
    if (!(value > 0)) throw Refusal{"a speed above 0 expected"};
    return value;
  }

  void SetAdvance(double value) {
    if (value < 0 || value > 5 || value != static_cast<int>(value))
      throw Refusal{"$ADVANCE of 0 to 5 expected"};
    advance_ = static_cast<int>(value);
  }

  /// A frame's values, or the number of one that the controller holds.
  std::optional<Pose> FrameOf(Cursor& at, const char* list, int number, const Pose& held) {
    if (at.Peek() == '{') return FrameLiteral(at);
    const std::string name = Squeezed(at.Rest());
    if (number > 0 && name == fmt::format("{}[{}]", list, number)) return held;
    modal_["frame"] += name;
    return std::nullopt;
  }

  /// The tool as the controller holds it.
  Pose Tool() const {
    Pose X_FC = machine_.X_FT;
    X_FC.linear() = X_FC.linear() * machine_.R_TC;
    return X_FC;
  }

  /// The flange for a target's fields; what is not given stays as it is ("PTP", "LIN": components may be left
  /// out).
  Pose Flange(Fields& fields) {
    Allow(fields, "XYZABC", true);
    if (!base_ || !tool_) {
      Event(Step::Kind::kSwitch, "base or tool are not known");
      return Pose::Identity();
    }
    for (const char* name : {"X", "Y", "Z", "A", "B", "C"})
      if (!fields.contains(name)) {
        if (!last_.contains(name)) throw Refusal{"a component that was never given"};
        fields[name] = last_[name];
      }
    last_ = fields;
    return BaseAt(fields) * PoseOf(fields) * tool_->inverse();
  }

  /// What a motion goes to; the axes beside the arm go there with it.
  Fields TargetOf(Cursor& at, std::initializer_list<const char*> types) {
    Fields fields = FieldsOf(at, types);
    for (const auto& [name, value] : fields)
      if (name[0] == 'E') external_[name] = value;
    return fields;
  }

  std::string Modes(bool accelerations) const {
    std::string words;
    for (const auto& [name, value] : modal_)
      if (name.starts_with("$ACC") == accelerations) words += name + "=" + value + " ";
    return words;
  }

  /// What is not modelled: accelerations, settings as the plant's BAS leaves them.
  std::string Aside() const {
    std::string words = Modes(true);
    for (const std::string& name : stated_) words += name + " ";
    return words + load_;
  }

  /// "PTP": axes or a pose with S and T; C_PTP rounds.
  void Ptp(Cursor& at) {
    Fields fields = TargetOf(at, {"E6AXIS", "AXIS", "E6POS", "POS", "FRAME"});
    const bool rounded = at.Take("C_PTP");
    if (rounded && (at.Take("C_DIS") || at.Take("C_VEL") || at.Take("C_ORI"))) {
    }
    at.Need(at.Done(), "the end of the line");
    Step* step = nullptr;
    if (fields.contains("A1") || fields.contains("A2") || fields.contains("A3")) {
      Joints q = this->q().value_or(Joints::Zero());
      for (const auto& [name, value] : fields) {
        if (name.size() == 2 && name[0] == 'A' && name[1] >= '1' && name[1] <= '6')
          q[name[1] - '1'] = value * kRadPerDeg;
        else if (name.size() != 2 || name[0] != 'E' || name[1] < '1' || name[1] > '6')
          throw Refusal{"no such field: " + name};
      }
      if (!this->q() && fields.size() < 6) throw Refusal{"the first motion must be complete"};
      last_.clear();
      step = &WayTo(q);
    } else {
      const Pose X_BF = Flange(fields);
      const auto bits = [&](const char* name) {
        return fields.contains(name) ? std::optional<int>(static_cast<int>(fields.at(name))) : std::nullopt;
      };
      step = &WayTo(X_BF, bits("S"), bits("T"));
    }
    step->way_speed = way_speed_;
    step->exact = !rounded || advance_ == 0;
    step->words = Modes(false);
    step->aside = Aside();
  }

  /// "LIN", "SLIN", "Approximate positioning": C_DIS by $APO.CDIS; without the advance run every point is
  /// exact.
  void Lin(Cursor& at, bool spline) {
    Fields fields = TargetOf(at, {"E6POS", "POS", "FRAME"});
    std::string how;
    if (!spline || !spline_)
      for (const char* word : {"C_DIS", "C_VEL", "C_ORI"})
        if (at.Take(word)) how = word;
    if (spline && !spline_ && at.Take("C_SPL")) how = "C_SPL";  // of single spline motions
    double feed = feed_;
    if (spline && at.Take("WITH")) {
      at.Need(at.Take("$VEL.CP") && at.TakeChar('='), "$VEL.CP =");
      feed = Positive(at.Number(true).value_or(0));
    }
    at.Need(at.Done(), "the end of the line");
    const Pose X_BF = Flange(fields);
    Step& step = CutTo(X_BF);
    step.feed = feed * 60000;
    step.turn_speed = std::min(turn_[0], turn_[1]) * kRadPerDeg;
    step.from_corner = true;
    step.blend = blend_;
    step.exact = (how.empty() && !spline_) || advance_ == 0 || (!spline_ && blend_ <= 0);
    if (spline_) step.blend = 0;
    step.words = Modes(false) + (how == "C_VEL" || how == "C_ORI" ? how : "");
    step.aside = Aside();
  }

  void BeginSpline(Cursor& at) {
    at.Need(at.Done() && !spline_, "the end of the line");
    spline_ = true;
  }

  void EndSpline(Cursor& at) {
    at.Need(at.Done() && spline_, "SPLINE before");
    spline_ = false;
    if (!trace.steps.empty()) trace.steps.back().exact = true;
  }

  /// "Path-related switching actions (=Trigger)": DISTANCE=0 where the motion begins, 1 where it ends.
  void Trigger(Cursor& at) {
    at.Need(at.Take("WHEN"), "WHEN");
    const bool path = at.Take("PATH");
    at.Need((path || at.Take("DISTANCE")) && at.TakeChar('='), "DISTANCE=");
    const auto distance = at.Number(true);
    at.Need(distance.has_value(), "a number");
    if (path) at.Take("ONSTART");
    at.Need(at.Take("DELAY") && at.TakeChar('='), "DELAY=");
    const auto delay = at.Number(true);
    at.Need(delay.has_value() && at.Take("DO"), "a number and DO");
    if (!path && *distance != 0 && *distance != 1) throw Refusal{"DISTANCE of 0 or 1 expected"};
    const std::string name = at.Name();
    if (name.empty()) throw Refusal{"an action expected"};
    Output(at, name);
    const long delayed = std::lround(*delay);
    if (static_cast<double>(delayed) != *delay) trace.open = "how DELAY, a whole number, is rounded";
    trace.steps.back().words += fmt::format(" after {} at {:.0f}", delayed, std::abs(*distance));
  }

  std::map<std::string, std::string> files_;
  std::map<std::string, std::string> modal_;  // what is set and not modelled: must be as it was
  std::set<std::string> stated_;              // speeds of turning, since INITMOV
  std::string load_;                          // $LOAD
  KrlVariables variables_;
  Fields last_;
  std::optional<Pose> base_, tool_;
  double feed_ = 2, blend_ = 3, way_speed_ = 1;
  std::array<double, 2> turn_ = {200, 200};
  int advance_ = 3, depth_ = 0;
  int ifs_ = 0, skipped_ = 0, loops_ = 0;  // that are open; skipped: within one that does not hold
  bool on_table_ = false;                  // the base moves with it
  bool spline_ = false, begun_ = false;    // a statement came
};

}  // namespace

Trace RunKrl(const Files& files, const Machine& machine) {
  Trace trace = Krl(files, machine).Run();
  // Where the controller's frame is another the program may check it and stand still.
  const std::vector<Pose> others = {Frame(0.02, 0, 0, Eigen::Matrix3d::Identity()),
                                    Frame(0, 0, -0.02, Eigen::Matrix3d::Identity()),
                                    Frame(0, 0, 0, Zyx(0.002, 0, 0)), Frame(0, 0, 0, Zyx(0, 0, -0.002))};
  const bool asks = std::any_of(files.begin(), files.end(), [](const auto& file) {
    return Upper(file.second).find("SYSROOT") != std::string::npos ||
           Upper(file.second).find("ROBROOT") != std::string::npos;
  });
  for (const Pose& other : asks ? others : std::vector<Pose>{}) {
    Machine off = machine;
    off.robroot = machine.robroot * other;
    const Trace there = Krl(files, off).Run();
    trace.guards += std::none_of(there.steps.begin(), there.steps.end(), [](const Step& step) {
      return step.kind == Step::Kind::kWay || step.kind == Step::Kind::kCut;
    });
  }
  return trace;
}

}  // namespace millpose::campaign
