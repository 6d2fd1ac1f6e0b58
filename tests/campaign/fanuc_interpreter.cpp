// SPDX-License-Identifier: GPL-3.0-or-later
// FANUC R-30iB as it runs LS programs, after the HandlingTool operator's manual (V9.x); what it leaves open
// is said at each rule (docs/fanuc.md).
#include <fmt/format.h>

#include <cmath>

#include "base/units.hpp"
#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

constexpr double kHeight = 1045;  // mm, of axis 2: where the controller's world is above the foot

/// P[n] of one program.
struct Position {
  int uf = 0, ut = 0;
  bool joints = false;
  std::string config;  // three letters
  std::array<int, 3> turns{};
  std::array<double, 6> six{};  // X, Y, Z, W, P, R or J1…J6
  std::map<std::string, double> beside;
};

/// A program of the controller: its name, numbered lines, positions.
struct Program {
  std::string name, groups;
  std::vector<std::pair<int, std::string>> lines;
  std::map<int, Position> positions;
  std::string open;
};

/// The text loader: what it does not know it does not load.
class Loader {
 public:
  explicit Loader(const std::string& text) : lines_(LinesOf(text)) {}

  Program Load(int& line) {
    Program program;
    size_t i = 0;
    const auto next = [&] {
      while (i < lines_.size() && Cursor(lines_[i]).Done()) ++i;
      line = static_cast<int>(i) + 1;
      if (i == lines_.size()) throw Refusal{"/END is missing"};
      return Upper(lines_[i++]);
    };
    Cursor first(next());
    first.Need(first.Take("/PROG"), "/PROG");
    program.name = first.Name();
    first.Need(!program.name.empty() && first.Done(), "a program's name");
    Cursor section(next());
    section.Need(section.Take("/ATTR") && section.Done(), "/ATTR");
    std::string text = next();
    for (; Cursor(text).Peek() != '/'; text = next()) Attribute(text, program);
    if (Cursor appl(text); appl.Take("/APPL")) {
      appl.Need(appl.Done(), "/APPL");
      text = next();
      if (Cursor(text).Peek() != '/') program.open = "what an application's header switches on";
      while (Cursor(text).Peek() != '/') text = next();
    }
    Cursor body(text);
    body.Need(body.Take("/MN") && body.Done(), "/MN");
    for (text = next(); Cursor(text).Peek() != '/'; text = next()) Statement(text, line, program);
    Cursor data(text);
    data.Need(data.Take("/POS") && data.Done(), "/POS");
    std::string records;
    for (text = next(); Cursor(text).Peek() != '/'; text = next()) records += text + " ";
    Cursor end(text);
    end.Need(end.Take("/END") && end.Done(), "/END");
    for (; i < lines_.size(); ++i)
      if (!Cursor(lines_[i]).Done()) throw Refusal{"behind /END"};
    for (Cursor at(records); !at.Done();) Record(at, program);
    return program;
  }

 private:
  static void Attribute(const std::string& text, Program& program) {
    static const std::set<std::string> known = {
        "OWNER",         "COMMENT",       "PROG_SIZE",     "CREATE",       "MODIFIED",
        "FILE_NAME",     "VERSION",       "LINE_COUNT",    "MEMORY_SIZE",  "PROTECT",
        "TCD",           "STACK_SIZE",    "TASK_PRIORITY", "TIME_SLICE",   "BUSY_LAMP_OFF",
        "ABORT_REQUEST", "PAUSE_REQUEST", "DEFAULT_GROUP", "CONTROL_CODE", "LOCAL_REGISTERS"};
    Cursor at(text);
    const std::string name = at.Name();
    if (!known.contains(name)) program.open = "an attribute that nobody knows";
    if (name != "DEFAULT_GROUP") return;
    at.Need(at.TakeChar('='), "=");
    program.groups = Squeezed(at.Rest());
  }

  static void Statement(const std::string& text, int line, Program& program) {
    Cursor at(text);
    if (at.Peek() != ':') at.Need(at.Number().has_value(), "a line's number");
    at.Need(at.TakeChar(':'), ":");
    std::string rest = at.Rest();
    const size_t end = rest.find(';');
    if (end == std::string::npos) throw Refusal{"; is missing"};
    if (!Cursor(rest.substr(end + 1)).Done()) program.open = "what stands behind the ; of a line";
    program.lines.emplace_back(line, rest.substr(0, end));
  }

  static int Whole(Cursor& at, const char* what) {
    const auto number = at.Number();
    at.Need(number && *number == std::floor(*number) && std::abs(*number) < 1e6, what);
    return static_cast<int>(*number);
  }

  static double Value(Cursor& at, const char* unit) {
    at.Need(at.TakeChar('='), "=");
    const auto value = at.Number();
    at.Need(value && at.Take(unit), unit);
    return *value;
  }

  /// P[1]{ GP1: UF : 1, UT : 1, CONFIG : 'N U T, 0, 0, 0', X = 1 mm, … };
  static void Record(Cursor& at, Program& program) {
    at.Need(at.Take("P") && at.TakeChar('['), "P[");
    const int number = Whole(at, "a position's number");
    if (at.TakeChar(':')) at.Need(at.Quoted().has_value(), "a position's name");
    at.Need(at.TakeChar(']') && at.TakeChar('{'), "]{");
    Position position;
    at.Need(at.Take("GP1") && at.TakeChar(':'), "GP1:");
    Frames(at, position);
    position.joints = !at.Take("CONFIG");
    if (!position.joints) Config(at, position);
    const char* const poses[] = {"X", "Y", "Z", "W", "P", "R"};
    const char* const joints[] = {"J1", "J2", "J3", "J4", "J5", "J6"};
    for (size_t i = 0; i < 6; ++i) {
      if (i > 0) at.Need(at.TakeChar(','), ",");
      at.Need(at.Take(position.joints ? joints[i] : poses[i]), "the next value");
      position.six[i] = Value(at, position.joints || i > 2 ? "DEG" : "MM");
    }
    if (at.TakeChar(',')) {
      at.Need(at.Take("E1"), "E1");
      position.beside["E1"] = Value(at, "MM");
    }
    if (at.Take("GP2")) {
      at.Need(at.TakeChar(':'), ":");
      Frames(at, position);
      at.Need(at.Take("J1"), "J1");
      position.beside["GP2_J1"] = Value(at, "DEG");
    }
    at.Need(at.TakeChar('}') && at.TakeChar(';'), "};");
    if (!program.positions.emplace(number, position).second) throw Refusal{"a position twice"};
  }

  static void Frames(Cursor& at, Position& position) {
    at.Need(at.Take("UF") && at.TakeChar(':'), "UF:");
    position.uf = Whole(at, "a frame's number");
    at.Need(at.TakeChar(',') && at.Take("UT") && at.TakeChar(':'), "UT:");
    position.ut = Whole(at, "a tool's number");
    at.Need(at.TakeChar(','), ",");
  }

  static void Config(Cursor& at, Position& position) {
    at.Need(at.TakeChar(':') && at.TakeChar('\''), "'");
    for (const char* pair : {"FN", "UD", "TB"}) {
      const std::string letter = at.Name();
      at.Need(letter.size() == 1 && (letter[0] == pair[0] || letter[0] == pair[1]), "a letter of CONFIG");
      position.config += letter;
    }
    for (int& turn : position.turns) {
      at.Need(at.TakeChar(','), ",");
      turn = Whole(at, "a turn number");
    }
    at.Need(at.TakeChar('\'') && at.TakeChar(','), "',");
  }

  const std::vector<std::string> lines_;
};

/// The controller's joints of a KUKA arm that FANUC would run: its own zero and senses, J3 against the level.
Joints OfController(const Eigen::Matrix<double, 6, 1>& degrees) {
  Joints a = degrees * kRadPerDeg;
  a[0] = -a[0];
  a[1] = degrees[1] * kRadPerDeg - kPi / 2;
  a[2] = kPi / 2 - degrees[2] * kRadPerDeg - degrees[1] * kRadPerDeg;
  a[4] = -a[4];
  return a;
}
/// J4, J5, J6 of the arm's angles (degrees).
double WristOf(const Joints& q, int axis) { return (axis == 5 ? -q[4] : q[axis - 1]) * kDegPerRad; }

class Fanuc : public Mover {
 public:
  Fanuc(const Files& files, const Machine& machine) : Mover(machine) {
    for (const auto& [name, text] : files) {
      files_[Upper(name.substr(0, name.rfind('.')))] = text;
      // The one that calls the others.
      if (main_.empty() || name.size() < main_.size() + 3) main_ = Upper(name.substr(0, name.rfind('.')));
    }
  }

  Trace Run() {
    try {
      for (const auto& [name, text] : files_) {
        Program program = Loader(text).Load(line);
        if (!program.open.empty()) trace.open = program.open;
        if (program.name != name && name == main_) trace.open = "a program of another name";
        programs_[name == main_ ? main_ : program.name] = std::move(program);
      }
      RunProgram(main_);
      Event(Step::Kind::kSwitch, "end");
    } catch (const Refusal& refusal) {
      trace.refused = fmt::format("{}: {}", line, refusal.why);
    }
    return std::move(trace);
  }

 private:
  void RunProgram(const std::string& name) {
    if (++depth_ > 8) throw Refusal{"calls too deep"};
    const Program* before = std::exchange(program_, &programs_.at(name));
    for (const auto& [number, statement] : program_->lines) {
      line = number;
      Do(statement);
    }
    program_ = before;
    --depth_;
  }

  void Do(const std::string& statement) {
    Cursor at(statement);
    if (at.Done()) return;
    if (at.Peek() == '!' || (at.TakeChar('-') && at.Peek() == '-')) {
      at.TakeChar(at.Peek());
      Mark(at.Rest());
      return;
    }
    const Cursor start = at;
    if (at.Take("J") || at.Take("L")) return Move(start, at);
    if (at.Take("UFRAME_NUM") || at.Take("UTOOL_NUM")) return Select(at, statement);
    if (at.Take("UFRAME") || at.Take("UTOOL")) return SetFrame(at, statement);
    if (at.Take("PR")) return Register(at);
    if (at.Take("DO")) return Output(at);
    if (at.Take("AO")) return Analog(at);
    if (at.Take("WAIT") || at.Take("PAUSE"))
      return static_cast<void>(Event(Step::Kind::kStop, Squeezed(statement)));
    if (at.Take("CALL")) return Call(at);
    for (const char* word : {"MESSAGE", "OVERRIDE", "PAYLOAD", "R", "GO", "RO", "LBL", "JMP", "END", "ABORT",
                             "IF", "SKIP CONDITION", "OFFSET CONDITION", "TIMER"}) {
      if (!at.Take(word)) continue;
      Event(Step::Kind::kSwitch, Squeezed(statement));
      return;
    }
    throw Refusal{"no statement: " + statement};
  }

  static int Index(Cursor& at) {
    at.Need(at.TakeChar('['), "[");
    const auto number = at.Number();
    at.Need(number && *number >= 1 && *number < 1e5 && *number == std::floor(*number), "a whole number");
    return static_cast<int>(*number);
  }

  void Select(Cursor& at, const std::string& statement) {
    if (at.TakeChar('[')) at.Need(at.Take("GP1") && at.TakeChar(']'), "GP1]");
    at.Need(at.TakeChar('='), "=");
    const auto number = at.Number();
    at.Need(number && *number == std::floor(*number) && at.Done(), "a whole number");
    (Cursor(statement).Take("UFRAME_NUM") ? uf_ : ut_) = static_cast<int>(*number);
  }

  void SetFrame(Cursor& at, const std::string& statement) {
    const int number = Index(at);
    at.Need(at.TakeChar(']') && at.TakeChar('=') && at.Take("PR"), "]=PR");
    const int pr = Index(at);
    at.Need(at.TakeChar(']') && at.Done(), "]");
    std::optional<Pose> value;
    if (const auto found = registers_.find(pr); found != registers_.end() && found->second.size() == 6) {
      const auto& n = found->second;
      value = Frame(n.at(1), n.at(2), n.at(3), Zyx(n.at(6), n.at(5), n.at(4)));
    }
    (Cursor(statement).Take("UFRAME") ? frames_ : tools_)[number] = value;
  }

  /// PR[n]=LPOS: X, Y, Z, W, P, R of where the arm stands, which nobody knows; then element by element.
  void Register(Cursor& at) {
    const int number = Index(at);
    if (at.TakeChar(']')) {
      at.Need(at.TakeChar('='), "=");
      if (!at.Take("LPOS") || !at.Done()) throw Refusal{"LPOS alone is known here"};
      registers_[number] = {};
      return;
    }
    at.Need(at.TakeChar(','), ",");
    const auto element = at.Number();
    at.Need(element && *element >= 1 && *element <= 9 && *element == std::floor(*element), "an element");
    at.Need(at.TakeChar(']') && at.TakeChar('='), "]=");
    const bool brackets = at.TakeChar('(');
    const auto value = at.Number();
    at.Need(value.has_value() && (*value >= 0 || brackets), "a constant, negative ones in brackets");
    if (brackets) at.Need(at.TakeChar(')'), ")");
    at.Need(at.Done(), "the end of the line");
    if (!registers_.contains(number)) trace.open = "what a register holds before the program";
    if (*element <= 6) registers_[number][static_cast<int>(*element)] = *value;
  }

  /// When the line before is done: at a motion that does not stop that is somewhere before its end.
  void Output(Cursor& at) {
    const int number = Index(at);
    at.Need(at.TakeChar(']') && at.TakeChar('='), "]=");
    const bool on = at.Take("ON");
    at.Need((on || at.Take("OFF")) && at.Done(), "ON or OFF");
    if (!trace.steps.empty() && !trace.steps.back().exact)
      trace.open = "where an output behind no stop is switched";
    Event(Step::Kind::kSwitch, fmt::format("DO[{}]={}", number, on));
  }

  void Analog(Cursor& at) {
    const int number = Index(at);
    at.Need(at.TakeChar(']') && at.TakeChar('='), "]=");
    const auto value = at.Number();
    at.Need(value && at.Done(), "a number");
    Event(Step::Kind::kSwitch, fmt::format("AO[{}]=S{}", number, *value));
  }

  void Call(Cursor& at) {
    const std::string name = at.Name();
    if (machine_.plant.contains(name)) {
      std::string arguments;
      if (at.TakeChar('(')) {
        arguments = at.Rest();
        at.Need(arguments.ends_with(')'), ")");
        arguments.pop_back();
      }
      at.Need(at.Done(), "the end of the line");
      PlantCall(name, arguments);
      uf_ = ut_ = -1;
      frames_.clear();
      tools_.clear();
      registers_.clear();
      return;
    }
    at.Need(programs_.contains(name) && name != main_ && at.Done(), "a program of the controller");
    RunProgram(name);
  }

  /// "L P[3] 8cm/min FINE", "J P[1] 20% FINE".
  void Move(const Cursor& start, Cursor& at) {
    const bool straight = Cursor(start).Take("L");
    at.Need(at.Take("P"), "P");
    const int number = Index(at);
    if (at.TakeChar(':')) {
      while (at.Peek() != ']' && at.Peek() != '\0') at.TakeChar(at.Peek());
    }
    at.Need(at.TakeChar(']'), "]");
    if (!program_->positions.contains(number)) throw Refusal{"no such position"};
    const Position& position = program_->positions.at(number);
    const auto speed = at.Number();
    at.Need(speed && *speed > 0, "a speed");
    if (*speed != std::floor(*speed)) trace.open = "decimals of a speed";
    const double unit = at.Take("MM/SEC") ? 60 : at.Take("CM/MIN") ? 10 : at.TakeChar('%') ? 0 : -1;
    if (unit < 0 || straight != (unit > 0)) throw Refusal{"a unit of the other motion"};
    if (*speed > (unit == 60 ? 2000 : unit == 10 ? 12000 : 100)) throw Refusal{"too fast"};
    const std::string how = at.Name();
    const bool fine = how == "FINE", smooth = how.starts_with("CNT"), region = how.starts_with("CR");
    at.Need((fine || smooth || region) && at.Done(), "FINE, CNT or CR");
    double blend = 0;
    if (!fine) {
      Cursor digits(how.substr(smooth ? 3 : 2));
      const auto n = digits.Number();
      digits.Need(n && digits.Done() && *n >= 0 && *n <= (smooth ? 100 : 1000) && *n == std::floor(*n),
                  "CNT0 to CNT100");
      blend = smooth && *n > 0 ? 1e3 : *n;
    }
    // Both must be those in force (INTP-252, INTP-253).
    if (position.uf != uf_ || position.ut != ut_) throw Refusal{"UF or UT is another"};
    if (!program_->groups.starts_with("1,")) throw Refusal{"the group is not the program's"};
    if (!position.beside.empty() && position.beside.contains("GP2_J1") &&
        !program_->groups.starts_with("1,1,"))
      throw Refusal{"group 2 is not the program's"};
    Step* step = straight ? Straight(position) : Together(position);
    if (step == nullptr) return;
    if (straight)
      step->feed = *speed * unit;
    else
      step->way_speed = *speed / 100;
    step->exact = fine;
    step->blend = blend;
    step->from_corner = true;
  }

  std::optional<Pose> FlangeOf(const Position& position) {
    if (machine_.base_number == 0 &&
        (!frames_.contains(uf_) || !frames_[uf_] || !tools_.contains(ut_) || !tools_[ut_]))
      return std::nullopt;
    Pose half = Pose::Identity();
    half.linear() = Zyx(180, 0, 0);
    Pose held_tool = machine_.X_FT;
    held_tool.linear() = held_tool.linear() * machine_.R_TC;
    const Pose height = Frame(0, 0, kHeight, Eigen::Matrix3d::Identity());
    const Pose base = machine_.base_number > 0 ? machine_.X_BP : height * *frames_[uf_];
    const Pose tool = machine_.base_number > 0 ? held_tool : Pose(half * *tools_[ut_]);
    const auto& n = position.six;
    return base * Frame(n[0], n[1], n[2], Zyx(n[5], n[4], n[3])) * tool.inverse();
  }

  Step* Straight(const Position& position) {
    for (const auto& [name, value] : position.beside)
      if (!external_.contains(name) || std::abs(external_.at(name) - value) > 1e-9) {
        Event(Step::Kind::kSwitch, "an axis moves that the controller does not count in");
        return nullptr;
      }
    if (position.joints) {
      const Joints q = OfController(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(position.six.data()));
      return &CutTo(ForwardFlange(machine_.arm, q));
    }
    const auto X_BF = FlangeOf(position);
    if (!X_BF) {
      Event(Step::Kind::kSwitch, "frames that nobody knows");
      return nullptr;
    }
    Step& step = CutTo(*X_BF);
    const int status = Status(machine_.arm, step.q);
    const std::string config = {(status & 4) != 0 ? 'F' : 'N', (status & 2) != 0 ? 'U' : 'D',
                                (status & 1) != 0 ? 'B' : 'T'};
    if (position.config != config) throw Refusal{"the configuration would change on a straight motion"};
    for (int i = 0; i < 3; ++i)
      if (std::abs(WristOf(step.q, i + 4) - 360 * position.turns[static_cast<size_t>(i)]) > 180.01)
        trace.open = "what another turn number does in L";
    return &step;
  }

  Step* Together(const Position& position) {
    for (const auto& [name, value] : position.beside) external_[name] = value;
    if (external_.size() < machine_.external.size()) {
      Event(Step::Kind::kSwitch, "from where the axes beside the arm stand");
      return nullptr;
    }
    if (position.joints)
      return &WayTo(OfController(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(position.six.data())));
    trace.open = "which letters of CONFIG another model has";
    const auto X_BF = FlangeOf(position);
    if (!X_BF) {
      Event(Step::Kind::kSwitch, "frames that nobody knows");
      return nullptr;
    }
    const int status = (position.config[0] == 'F' ? 4 : 0) | (position.config[1] == 'U' ? 2 : 0) |
                       (position.config[2] == 'B' ? 1 : 0);
    return &WayTo(*X_BF, status, std::nullopt);
  }

  std::map<std::string, std::string> files_;
  std::string main_;
  std::map<std::string, Program> programs_;
  const Program* program_ = nullptr;
  std::map<int, std::map<int, double>> registers_;     // elements by number, Cartesian
  std::map<int, std::optional<Pose>> frames_, tools_;  // empty: nobody knows
  int uf_ = -1, ut_ = -1;
  int depth_ = 0;
};

}  // namespace

Trace RunFanuc(const Files& files, const Machine& machine) { return Fanuc(files, machine).Run(); }

}  // namespace millpose::campaign
