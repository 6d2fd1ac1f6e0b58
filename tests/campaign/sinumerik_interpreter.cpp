// SPDX-License-Identifier: GPL-3.0-or-later
// SINUMERIK 840D sl as it runs a program, after the Programming Manuals Fundamentals and Job Planning and,
// for words of SINUMERIK ONE, NC programming (12/2019, 6FC5398-2EP40-0BA0); the sections are named at each
// rule.
#include <fmt/format.h>

#include "base/units.hpp"
#include "tests/campaign/runner.hpp"
#include "tests/campaign/sinumerik_groups.hpp"

namespace millpose::campaign {
namespace {

struct SinumerikBlock {
  std::map<std::string, double> words;  // addresses
  std::map<int, std::string> modes;     // of each group
  std::vector<double> m;
  std::optional<int> status, turn;
  bool Has(const std::string& word) const { return words.contains(word); }
};

class Sinumerik : public Mover {
 public:
  Sinumerik(const Files& files, const Machine& machine) : Mover(machine) {
    for (const auto& [name, text] : files) {
      files_[Upper(name.substr(0, name.rfind('.')))] = text;
      if (name.ends_with(".mpf")) main_ = Upper(name.substr(0, name.rfind('.')));
    }
  }

  Trace Run() {
    try {
      if (!RunFile(main_)) throw Refusal{"M30 is missing"};
      Event(Step::Kind::kSwitch, "end");
    } catch (const Refusal& refusal) {
      trace.refused = fmt::format("{}: {}", line, refusal.why);
    }
    return std::move(trace);
  }

 private:
  bool RunFile(const std::string& name) {
    if (++depth_ > 8) throw Refusal{"calls too deep"};
    const std::vector<std::string> lines = LinesOf(files_.at(name));
    CheckLabels(lines);
    for (size_t i = 0; i < lines.size(); ++i) {
      line = static_cast<int>(i) + 1;
      if (lines[i].size() > 512) throw Refusal{"a block of more than 512 characters"};  // "Blocks"
      if (RunLine(lines[i])) {
        --depth_;
        return true;
      }
    }
    --depth_;
    return false;
  }

  /// "Jumps": a label is one place of its program.
  static void CheckLabels(const std::vector<std::string>& lines) {
    std::set<std::string> labels;
    for (const std::string& text : lines) {
      Cursor at(Upper(WithoutComment(text)));
      const std::string name = at.Name();
      if (!name.empty() && at.TakeChar(':') && !labels.insert(name).second) throw Refusal{"a label twice"};
    }
  }

  /// "Comments": from ; on, not within a text.
  static std::string WithoutComment(const std::string& text) {
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '"') quoted = !quoted;
      if (text[i] == ';' && !quoted) return text.substr(0, i);
    }
    return text;
  }

  /// True at the end of the program.
  bool RunLine(const std::string& text) {
    const std::string code = WithoutComment(text);
    Cursor at(Upper(code));
    if (at.Done()) return false;
    text_ = code;
    if (at.TakeChar('/')) {  // "Skipping blocks": the operator decides
      if (at.Done()) return false;
      Event(Step::Kind::kSwitch, "skip");
    }
    Cursor start = at;
    if (at.TakeChar('N') && at.Number()) {
      if (at.Done()) return false;
      start = at;
    } else {
      at = start;
    }
    const std::string label = at.Name();
    if (!label.empty() && at.TakeChar(':')) {
      if (label.find('.') != std::string::npos) throw Refusal{"no name of a label"};
      if (at.Done()) return false;
      start = at;
    }
    at = start;
    if (Special(at, code)) return false;
    const SinumerikBlock block = Parse(at);
    return RunBlock(block);
  }

  /// Blocks that are one statement.
  bool Special(Cursor& at, const std::string& code) {
    const Cursor start = at;
    if (at.Take("MSG")) {  // "Messages": with the next block, no stop
      at.Need(at.TakeChar('('), "(");
      std::string rest;
      if (!at.TakeChar(')')) {
        rest = at.Rest();
        at.Need(std::count(rest.begin(), rest.end(), '"') == 2, "one text");
        at.Need(rest.front() == '"' && Squeezed(rest.substr(rest.rfind('"'))) == "\")", "a text and )");
      } else {
        at.Need(at.Done(), "the end of the block");
      }
      const size_t events = trace.steps.size();
      Mark("MSG(" + rest);
      if (trace.steps.size() == events) Event(Step::Kind::kSwitch, "message " + Squeezed(rest));
      return true;
    }
    if (at.Take("TRAORI") || at.Take("TRAFOOF")) {
      // Function Manual Transformations: the frame is deselected, as by G500; which outlive it is machine
      // data.
      Alone(at);
      transformed_ = Upper(code).find("TRAORI") != std::string::npos;
      reframed_ = false;
      frame_ = Pose::Identity();
      return true;
    }
    if (at.Take("CYCLE832")) return Tolerances(at);
    if (at.Take("WHEN") || at.Take("ID") || at.Take("EVERY") || at.Take("DO")) {
      Action(Squeezed(Upper(code)));
      return true;
    }
    if (at.Take("STOPRE")) {  // "Preprocessing stop"
      Event(Step::Kind::kStop, "STOPRE");
      return true;
    }
    if (at.Peek() == '$') {
      SystemVariable(at, Upper(code));
      return true;
    }
    for (const char* word : {"GOTOF", "GOTOB", "GOTO", "GOTOS", "IF", "LOOP", "REPEAT", "RET", "EXTCALL",
                             "MCALL", "TRANS", "ATRANS", "ROT", "AROT", "DEF", "R1"}) {
      if (!at.Take(word)) continue;
      Event(Step::Kind::kSwitch, code);
      return true;
    }
    const std::string name = at.Name();
    if (machine_.plant.contains(name)) {
      std::string arguments;
      if (at.TakeChar('(')) {
        arguments = at.Rest();
        at.Need(arguments.ends_with(')'), ")");
        arguments.pop_back();
      }
      at.Need(at.Done(), "a block of its own");
      PlantCall(name, arguments);
      Forget();
      return true;
    }
    if (!name.empty() && at.Done() && files_.contains(name) && name != main_) {  // "Subprogram call"
      if (!RunFile(name)) throw Refusal{"M17 is missing"};
      return true;
    }
    at = start;
    return false;
  }

  /// What a program of the plant leaves set is not known.
  void Forget() {
    transformed_ = reframed_ = false;
    frame_.reset();
    frames_.clear();
    modal_ = {{49, "CP"}, {1, "G1"}};
    feed_ = 0;
    blend_ = angle_blend_ = 1e3;
  }

  static void Alone(Cursor& at) {
    if (at.TakeChar('(')) at.Need(at.TakeChar(')') || (at.Number() && at.TakeChar(')')), ")");
    at.Need(at.Done(), "a block of its own");
  }

  /// "Motion-synchronous actions": one output, on or off, with the next block that moves.
  void Action(const std::string& code) {
    const std::string begin = "WHEN TRUE DO $A_OUT[";
    const size_t open = code.find(begin);
    if (open == std::string::npos) return static_cast<void>(Event(Step::Kind::kSwitch, code));
    Cursor at(code.substr(open + begin.size()));
    const auto number = at.Number();
    at.Need(number && *number == static_cast<int>(*number), "a whole number");
    at.Need(at.TakeChar(']') && at.TakeChar('='), "]=");
    const auto value = at.Number();
    at.Need(value && at.Done(), "a value, and no more in this block");
    if (*value != 0 && *value != 1) trace.open = "a value of an output other than 0 and 1";
    Event(Step::Kind::kSwitch, fmt::format("A_OUT[{}]={}", *number, *value != 0));
  }

  /// "CYCLE832": the third value counts with _ORI_ kinds only.
  bool Tolerances(Cursor& at) {
    at.Need(at.TakeChar('('), "(");
    const auto position = at.Number();
    at.Need(position && at.TakeChar(','), "a tolerance");
    const std::string kind = at.Name();
    at.Need(!kind.empty() && at.TakeChar(','), "a kind");
    const auto turn = at.Number();
    at.Need(turn && at.TakeChar(')') && at.Done(), "an orientation tolerance and )");
    blend_ = kind == "_OFF" || *position <= 0 ? 1e3 : *position;
    angle_blend_ = kind == "_OFF" || *turn <= 0 ? 1e3 : *turn * kRadPerDeg;
    if (kind != "_OFF" && (*position <= 0 || *turn <= 0)) trace.open = "what a tolerance of 0 or less means";
    modal_[200] = kind;
    modal_[10] = modal_[30] = "as the machine's CUST_832";  // which sets rounding and compressor
    return true;
  }

  /// "Settable frames": $P_UIFR[n] counts when its G word is given next.
  void SystemVariable(Cursor& at, const std::string& code) {
    const std::string name = at.Name();
    if (name != "$P_UIFR") return static_cast<void>(Event(Step::Kind::kSwitch, Squeezed(code)));
    at.Need(at.TakeChar('['), "[");
    const auto index = at.Number();
    at.Need(index && *index == static_cast<int>(*index) && at.TakeChar(']') && at.TakeChar('='), "]=");
    const auto shift = Triple(at, "CTRANS");
    at.Need(at.TakeChar(':'), ":");
    const auto turn = Triple(at, "CROT");
    at.Need(at.Done(), "the end of the block");
    frames_[static_cast<int>(*index)] =
        Frame(shift[0], shift[1], shift[2], Zyx(turn[2], turn[1], turn[0]));  // CROT: Z, then Y, then X
  }

  static std::array<double, 3> Triple(Cursor& at, const char* function) {
    at.Need(at.Take(function) && at.TakeChar('('), function);
    std::array<double, 3> values{};
    for (int i = 0; i < 3; ++i) {
      if (i > 0) at.Need(at.TakeChar(','), ",");
      at.Need(at.TakeChar("XYZ"[i]) && at.TakeChar(','), "an axis");
      const auto value = at.Number();
      at.Need(value.has_value(), "a number");
      values[i] = *value;
    }
    at.Need(at.TakeChar(')'), ")");
    return values;
  }

  SinumerikBlock Parse(Cursor& at) {
    SinumerikBlock block;
    while (!at.Done()) ParseWord(at, block);
    return block;
  }

  /// "Addresses": a letter with its number, or a name = its value; each once in a block.
  void ParseWord(Cursor& at, SinumerikBlock& block) {
    const Cursor start = at;
    std::string name = at.Name();
    while (name.size() > 2 && name[0] == 'G' && name[1] == '0') name.erase(1, 1);  // "leading zeros"
    const auto group = SinumerikGroups().find(name);
    if (group != SinumerikGroups().end()) return Mode(block, group->second, name);
    if (name.size() == 4 && name[0] == 'G' && name[1] == '5' && name > "G504") return Mode(block, 8, name);
    if (name == "STAT" || name == "TU") {
      at.Need(at.TakeChar('='), "=");
      auto bits = at.Bits();
      if (!bits) bits = static_cast<int>(at.Number().value_or(-1));
      auto& target = name == "STAT" ? block.status : block.turn;
      if (*bits < 0 || target) throw Refusal{"STAT or TU"};
      target = bits;
      return;
    }
    if (name == "T") return Tool(at);
    at = start;
    std::string address(1, at.Peek());
    at.TakeChar(address[0]);
    if (address[0] < 'A' || address[0] > 'Z') throw Refusal{"an address expected"};
    if (at.AtBlank()) throw Refusal{"a blank behind an address"};
    auto value = at.Number();
    if (!value) {  // a name with '='
      at = start;
      address = at.Name();
      at.Need(!address.empty() && at.TakeChar('='), "=");
      value = at.Number();
      at.Need(value.has_value(), "a number");
      const bool known = IsExternal(address) || address.size() == 1 || address.starts_with("RA") ||
                         address == "OTOL" || address == "CTOL";
      if (!known) throw Refusal{"unknown address " + address};
    }
    if (at.Take("EX")) value = *value * std::pow(10, at.Number().value_or(0));  // "Exponents"
    if (address == "M") return block.m.push_back(*value);
    if (address == "G" || address == "L" || address == "E") throw Refusal{"unknown " + address};
    if (!block.words.emplace(address, *value).second) throw Refusal{"an address twice: " + address};
  }

  bool IsExternal(const std::string& address) const {
    return std::find(machine_.external.begin(), machine_.external.end(), address) != machine_.external.end();
  }

  static void Mode(SinumerikBlock& block, int group, const std::string& name) {
    if (!block.modes.emplace(group, name).second) throw Refusal{"two words of one group"};
  }

  /// "Tool change": which tool's length counts.
  void Tool(Cursor& at) {
    at.Need(at.TakeChar('='), "=");
    const auto name = at.Quoted();
    at.Need(name.has_value(), "a name");
    if (text_.find('"' + machine_.tool_name + '"') == std::string::npos)
      trace.open = "whether the case of a tool's name counts";
    if (tool_ == *name) return;
    tool_ = *name;
    Event(Step::Kind::kSwitch, "T " + tool_);
  }

  bool RunBlock(const SinumerikBlock& block) {
    if (block.m.size() > 5) throw Refusal{"more than five M"};  // "M functions"
    const auto mode = [&](int group) {
      return block.modes.contains(group) ? block.modes.at(group) : std::string();
    };
    for (const auto& [group, word] : block.modes)
      if (group != 2 && group != 9 && group != 11) modal_[group] = word;
    if (!mode(8).empty()) SelectFrame(mode(8));
    if (block.Has("D")) modal_[201] = fmt::format("D{}", block.words.at("D"));
    if (block.Has("S")) Spindle(fmt::format("S{:.0f}", block.words.at("S")));
    if (mode(2) == "G4") {  // "Dwell time": in a block of its own, F is its time
      if (!block.Has("F") && !block.Has("S")) throw Refusal{"G4 needs F or S"};
      Event(Step::Kind::kStop, "G4");
    } else if (!mode(2).empty()) {
      Event(Step::Kind::kSwitch, mode(2));
    } else {
      if (block.Has("F")) feed_ = block.words.at("F");
      if (feed_ < 0) throw Refusal{"a negative feed"};
      Move(block, mode(11) == "G9", mode(9));
    }
    return RunM(block);
  }

  void Spindle(const std::string& speed) {
    speed_ = speed;
    if (turning_) Event(Step::Kind::kSwitch, speed);
  }

  bool RunM(const SinumerikBlock& block) {
    bool end = false;
    for (const double m : block.m) {
      if (m == 0 || m == 1) {
        Event(Step::Kind::kStop, fmt::format("M{}", m));  // "Programmed stop"
      } else if (m == 2 || m == 17 || m == 30) {
        if ((m == 17) != (depth_ > 1)) throw Refusal{"another end of the program"};
        end = true;
      } else if (m == 6) {  // "Tool change": the motion stops for it
        Event(Step::Kind::kStop, "M6");
      } else {
        turning_ = m == 3 || m == 4 || (turning_ && m != 5);
        Event(Step::Kind::kSwitch, fmt::format("M{} {}", m, m == 3 || m == 4 ? speed_ : ""));
      }
    }
    return end;
  }

  void SelectFrame(const std::string& word) {
    const int number = std::stoi(word.substr(1));
    const int index = number == 500 ? 0 : number < 100 ? number - 53 : number - 500;
    frame_ = frames_.contains(index) ? std::optional(frames_.at(index)) : std::nullopt;
    if (index == 0) frame_ = Pose::Identity();
    reframed_ = true;
  }

  /// `rounds`: tolerances and compressor count at one of its ends.
  std::string Modes(bool pose, bool rounds) const {
    std::string text;
    for (const auto& [group, word] : modal_) {
      if (group == 1 || group == 10 || group == 49) continue;
      if (!rounds && (group == 200 || group == 30)) continue;
      if (!pose && (group == 8 || group == 25 || group == 50 || group == 51)) continue;
      text += word + " ";
    }
    return text + (pose && reframed_ ? "framed" : "");
  }

  void Move(const SinumerikBlock& block, bool exact, const std::string& unframed) {
    bool axes = false, pose = false;
    for (const auto& [address, value] : block.words) {
      axes = axes || address.starts_with("RA") || IsExternal(address);
      pose = pose || (address.size() == 1 && std::string("XYZABC").find(address) != std::string::npos);
      if (address == "OTOL") angle_blend_ = value * kRadPerDeg;
      if (address == "CTOL") blend_ = value;
    }
    if (axes && pose) throw Refusal{"axes and a pose in one block"};
    if ((axes || pose) && modal_[1] != "G0" && modal_[1] != "G1")
      throw Refusal{modal_[1] + " without its words"};
    if (axes) MoveAxes(block, unframed);
    if (pose) MovePose(block, exact, unframed);
    for (const auto& [address, value] : block.words)
      if (!axes && !pose && address.size() > 2 && address != "OTOL" && address != "CTOL")
        throw Refusal{address};
  }

  /// "PTP", "Axes": without transformation every axis by its name.
  void MoveAxes(const SinumerikBlock& block, const std::string& unframed) {
    if (transformed_) throw Refusal{"axes of the transformation cannot be programmed"};
    Joints q = this->q().value_or(Joints::Zero());
    int given = 0;
    for (int i = 0; i < 6; ++i) {
      const auto word = block.words.find("RA" + std::to_string(i + 1));
      if (word == block.words.end()) continue;
      q[i] = (modal_[14] == "G91" ? q[i] * kDegPerRad : 0) * kRadPerDeg + word->second * kRadPerDeg;
      ++given;
    }
    for (const auto& [address, value] : block.words)
      if (IsExternal(address)) external_[address] = value;
    for (const auto& [address, value] : block.words)
      if (!IsExternal(address) && address.starts_with("RA") &&
          (address.size() != 3 || address[2] < '1' || address[2] > '6'))
        throw Refusal{"no axis " + address};
    if ((given < 6 && !this->q()) || external_.size() < machine_.external.size()) {
      Event(Step::Kind::kSwitch, "from where the machine stands");
      return;
    }
    if (modal_[1] != "G0") {
      Event(Step::Kind::kSwitch, "axes not with G0");
      return;
    }
    WayTo(q).words = Modes(false, false) + unframed;
    last_.clear();
    rounded_ = false;
  }

  void MovePose(const SinumerikBlock& block, bool exact, const std::string& unframed) {
    for (const char* name : {"X", "Y", "Z", "A", "B", "C"}) {
      if (block.Has(name)) last_[name] = block.words.at(name) + (modal_[14] == "G91" ? last_[name] : 0);
      if (!last_.contains(name)) {
        Event(Step::Kind::kSwitch, "from where the machine stands");
        return;
      }
    }
    if (!transformed_ || !frame_ || !unframed.empty()) {
      Event(Step::Kind::kSwitch, "a pose without transformation or frame");
      return;
    }
    const double scale = modal_[13] == "G700" || modal_[13] == "G70" ? 25.4 : 1;
    const Eigen::Matrix3d R =
        Oriented(machine_.rotation, last_["A"], last_["B"], last_["C"]) * machine_.R_TC.transpose();
    const Pose X_BF = *frame_ * Frame(last_["X"] * scale, last_["Y"] * scale, last_["Z"] * scale, R) *
                      machine_.X_FT.inverse();
    const bool rapid = modal_[1] == "G0", ptp = modal_[49] == "PTP";
    if (ptp != rapid) {
      Event(Step::Kind::kSwitch, "straight at rapid, or joints at a feed");
      return;
    }
    if (ptp) {
      WayTo(X_BF, block.status, block.turn).words = Modes(true, false);
      rounded_ = false;
      return;
    }
    if (feed_ <= 0) throw Refusal{"G1 needs F"};
    Step& step = CutTo(X_BF);
    step.feed = feed_ * scale;
    step.exact = exact || modal_[10] == "G60";
    step.blend = modal_[10] == "G642" || modal_[10] == "G645" || modal_[10] == "G643" ? blend_ : 1e3;
    step.angle_blend = angle_blend_;
    step.words = Modes(true, !step.exact || rounded_);
    if (!step.exact || rounded_) step.aside = modal_[10];
    rounded_ = !step.exact;
  }

  std::map<std::string, std::string> files_;
  std::string main_;
  std::map<int, std::string> modal_ = {{49, "CP"}, {1, "G1"}};  // by group; 200 tolerances, 201 D
  std::map<int, Pose> frames_;
  std::optional<Pose> frame_;
  std::map<std::string, double> last_;
  std::string speed_, tool_, text_;  // the present block as it stands
  double feed_ = 0, blend_ = 1e3, angle_blend_ = 1e3;
  bool transformed_ = false, reframed_ = false, turning_ = false;
  bool rounded_ = false;  // the motion before goes on into the next one
  int depth_ = 0;
};

}  // namespace

Trace RunSinumerik(const Files& files, const Machine& machine) { return Sinumerik(files, machine).Run(); }

}  // namespace millpose::campaign
