// SPDX-License-Identifier: GPL-3.0-or-later
// RAPID as IRC5 and OmniCore run it, after ABB's RAPID reference manuals (kernel: modules, routines, data;
// instructions and data types A-Z); what they are named by stands at each rule. A module is checked as a
// whole when it is loaded.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "tests/campaign/rapid_values.hpp"

namespace millpose::campaign {
namespace {

/// A statement, or a comment that takes a whole line.
struct Statement {
  std::vector<RapidToken> tokens;
  std::string comment;
  int line = 0;
};

struct Module {
  std::string name;
  std::map<std::string, RapidValue> data;                    // by name; of each its type
  std::map<std::string, std::string> types;                  // PERS or CONST by name
  std::map<std::string, std::vector<Statement>> procedures;  // without parameters
};

class Rapid : public Mover {
 public:
  Rapid(const Files& files, const Machine& machine) : Mover(machine) {
    for (const auto& [name, text] : files) texts_[Upper(name.substr(0, name.size() - 4))] = text;
  }

  Trace Run() {
    try {
      LoadAll();
      Reset();
      Procedure("MAIN");
      Event(Step::Kind::kSwitch, "end");
    } catch (const Refusal& refusal) {
      trace.refused = fmt::format("{}: {}", line, refusal.why);
    }
    return std::move(trace);
  }

 private:
  /// Modules that the program loads itself are not there when it begins.
  void LoadAll() {
    std::set<std::string> later;
    for (const auto& [name, text] : texts_)
      for (const auto& [part, unused] : texts_)
        if (Upper(text).find("/" + part + ".MOD") != std::string::npos) later.insert(part);
    for (const auto& [name, text] : texts_)
      if (!later.contains(name)) LoadModule(name);
  }

  void LoadModule(const std::string& file) {
    Module module = Parse(texts_.at(file));
    // Whatever its name is, the module runs; its reader takes none but the file's.
    if (module.name != "MP_" + file) trace.open = "a module that is not named as its file";
    for (const auto& [name, loaded] : modules_) {
      if (loaded.name == module.name) throw Refusal{"module " + module.name + " is there already"};
      for (const auto& [routine, unused] : module.procedures)
        if (loaded.procedures.contains(routine)) throw Refusal{"routine " + routine + " is there already"};
    }
    modules_[file] = std::move(module);
  }

  /// "Modules": MODULE name, declarations of data, routines, ENDMODULE.
  Module Parse(const std::string& text) {
    RapidStream in(text);
    Module module;
    in.Need("MODULE");
    module.name = in.Identifier();
    while (!in.Take("ENDMODULE")) {
      line = in.Line();
      if (in.Take("PROC")) {
        ParseProcedure(in, module);
      } else {
        if (!in.Take("LOCAL")) in.Take("TASK");
        ParseData(in, module);
      }
    }
    in.SkipComments();
    if (!in.Done()) throw Refusal{"something behind ENDMODULE"};
    return module;
  }

  void ParseProcedure(RapidStream& in, Module& module) {
    const std::string name = in.Identifier();
    in.Need("(");
    in.Need(")");
    std::vector<Statement> body;
    for (bool ended = false; !ended;) {
      Statement statement;
      statement.line = line = in.Line();
      statement.comment = in.Comment();
      if (statement.comment.empty()) {
        if (in.Take("ENDPROC")) {
          ended = true;
          continue;
        }
        statement.tokens = in.Until(";");
      }
      body.push_back(statement);
    }
    if (module.data.contains(name) || !module.procedures.emplace(name, body).second)
      throw Refusal{name + " is declared twice"};
  }

  /// "Data declarations": constants and persistents have their value there.
  static void ParseData(RapidStream& in, Module& module) {
    const std::string kind = in.Identifier();
    if (kind != "CONST" && kind != "PERS" && kind != "VAR") throw Refusal{"a declaration expected"};
    const std::string type = in.Identifier(), name = in.Identifier();
    in.Need(":=");
    RapidArguments value(in.Until(";"));
    const RapidValue read = ReadRapidValue(type, value);
    value.End();
    if (!module.data.emplace(name, read).second) throw Refusal{name + " is declared twice"};
    module.types[name] = kind;
  }

  void Procedure(const std::string& name) {
    if (++depth_ > 8) throw Refusal{"calls too deep"};
    const Module* found = nullptr;
    for (const auto& [file, module] : modules_)
      if (module.procedures.contains(name)) found = &module;
    if (!found) throw Refusal{"no routine " + name};
    const std::string caller = std::exchange(present_, found->name);
    const std::vector<Statement> body = found->procedures.at(name);
    for (const Statement& statement : body) {
      line = statement.line;
      if (!statement.comment.empty()) {
        Mark(statement.comment);
        continue;
      }
      if (!statement.tokens.empty()) Execute(statement);
    }
    present_ = caller;
    --depth_;
  }

  Module& Present() {
    for (auto& [file, module] : modules_)
      if (module.name == present_) return module;
    throw Refusal{"the module is gone"};
  }

  void Execute(const Statement& statement) {
    RapidArguments in(statement.tokens);
    if (in.Take("%")) return LateCall(in);
    const std::string word = in.Identifier();
    if (in.Take(":=")) return Assign(in, word);
    if (word == "MOVEABSJ") return MoveAbsJ(in);
    if (word == "MOVEL") return MoveL(in);
    if (word == "LOAD" || word == "UNLOAD") return Loading(in, word == "LOAD");
    if (word == "WAITTIME" || word == "WAITDI" || word == "STOP") return Wait(in, word);
    if (Mode(in, word)) return;
    if (Switch(in, word)) return;
    // Valid instructions that move or lead elsewhere.
    static const std::set<std::string> others = {
        "MOVEJ",     "MOVEC",   "GOTO",        "RETURN",   "EXIT",      "BREAK",        "CONFDATA",
        "IF",        "FOR",     "WHILE",       "TEST",     "PDISPON",   "PDISPSET",     "EOFFSON",
        "EOFFSSET",  "SOFTACT", "CIRPATHMODE", "STOPMOVE", "DEACTUNIT", "SPEEDREFRESH", "PATHRESOL",
        "MOTIONSUP", "TRIGGL",  "MOVELDO",     "INCR",     "SEARCHL",   "EXITCYCLE"};
    if (others.contains(word)) {
      Event(Step::Kind::kSwitch, in.Text(word));
      return;
    }
    if (machine_.plant.contains(word)) {
      PlantCall(word, in.Text(""));
      for (auto& [name, value] : modes_) value = "unknown";
      return;
    }
    in.End();
    Procedure(word);
  }

  /// "Procedure call with late binding".
  void LateCall(RapidArguments& in) {
    const std::string name = Upper(in.String());
    in.Need("%");
    in.End();
    Procedure(name);
  }

  /// Load, UnLoad: a file's path; the module is there, or is no longer.
  void Loading(RapidArguments& in, bool load) {
    if (load) {
      in.Need("\\");
      in.Need("DYNAMIC");
      in.Need(",");
    }
    const std::string path = in.String();
    in.End();
    if (Upper(path.substr(0, path.rfind('/'))) != "HOME:/PARTS") throw Refusal{"no such folder: " + path};
    std::string name = Upper(path.substr(path.rfind('/') + 1));
    if (!name.ends_with(".MOD")) throw Refusal{"no such file"};
    name.resize(name.size() - 4);
    if (load && (!texts_.contains(name) || modules_.contains(name))) throw Refusal{"cannot load " + name};
    if (load)
      LoadModule(name);
    else if (modules_.erase(name) == 0)
      throw Refusal{"is not loaded: " + name};
  }

  /// "Assignment": to persistents and variables, a whole value of the type.
  void Assign(RapidArguments& in, const std::string& name) {
    Module& module = Present();
    const auto found = module.data.find(name);
    if (found == module.data.end()) throw Refusal{"unknown data " + name};
    if (module.types.at(name).starts_with("CONST")) throw Refusal{name + " is a constant"};
    found->second = ReadRapidValue(found->second.type, in);
    in.End();
  }

  /// What is set, and holds until it is set otherwise.
  bool Mode(RapidArguments& in, const std::string& word) {
    static const std::set<std::string> known = {"CONFJ",      "CONFL",       "SINGAREA", "PDISPOFF",
                                                "EOFFSOFF",   "SOFTDEACT",   "VELSET",   "ACCSET",
                                                "PATHACCLIM", "WORLDACCLIM", "GRIPLOAD", "ACTUNIT"};
    if (!known.contains(word)) return false;
    if (word == "GRIPLOAD" || word == "ACTUNIT") {  // the name of a persistent, of a unit
      modes_[word == "ACTUNIT" ? word + in.Identifier() : word] = word == "ACTUNIT" ? "on" : in.Identifier();
      in.End();
      return true;
    }
    std::string text = in.Text("");
    if ((word == "CONFJ" || word == "CONFL") && text.empty()) text = "\\ON";
    if (word == "SINGAREA" && text.empty()) text = "\\OFF";
    static const std::map<std::string, std::set<std::string>> allowed = {
        {"CONFJ", {"\\ON", "\\OFF"}},
        {"CONFL", {"\\ON", "\\OFF"}},
        {"SINGAREA", {"\\WRIST", "\\OFF", "\\LOCKAXIS4"}},
        {"PDISPOFF", {""}},
        {"EOFFSOFF", {""}},
        {"SOFTDEACT", {""}}};
    if (const auto may = allowed.find(word); may != allowed.end() && !may->second.contains(text))
      throw Refusal{"no such argument: " + text};
    modes_[word] = text;
    return true;
  }

  /// As after PP to Main: what the manuals say of each.
  void Reset() {
    modes_ = {{"CONFJ", "\\ON"},        {"CONFL", "\\ON"},     {"SINGAREA", "\\OFF"},
              {"PDISPOFF", ""},         {"EOFFSOFF", ""},      {"SOFTDEACT", ""},
              {"VELSET", "100,5000"},   {"ACCSET", "100,100"}, {"PATHACCLIM", "FALSE,FALSE"},
              {"WORLDACCLIM", "\\OFF"}, {"GRIPLOAD", "LOAD0"}};
  }

  /// Statements behind a stop point wait for the arm; behind a zone they run ahead of it.
  std::string Ahead() const { return last_exact_ ? "" : " ahead"; }

  bool Switch(RapidArguments& in, const std::string& word) {
    if (word == "TPWRITE") {
      const std::string text = in.String();
      in.End();
      Event(Step::Kind::kSwitch, "TPWRITE " + Upper(text));
      return true;
    }
    static const std::set<std::string> known = {"SETDO", "SET", "RESET", "PULSEDO", "SETAO", "SETGO"};
    if (!known.contains(word)) return false;
    const std::string signal = in.Identifier();
    std::string value = word == "SET" ? "1" : word == "RESET" ? "0" : "pulse";
    if (word.starts_with("SET") && word != "SET") {
      in.Need(",");
      if (in.Sees("-") || in.Sees("+")) trace.open = "a sign before the value of a signal";
      const double number = in.Num();
      value = fmt::format("{}{}", word == "SETDO" ? "" : "S", number + 0.0);
      if (word == "SETDO" && number != 0 && number != 1) throw Refusal{"0 or 1 expected"};
    }
    in.End();
    Event(Step::Kind::kSwitch, fmt::format("{}={}{}", signal, value, Ahead()));
    if (word == "SETAO" || word == "SETGO")
      trace.steps.back().words = fmt::format("{}={}{}", signal, Ahead(), value);
    return true;
  }

  void Wait(RapidArguments& in, const std::string& word) {
    std::string words = word;
    if (word == "WAITTIME") {
      if (in.Take("\\")) {
        in.Need("INPOS");
        in.Need(",");
      }
      const double seconds = in.Num();
      if (seconds < 0) throw Refusal{"seconds of 0 or more expected"};
      words += fmt::format(" {}", seconds + 0.0);
    } else if (word == "WAITDI") {
      words += " " + in.Identifier();
      in.Need(",");
      words += fmt::format(" {}", in.Num());
    }
    in.End();
    Event(Step::Kind::kStop, words);
  }

  const RapidValue& Named(const std::string& name, const char* type) {
    const Module& module = Present();
    const auto found = module.data.find(name);
    if (found == module.data.end() || found->second.type != type)
      throw Refusal{fmt::format("no {} {}", type, name)};
    return found->second;
  }

  /// A name or an aggregate.
  RapidValue Argument(RapidArguments& in, const char* type) {
    if (in.Sees("[")) return ReadRapidValue(type, in);
    const std::string name = in.Identifier();
    if (const auto predefined = PredefinedRapid(type, name)) return *predefined;
    return Named(name, type);
  }

  /// ",speed,zone,tool\WObj:=object": "MoveL", "MoveAbsJ"; tool and object must be persistents.
  struct How {
    RapidValue speed, zone, tool, object;
    std::string words;
  };
  How Read(RapidArguments& in) {
    How how;
    in.Need(",");
    how.speed = Argument(in, "SPEEDDATA");
    how.words += in.Switches();
    in.Need(",");
    how.zone = Argument(in, "ZONEDATA");
    how.words += in.Switches();
    in.Need(",");
    how.tool = Persistent(in, "TOOLDATA");
    how.object.type = "WOBJDATA";
    if (in.Take("\\")) {
      in.Need("WOBJ");
      in.Need(":=");
      how.object = Persistent(in, "WOBJDATA");
    }
    in.End();
    return how;
  }

  RapidValue Persistent(RapidArguments& in, const char* type) {
    const std::string name = in.Identifier();
    if (name == "TOOL0" || name == "WOBJ0") return RapidValue{type};
    const RapidValue value = Named(name, type);
    if (!Present().types.at(name).starts_with("PERS")) throw Refusal{name + " is no persistent"};
    return value;
  }

  /// "robtarget": axes that there are none of must be 9E9.
  void External(const std::vector<double>& eax) {
    const double none = static_cast<double>(9e9F);
    for (size_t i = 0; i < 6; ++i) {
      const bool used = i < machine_.external.size();
      if (used == (eax[i] == none)) throw Refusal{used ? "where an axis goes" : "no such axis"};
      if (used) external_[machine_.external[i]] = eax[i];
    }
  }

  /// The work object in the robot's foot, the axes beside it where they stand.
  Pose ObjectInFoot(const RapidValue& object) const {
    const auto at = [&](size_t i) {
      return machine_.coupled && i < machine_.external.size() ? external_.at(machine_.external[i]) : 0.0;
    };
    const Pose foot = machine_.robroot * Frame(0, at(0), 0, Zyx(0, 0, 0));
    const Pose unit = machine_.root * Frame(0, 0, 0, Zyx(at(1), 0, 0));
    return foot.inverse() * (object.unit.empty() ? object.user : unit) * object.frame;
  }

  /// What holds for the motion. A mode that is not as after PP to Main is another motion.
  void Describe(Step& step, const How& how, const std::vector<double>& stated) {
    static const std::set<std::string> harmless = {"GRIPLOAD", "ACCSET", "PATHACCLIM", "WORLDACCLIM",
                                                   "SOFTDEACT"};
    static const std::map<std::string, std::string> usual = {{"CONFJ", "\\ON"},     {"CONFL", "\\ON"},
                                                             {"SINGAREA", "\\OFF"}, {"PDISPOFF", ""},
                                                             {"EOFFSOFF", ""},      {"VELSET", "100,5000"}};
    step.words = how.words;
    for (const auto& [name, value] : modes_) {
      if (harmless.contains(name) || name.starts_with("ACTUNIT"))
        step.aside += name + value + " ";
      else if (value != usual.at(name))
        step.words += name + value + " ";
    }
    for (const double value : stated) step.aside += fmt::format("{:.9g} ", value);
    // The load of the tool is the controller's model of weights.
    for (const double value : how.tool.numbers) step.aside += fmt::format("{:.6g} ", value);
  }

  void MoveAbsJ(RapidArguments& in) {
    const RapidValue target = ReadRapidValue("JOINTTARGET", in);
    if (in.Take("\\")) in.Need("NOEOFFS");
    const How how = Read(in);
    External(target.eax);
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = target.numbers[static_cast<size_t>(i)] * kRadPerDeg;
    Step& step = WayTo(q);
    step.way_speed = how.speed.numbers[0] / 5000;
    step.exact = last_exact_ = how.zone.fine;
    Describe(step, how, {how.speed.numbers[1], how.speed.numbers[2], how.speed.numbers[3]});
  }

  void MoveL(RapidArguments& in) {
    const RapidValue target = ReadRapidValue("ROBTARGET", in);
    const How how = Read(in);
    External(target.eax);
    if (!how.object.unit.empty() && how.object.unit != machine_.unit)
      throw Refusal{"no unit " + how.object.unit};
    const Pose X_BF = ObjectInFoot(how.object) * target.frame * how.tool.frame.inverse();
    Step& step = CutTo(X_BF);
    if (modes_["CONFL"] == "\\ON") CheckConfiguration(step.q, target.numbers);
    step.feed = how.speed.numbers[0] * 60;
    step.turn_speed = how.speed.numbers[1] * kRadPerDeg;
    step.from_corner = true;
    step.exact = last_exact_ = how.zone.fine;
    std::vector<double> stated = {how.speed.numbers[2], how.speed.numbers[3]};
    if (!step.exact) {
      const std::vector<double>& zone = how.zone.numbers;
      step.blend = std::max({zone[0], zone[1], zone[2]});
      stated.insert(stated.end(), zone.begin() + 3, zone.end());
    }
    Describe(step, how, stated);
  }

  /// "ConfL", "confdata": the configuration of the target is where the motion ends, or the program stops.
  void CheckConfiguration(const Joints& q, const std::vector<double>& given) const {
    const auto differs = [&](int axis, double quarter) {
      const double degrees = q[axis] * kDegPerRad;
      return degrees < 90 * quarter - 1e-3 || degrees > 90 * (quarter + 1) + 1e-3;
    };
    bool other = differs(0, given[0]) || differs(3, given[1]) || differs(5, given[2]);
    const auto frames = LinkFrames(machine_.arm, q);
    const Eigen::Vector3d shoulder = frames[2].translation(), elbow = frames[3].translation(),
                          wrist = frames[5].translation();
    const Eigen::Vector3d ahead = frames[1].linear().col(0), axis = frames[1].linear().col(1);
    int cfx = wrist.dot(ahead) < 0 ? 4 : 0;
    if ((elbow - shoulder).cross(wrist - elbow).dot(axis) < 0) cfx |= 2;
    if (q[4] < 0) cfx |= 1;
    other = other || (std::abs(q[4]) > 2e-5 && given[3] != cfx);
    if (other) throw Refusal{"another configuration at the end"};
  }

  std::map<std::string, std::string> texts_;
  std::map<std::string, Module> modules_;     // by file
  std::map<std::string, std::string> modes_;  // by instruction
  std::string present_;                       // module
  int depth_ = 0;
  bool last_exact_ = true;  // the last motion ends with a stop
};

}  // namespace

Trace RunRapid(const Files& files, const Machine& machine) { return Rapid(files, machine).Run(); }

}  // namespace millpose::campaign
