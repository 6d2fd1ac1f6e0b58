// SPDX-License-Identifier: GPL-3.0-or-later
// URScript as a controller of Universal Robots runs it, after the script manual (e-Series, "Module motion",
// "Module internals", "Module interfaces"); the functions are named at each rule.
#include <fmt/format.h>

#include <cmath>

#include "base/units.hpp"
#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

/// An argument of a function.
struct Argument {
  enum class Kind { kNumber, kTruth, kText, kList, kPose } kind = Kind::kNumber;
  double number = 0;
  bool truth = false;
  std::string text;
  std::vector<double> list;
};

struct Arguments {
  std::vector<Argument> placed;
  std::map<std::string, Argument> named;
};

/// The code of a line: '#' begins a comment outside of texts.
std::string CodeOf(const std::string& line) {
  bool inside = false;
  size_t end = line.size();
  for (size_t i = 0; i < line.size() && end == line.size(); ++i) {
    if (line[i] == '#' && !inside) end = i;
    if (line[i] == '"') inside = !inside;
  }
  const size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos || first >= end) return {};
  const size_t last = line.find_last_not_of(" \t\r", end - 1);
  return line.substr(first, last + 1 - first);
}

class UrScript : public Mover {
 public:
  UrScript(const Machine& machine, std::string name) : Mover(machine), name_(std::move(name)) {}

  /// A program is compiled as a whole: what is wrong anywhere stops it before it moves.
  Trace Run(const std::string& text) {
    const std::vector<std::string> lines = LinesOf(text);
    try {
      for (size_t i = 0; i < lines.size(); ++i) {
        line = static_cast<int>(i) + 1;
        if (const std::string code = CodeOf(lines[i]); !code.empty()) Statement(code);
      }
      if (!ended_) throw Refusal{"the program has no end"};
      Event(Step::Kind::kSwitch, "end");
    } catch (const Refusal& refusal) {
      trace.refused = fmt::format("{}: {}", line, refusal.why);
    }
    return std::move(trace);
  }

 private:
  void Statement(const std::string& code) {
    if (ended_) throw Refusal{"behind the end"};
    Cursor at(code);
    if (!defined_) return Define(at);
    if (at.Take("end")) {
      at.Need(at.Done(), "the end of the line");
      ended_ = loops_ == 0;
      if (loops_ > 0) --loops_;
      return;
    }
    if (at.Take("while")) {
      ++loops_;
      const std::string condition = Squeezed(at.Rest());
      if (!condition.ends_with(':')) throw Refusal{": expected"};
      Event(Step::Kind::kStop, "while " + condition);
      return;
    }
    const std::string name = at.Name();
    at.Need(!name.empty() && at.TakeChar('('), "the call of a function");
    if (machine_.plant.contains(name)) {
      std::string rest = at.Rest();
      if (!rest.ends_with(')')) throw Refusal{") expected"};
      rest.pop_back();
      return PlantCall(name, rest);
    }
    const Arguments arguments = Parse(at);
    at.Need(at.Done(), "the end of the line");
    Call(name, arguments);
  }

  void Define(Cursor& at) {
    at.Need(at.Take("def"), "def");
    if (at.Name() != name_) trace.open = "a function of another name than its file";
    at.Need(at.TakeChar('(') && at.TakeChar(')') && at.TakeChar(':') && at.Done(), "name():");
    defined_ = true;
  }

  double Number(Cursor& at) {
    Cursor ahead = at;
    const bool plus = ahead.TakeChar('+');
    if (!plus) ahead.TakeChar('-');
    const char first = ahead.Peek();
    const auto number = at.Number();
    at.Need(number.has_value(), "a number");
    const char next = at.Peek();
    if (first == '.' || plus) trace.open = "how a number may begin";
    if (next == 'e' || next == 'E' || next == '.') throw Refusal{"no number"};
    return *number;
  }

  Argument Value(Cursor& at) {
    Argument value;
    if (at.Peek() == '"') {
      value.kind = Argument::Kind::kText;
      const auto text = at.Quoted();
      at.Need(text.has_value(), "the end of a text");
      value.text = *text;
      return value;
    }
    const bool pose = at.TakeChar('p');
    if (pose) value.kind = Argument::Kind::kPose;
    if (at.TakeChar('[')) {
      if (!pose) value.kind = Argument::Kind::kList;
      do value.list.push_back(Number(at));
      while (at.TakeChar(','));
      at.Need(at.TakeChar(']'), "]");
      return value;
    }
    at.Need(!pose, "[");
    value.number = Number(at);
    while (at.Peek() == '/' || at.Peek() == '*') {
      const bool divide = at.TakeChar('/');
      if (!divide) at.TakeChar('*');
      const double by = Number(at);
      value.number = divide ? value.number / by : value.number * by;
    }
    return value;
  }

  Argument TruthOrValue(Cursor& at) {
    Argument value;
    value.kind = Argument::Kind::kTruth;
    value.truth = at.Take("True");
    return value.truth || at.Take("False") ? value : Value(at);
  }

  /// "Function": values by place, then by name.
  Arguments Parse(Cursor& at) {
    Arguments arguments;
    if (at.TakeChar(')')) return arguments;
    do {
      Cursor ahead = at;
      const std::string name = ahead.Name();
      if (!name.empty() && ahead.TakeChar('=')) {
        at = ahead;
        if (!arguments.named.emplace(name, TruthOrValue(at)).second) throw Refusal{name + " twice"};
      } else {
        if (!arguments.named.empty()) throw Refusal{"a value by place behind one by name"};
        arguments.placed.push_back(TruthOrValue(at));
      }
    } while (at.TakeChar(','));
    at.Need(at.TakeChar(')'), ")");
    return arguments;
  }

  /// The arguments by the function's own names; those that are missing are left out.
  static std::map<std::string, Argument> Bind(const Arguments& arguments,
                                              const std::vector<std::string>& names, size_t needed) {
    std::map<std::string, Argument> bound;
    if (arguments.placed.size() > names.size()) throw Refusal{"too many arguments"};
    for (size_t i = 0; i < arguments.placed.size(); ++i) bound[names[i]] = arguments.placed[i];
    for (const auto& [name, value] : arguments.named) {
      if (std::find(names.begin(), names.end(), name) == names.end()) throw Refusal{"no argument " + name};
      if (!bound.emplace(name, value).second) throw Refusal{name + " twice"};
    }
    for (size_t i = 0; i < needed; ++i)
      if (!bound.contains(names[i])) throw Refusal{names[i] + " is missing"};
    return bound;
  }

  static double NumberOf(const std::map<std::string, Argument>& bound, const std::string& name,
                         double usual) {
    const auto found = bound.find(name);
    if (found == bound.end()) return usual;
    if (found->second.kind != Argument::Kind::kNumber) throw Refusal{name + " is a number"};
    return found->second.number;
  }

  static bool TruthOf(const std::map<std::string, Argument>& bound, const std::string& name) {
    const auto found = bound.find(name);
    if (found == bound.end()) return false;
    if (found->second.kind != Argument::Kind::kTruth) throw Refusal{name + " is True or False"};
    return found->second.truth;
  }

  static int Port(const std::map<std::string, Argument>& bound, int count) {
    const double port = NumberOf(bound, "n", -1);
    if (port != std::floor(port) || port < 0 || port >= count) throw Refusal{"no such output"};
    return static_cast<int>(port);
  }

  void Call(const std::string& name, const Arguments& arguments) {
    if (name == "movej") return MoveJoints(Bind(arguments, {"q", "a", "v", "t", "r"}, 1));
    if (name == "movel") return MoveLine(Bind(arguments, {"q", "a", "v", "t", "r"}, 1), true);
    if (name == "movep") return MoveLine(Bind(arguments, {"q", "a", "v", "r"}, 1), false);
    if (name == "set_tcp") {  // in the flange
      X_FT_ = PoseOf(Bind(arguments, {"pose"}, 1).at("pose"));
    } else if (name == "set_payload") {
      SetPayload(Bind(arguments, {"m", "cog"}, 1));
    } else if (name == "sleep") {
      const double seconds = NumberOf(Bind(arguments, {"t"}, 1), "t", 0);
      if (seconds < 0) throw Refusal{"a time below 0"};
      Event(Step::Kind::kStop, fmt::format("sleep {}", seconds));
    } else if (name == "textmsg") {
      Say(Bind(arguments, {"s1", "s2"}, 1).at("s1"));
    } else if (name == "popup") {
      const auto bound = Bind(arguments, {"s", "title", "warning", "error", "blocking"}, 1);
      Event(TruthOf(bound, "blocking") ? Step::Kind::kStop : Step::Kind::kSwitch,
            "popup " + bound.at("s").text);
    } else if (name == "sync") {
      Bind(arguments, {}, 0);
    } else if (!Switch(name, arguments) && !Elsewhere(name)) {
      throw Refusal{"no function " + name};
    }
  }

  /// Functions that exist and lead elsewhere: nobody confirms them.
  bool Elsewhere(const std::string& name) {
    static const std::set<std::string> known = {"movec",
                                                "servoj",
                                                "speedj",
                                                "speedl",
                                                "stopj",
                                                "stopl",
                                                "force_mode",
                                                "freedrive_mode",
                                                "halt",
                                                "set_gravity",
                                                "set_payload_mass",
                                                "set_payload_cog",
                                                "set_target_payload"};
    if (known.contains(name)) Event(Step::Kind::kSwitch, name);
    return known.contains(name);
  }

  /// "set_standard_digital_out(n, b)" and its like: done when the program gets there, which behind a blend is
  /// where it begins.
  bool Switch(const std::string& name, const Arguments& arguments) {
    static const std::map<std::string, int> digital = {
        {"set_standard_digital_out", 8}, {"set_configurable_digital_out", 8}, {"set_tool_digital_out", 2}};
    if (const auto found = digital.find(name); found != digital.end()) {
      const auto bound = Bind(arguments, {"n", "b"}, 2);
      Event(Step::Kind::kSwitch,
            fmt::format("{} {} {}", name, Port(bound, found->second), TruthOf(bound, "b")));
      return true;
    }
    if (name != "set_standard_analog_out") return false;
    const auto bound = Bind(arguments, {"n", "f"}, 2);
    const double share = NumberOf(bound, "f", 0);
    if (share < 0 || share > 1) throw Refusal{"an output beyond its scale"};
    Event(Step::Kind::kSwitch, fmt::format("analogue {} S{:.3f}", Port(bound, 2), share * kFullSpeed));
    return true;
  }

  void Say(const Argument& message) {
    if (message.kind != Argument::Kind::kText) return;
    const size_t events = trace.steps.size();
    if (message.text.starts_with("PASS") || message.text.starts_with("END OF PASS")) Mark(message.text);
    if (trace.steps.size() == events) Event(Step::Kind::kSwitch, "message " + message.text);
  }

  void SetPayload(const std::map<std::string, Argument>& bound) {
    const double mass = NumberOf(bound, "m", 0);
    std::vector<double> centre = {0, 0, 0};
    if (bound.contains("cog")) centre = bound.at("cog").list;
    if (centre.size() != 3 || mass < 0) throw Refusal{"a mass and three lengths"};
    const auto coarse = [](double value) { return std::round(value * 100) / 100 + 0.0; };
    load_ = fmt::format("load {} {} {} {}", coarse(mass), coarse(centre[0]), coarse(centre[1]),
                        coarse(centre[2]));
    exact_load_ = fmt::format("{} {} {} {}", mass, centre[0], centre[1], centre[2]);
  }

  /// "p[x, y, z, rx, ry, rz]": m, and axis times angle.
  static Pose PoseOf(const Argument& value) {
    if (value.kind != Argument::Kind::kPose || value.list.size() != 6) throw Refusal{"a pose expected"};
    const Eigen::Vector3d turn(value.list[3], value.list[4], value.list[5]);
    const double angle = turn.norm();
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    if (angle > 0) R = Eigen::AngleAxisd(angle, Eigen::Vector3d(turn / angle)).toRotationMatrix();
    return Frame(1000 * value.list[0], 1000 * value.list[1], 1000 * value.list[2], R);
  }

  Pose Flange(const Argument& value) {
    if (value.kind == Argument::Kind::kList) return ForwardFlange(machine_.arm, JointsOf(value));
    if (!X_FT_) Event(Step::Kind::kSwitch, "the installation's tool");
    Pose X_FC = machine_.X_FT;
    X_FC.linear() = X_FC.linear() * machine_.R_TC;
    return PoseOf(value) * X_FT_.value_or(X_FC).inverse();
  }

  static Joints JointsOf(const Argument& value) {
    if (value.kind != Argument::Kind::kList || value.list.size() != 6) throw Refusal{"six joints expected"};
    return Eigen::Map<const Joints>(value.list.data());
  }

  /// Speeds and accelerations are above 0; a time takes their place.
  void CheckPace(const std::map<std::string, Argument>& bound, double a, double v) {
    if (a <= 0 || v <= 0 || NumberOf(bound, "r", 0) < 0) throw Refusal{"a and v above 0, r not below"};
    if (NumberOf(bound, "t", 0) != 0) Event(Step::Kind::kSwitch, "a motion with a time");
  }

  void Finish(Step& step, double a, double radius) {
    step.words = load_;
    step.aside = fmt::format("a {} r {} {}", a, radius, exact_load_);
    step.exact = radius == 0;
    step.blend = radius;
    step.from_corner = true;
  }

  /// "movej": linear in joint space; from a standstill, or from movej and movel with a blend.
  void MoveJoints(const std::map<std::string, Argument>& bound) {
    const double a = NumberOf(bound, "a", 1.4), v = NumberOf(bound, "v", 1.05);
    CheckPace(bound, a, v);
    if (blend_ > 0) trace.open = "a blend into movej";
    const Argument& to = bound.at("q");
    const bool pose = to.kind == Argument::Kind::kPose;
    if (pose) trace.open = "which configuration movej takes for a pose";
    Step& step = pose ? WayTo(Flange(to), std::nullopt, std::nullopt) : WayTo(JointsOf(to));
    step.way_speed = v;
    Finish(step, a, 1000 * NumberOf(bound, "r", 0));
    blend_ = 0;
  }

  /// "movel", "movep": the tip on a line; a move whose blend meets its neighbour's is skipped.
  void MoveLine(const std::map<std::string, Argument>& bound, bool movel) {
    const double a = NumberOf(bound, "a", 1.2), v = NumberOf(bound, "v", 0.25);
    const double radius = 1000 * NumberOf(bound, "r", 0);
    CheckPace(bound, a, v);
    if (blend_ > 0 && movel != movel_) trace.open = "a blend from movep to movel, or back";
    const Pose X_BF = Flange(bound.at("q"));
    if (!q()) throw Refusal{"from wherever the arm stands"};
    const Pose from = ForwardFlange(machine_.arm, *q()) * machine_.X_FT, to = X_BF * machine_.X_FT;
    const double distance = (to.translation() - from.translation()).norm();
    if (blend_ + radius > 0 && blend_ + radius >= distance) {
      trace.open = "overlapping blends: a move is skipped";
      return;
    }
    Step& step = CutTo(X_BF);
    step.feed = 60000 * v;
    Finish(step, a, radius);
    blend_ = radius;
    movel_ = movel;
  }

  static constexpr double kFullSpeed = 24000;  // 1/min, of the spindle at the analogue output's full scale
  const std::string name_;
  std::optional<Pose> X_FT_;
  std::string load_ = "load of the installation", exact_load_;
  double blend_ = 0;  // mm, of the last motion
  int loops_ = 0;
  bool movel_ = false, defined_ = false, ended_ = false;
};

}  // namespace

Trace RunUrScript(const Files& files, const Machine& machine) {
  const auto& [file, text] = *files.begin();
  return UrScript(machine, file.substr(0, file.find('.'))).Run(text);
}

}  // namespace millpose::campaign
