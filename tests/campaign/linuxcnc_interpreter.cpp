// SPDX-License-Identifier: GPL-3.0-or-later
// RS-274/NGC as LinuxCNC runs it, after its G-code documentation ("G-code Overview", "G-codes", "M-codes");
// the sections are named at each rule. tests/campaign/campaign_test.cpp holds it against rs274 itself.
#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "base/units.hpp"
#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

struct LinuxcncBlock {
  std::map<char, double> words;  // all but G and M
  std::vector<double> g, m;
  std::string text;

  bool HasAxes() const { return std::string("XYZABCUVW").find_first_of(Letters()) != std::string::npos; }
  std::string Letters() const {
    std::string letters;
    for (const auto& [letter, value] : words) letters += letter;
    return letters;
  }
  std::optional<double> Word(char letter) const {
    const auto found = words.find(letter);
    return found == words.end() ? std::nullopt : std::optional(found->second);
  }
};

/// "Modal Groups": the group of a G code; 0 for those that hold for their block alone, -1 for none.
int GroupOf(double g) {
  static const std::map<int, std::vector<double>> groups = {
      {0, {4, 10, 28, 28.1, 30, 30.1, 52, 53, 92, 92.1, 92.2, 92.3}},
      {1, {0, 1, 2, 3, 5, 33, 38.2, 38.3, 73, 76, 80, 81, 82, 83, 84, 85, 86, 89}},
      {2, {17, 18, 19, 17.1, 18.1, 19.1}},
      {3, {90, 91}},
      {4, {90.1, 91.1}},
      {5, {93, 94, 95}},
      {6, {20, 21}},
      {7, {40, 41, 42, 41.1, 42.1}},
      {8, {43, 43.1, 43.2, 49}},
      {10, {98, 99}},
      {12, {54, 55, 56, 57, 58, 59, 59.1, 59.2, 59.3}},
      {13, {61, 61.1, 64}},
      {14, {96, 97}},
      {15, {7, 8}}};
  for (const auto& [group, codes] : groups)
    for (const double code : codes)
      if (code == g) return group;
  return -1;
}

int MGroupOf(double m) {
  for (const double code : {0, 1, 2, 30, 60})
    if (m == code) return 4;
  for (const double code : {3, 4, 5, 19})
    if (m == code) return 7;
  for (const double code : {7, 8, 9})
    if (m == code) return 8 + static_cast<int>(m);
  for (const double code : {62, 63, 64, 65, 66, 67, 68})
    if (m == code) return 5;
  for (const double code : {70, 71, 72, 73})
    if (m == code) return 10;
  return m == 6 || m == 61 ? 6 : m == 48 || m == 49 ? 9 : -1;
}

class LinuxCnc : public Mover {
 public:
  explicit LinuxCnc(const Machine& machine) : Mover(machine) {}

  Trace Run(const std::string& text) {
    const std::vector<std::string> lines = LinesOf(text);
    bool percent = false;
    try {
      for (size_t i = 0; i < lines.size() && !ended_; ++i) {
        line = static_cast<int>(i) + 1;
        // "Format of a Line", "Program structure": 255 characters; a first % asks for a second one.
        if (lines[i].size() > 255) throw Refusal{"a line of more than 255 characters"};
        const std::string code = WithoutComments(lines[i]);
        if (code == "%") {
          if (percent || i == lines.size()) ended_ = true;
          if (!percent && i > 0 && !trace.steps.empty()) throw Refusal{"% in the middle"};
          percent = true;
          continue;
        }
        const size_t first = lines[i].find_first_not_of(" \t");
        if (code.empty() && first != std::string::npos) Comment(lines[i].substr(first));
        if (!code.empty() && !Plant(code)) RunBlock(code);
      }
      if (!ended_) throw Refusal{"the program has no end"};
      Event(Step::Kind::kSwitch, "end");
    } catch (const Refusal& refusal) {
      trace.refused = fmt::format("{}: {}", line, refusal.why);
    }
    return std::move(trace);
  }

 private:
  /// A line that is a comment: a mark, or a message ("Active comments").
  void Comment(const std::string& text) {
    const size_t events = trace.steps.size();
    Mark(text);
    const std::string words = Upper(text.substr(1));
    Cursor at(words);
    if (trace.steps.size() == events && (at.Take("MSG") || at.Take("DEBUG") || at.Take("PRINT")) &&
        at.TakeChar(','))
      Event(Step::Kind::kSwitch, "message " + Squeezed(words));
  }

  /// "O-codes": O<name> CALL [1] [2], a block number before it or not (rs274 runs both).
  bool Plant(const std::string& block) {
    const size_t number = block.starts_with('N') ? block.find_first_not_of("0123456789", 1) : 0;
    const std::string code = block.substr(std::min(number, block.size()));
    if (!code.starts_with("O<")) return false;
    const size_t end = code.find('>');
    if (end == std::string::npos) throw Refusal{"> expected"};
    const std::string name = code.substr(2, end - 2);
    std::string rest = code.substr(end + 1);
    if (!machine_.plant.contains(name) || !rest.starts_with("CALL")) throw Refusal{"an O code"};
    rest.erase(0, 4);
    std::string arguments;
    while (!rest.empty()) {
      const size_t close = rest.find(']');
      if (rest[0] != '[' || close == std::string::npos) throw Refusal{"[ ] expected"};
      arguments += (arguments.empty() ? "" : ",") + rest.substr(1, close - 1);
      rest.erase(0, close + 1);
    }
    PlantCall(name, arguments);
    return true;
  }

  /// "Comments": ( to the next ), no further ( within; ; to the end. Blanks mean nothing, inside numbers too.
  static std::string WithoutComments(const std::string& text) {
    std::string code;
    bool comment = false;
    for (const char c : text) {
      if (comment) {
        if (c == '(') throw Refusal{"a comment within a comment"};
        comment = c != ')';
      } else if (c == '(') {
        comment = true;
      } else if (c == ';') {
        return code;
      } else if (c != ' ' && c != '\t') {
        code += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      }
    }
    if (comment) throw Refusal{"a comment without end"};
    return code;
  }

  /// "Word", "Numbers", "Repeated Items".
  LinuxcncBlock Parse(const std::string& code) {
    LinuxcncBlock block;
    block.text = code;
    Cursor at(code);
    if (at.TakeChar('/')) Event(Step::Kind::kSwitch, "block delete");  // "Block Delete Character"
    while (!at.Done()) {
      const char letter = at.Peek();
      if (letter < 'A' || letter > 'Z') throw Refusal{fmt::format("a word expected: {}", code)};
      at.TakeChar(letter);
      const auto value = at.Number();
      at.Need(value.has_value(), "a number");
      if (letter == 'G')
        block.g.push_back(Near(*value, 10));
      else if (letter == 'M')
        block.m.push_back(Near(*value, 1));
      else if (!block.words.emplace(letter, *value).second)
        throw Refusal{fmt::format("{} twice", letter)};
    }
    CheckGroups(block);
    return block;
  }

  /// "Numbers": what must be whole (G: a tenth) may be off by 0.0001.
  static double Near(double value, double parts) {
    const double whole = std::round(value * parts) / parts;
    return std::abs(value - whole) < (parts > 1 ? 1.01e-4 : 0.99e-4) ? whole : value;
  }

  static void CheckGroups(const LinuxcncBlock& block) {
    std::set<int> groups, m_groups;
    for (const double g : block.g) {
      const int group = GroupOf(g);
      if (group < 0) throw Refusal{fmt::format("no G{}", g)};
      if (!groups.insert(group).second) throw Refusal{"two G codes of one group"};
    }
    for (const double m : block.m) {
      const int group = MGroupOf(m);
      if (group < 0) throw Refusal{fmt::format("no M{}", m)};
      if (!m_groups.insert(group).second) throw Refusal{"two M codes of one group"};
    }
  }

  static bool Has(const std::vector<double>& codes, double code) {
    return std::find(codes.begin(), codes.end(), code) != codes.end();
  }

  /// "Order of Execution".
  void RunBlock(const std::string& code) {
    const LinuxcncBlock block = Parse(code);
    for (const char letter : block.Letters())
      if (std::string("XYZABCFSPQNELRTDHIJKUVWO").find(letter) == std::string::npos)
        throw Refusal{"an unknown word"};
    CheckParameters(block);
    for (const double g : block.g)
      if (GroupOf(g) == 5) SetFeedMode(g);
    if (const auto feed = block.Word('F')) {
      if (*feed < 0) throw Refusal{"a negative F"};
      feed_ = *feed;
      fresh_feed_ = true;
    }
    if (const auto speed = block.Word('S')) {
      if (*speed < 0) throw Refusal{"a negative S"};
      speed_ = *speed;
      if (turning_) Event(Step::Kind::kSwitch, fmt::format("S{:.0f}", speed_));
    }
    if (const auto tool = block.Word('T')) Event(Step::Kind::kSwitch, fmt::format("T{}", *tool));
    if (block.words.contains('N') && block.text.find('N') != 0) throw Refusal{"N not in front"};
    RunM(block);
    if (Has(block.g, 4)) {
      if (!block.Word('P') || *block.Word('P') < 0) throw Refusal{"G4 needs P"};
      Event(Step::Kind::kStop, fmt::format("G4 P{}", *block.Word('P')));
    }
    RunModes(block);
    const bool moves = (block.HasAxes() && !Has(block.g, 10) && !Has(block.g, 92)) || Has(block.g, 1);
    const bool feeds = Has(block.g, 1) || (motion_ == 1 && !Has(block.g, 0));
    // rs274 asks for the feed where G1 stands, be it without a way.
    if (Has(block.g, 1) && feed_mode_ == 94 && feed_ <= 0) throw Refusal{"G1 to G3 need F"};
    if (moves && feeds && feed_mode_ == 93 && !fresh_feed_) throw Refusal{"G93 needs F"};
    if (Has(block.g, 53) && motion_ != 0 && motion_ != 1 && !Has(block.g, 0) && !Has(block.g, 1))
      throw Refusal{"G53 needs G0 or G1"};
    if (Has(block.g, 53) && !block.HasAxes()) throw Refusal{"G53 alone"};
    bool spent = false;  // axis words belong to a code that moves nothing
    for (const double g : block.g) spent = RunOnce(block, g) || spent;
    for (const double g : block.g)
      if (GroupOf(g) == 1) motion_ = g;
    if (!spent && block.HasAxes()) Move(block);
    fresh_feed_ = false;
    for (const double m : block.m) {
      if (m == 0 || m == 1 || m == 60) Event(Step::Kind::kStop, fmt::format("M{}", m));
      if (m == 2 || m == 30) ended_ = true;
    }
  }

  /// Letters belong to codes: P, Q, L, E, R, D, H without one that takes them are an error.
  static void CheckParameters(const LinuxcncBlock& block) {
    const auto takes = [&](std::initializer_list<double> g, std::initializer_list<double> m) {
      for (const double code : g)
        if (Has(block.g, code)) return true;
      for (const double code : m)
        if (Has(block.m, code)) return true;
      return false;
    };
    if (block.words.contains('P') && !takes({4, 10, 64, 76, 82, 86, 89, 5}, {62, 63, 64, 65, 66}))
      throw Refusal{"P alone"};
    if (block.words.contains('Q') && !takes({64, 73, 83, 5}, {66, 67, 68})) throw Refusal{"Q alone"};
    if (block.words.contains('L') && !takes({10, 76, 81, 82, 83}, {66})) throw Refusal{"L alone"};
    if (block.words.contains('E') && !takes({76}, {66, 67, 68})) throw Refusal{"E alone"};
    if (block.words.contains('R') && !takes({2, 3, 10, 81, 82, 83, 73}, {})) throw Refusal{"R alone"};
    if (block.words.contains('D') && !takes({41, 42, 41.1, 42.1, 96}, {})) throw Refusal{"D alone"};
    if (block.words.contains('H') && !takes({43, 76}, {})) throw Refusal{"H alone"};
    for (const char letter : {'I', 'J', 'K'})
      if (block.words.contains(letter) && !takes({2, 3, 5, 10, 33, 76}, {})) throw Refusal{"I, J, K alone"};
  }

  /// "G93, G94, G95": the mode needs an F of its own, also where it held before (rs274).
  void SetFeedMode(double g) {
    feed_ = 0;
    feed_mode_ = g;
  }

  /// "M-codes".
  void RunM(const LinuxcncBlock& block) {
    for (const double m : block.m) {
      if (m == 3 || m == 4 || m == 5) {
        turning_ = m != 5;
        Event(Step::Kind::kSwitch, m == 5 ? "M5" : fmt::format("M{} S{:.0f}", m, speed_));
      } else if (m == 62 || m == 63 || m == 64 || m == 65) {
        const auto number = block.Word('P');
        if (!number) throw Refusal{"P expected"};
        if (*number != std::round(*number)) trace.open = "how the number of an output is rounded";
        Event(Step::Kind::kSwitch, fmt::format("M{} P{:.0f}", m, *number));
      } else if (m == 66 || m == 67 || m == 68) {
        if (block.Word('L') && Near(*block.Word('L'), 1) != std::round(*block.Word('L')))
          throw Refusal{"L is whole"};
        if (!block.Word('E') && !(m == 66 && block.Word('P'))) throw Refusal{"E expected"};
        Event(Step::Kind::kSwitch, fmt::format("M{} {}", m, Words(block)));
        if (m == 68 && block.Word('E') == 3.0 && machine_.cartesian)
          Kinematics(block.Word('Q').value_or(1) == 0);
      } else if (MGroupOf(m) != 4) {
        Event(Step::Kind::kSwitch, fmt::format("M{}", m));
      }
    }
  }

  void Kinematics(bool poses) {
    poses_ = poses;
    words_.clear();
  }

  /// Units, plane, compensation, coordinate system, path control, distance mode.
  void RunModes(const LinuxcncBlock& block) {
    for (const double g : block.g) {
      const int group = GroupOf(g);
      if (group == 13) {
        exact_ = g != 64;
        if (g ==
            64) {  // "G64 Path Blending": without P above 0 as far as it goes; Q, by default P, merges moves
          const double p = block.Word('P').value_or(0), q = block.Word('Q').value_or(p);
          blend_ = p > 0 ? p : 1e6;
          modal_[13] = q != 0 ? fmt::format("Q{} ", q) : "";
          unbounded_ = p <= 0;
        }
      } else if (group > 1 && group != 5) {
        modal_[group] = fmt::format("G{}", g);
      }
    }
  }

  static std::string Words(const LinuxcncBlock& block) {
    std::string text;
    for (const auto& [letter, value] : block.words)
      if (letter != 'N') text += fmt::format("{}{} ", letter, value + 0.0);
    return text;
  }

  bool RunOnce(const LinuxcncBlock& block, double g) {
    if (GroupOf(g) != 0 || g == 4) return false;
    if (g == 10) modal_[100] = Words(block);  // "G10 L2"
    if (g == 92.1) modal_[101] = "G92.1";
    if (g != 10 && g != 92.1) Event(Step::Kind::kSwitch, fmt::format("G{}", g));
    return g == 10 || (g != 92.1 && g != 53 && block.HasAxes());
  }

  std::string Modes() const {
    std::string text;
    for (const auto& [group, mode] : modal_)
      if (group != 13 && group != 2) text += mode + " ";
    return text;
  }

  /// "Plane Selection": of arcs, not of straight motions.
  std::string Plane() const { return modal_.contains(2) ? modal_.at(2) + " " : ""; }

  void Move(const LinuxcncBlock& block) {
    if (motion_ >= 1 && motion_ <= 3 && feed_ <= 0) throw Refusal{"G1 to G3 need F"};
    if (motion_ != 0 && motion_ != 1) {
      Event(Step::Kind::kSwitch, "another motion: " + block.text);
      return;
    }
    for (const char letter : std::string("UVW")) {  // "Axes": those that the machine has
      const std::string name(1, letter);
      const bool known =
          std::find(machine_.external.begin(), machine_.external.end(), name) != machine_.external.end();
      if (block.Word(letter) && !known) throw Refusal{"a bad character: " + name};
      if (block.Word(letter)) external_[name] = *block.Word(letter);
    }
    if (external_.size() < machine_.external.size())
      return static_cast<void>(Event(Step::Kind::kSwitch, "from where the machine stands"));
    std::map<char, double> before = words_;
    for (const char letter : {'X', 'Y', 'Z', 'A', 'B', 'C'}) {
      const auto word = block.Word(letter);
      const bool linear = letter >= 'X';
      const double scale = linear && modal_.contains(6) && modal_.at(6) == "G20" ? 25.4 : 1;
      const bool relative = modal_.contains(3) && modal_.at(3) == "G91";
      if (word) words_[letter] = *word * scale + (relative ? words_[letter] : 0);
      if (!words_.contains(letter)) {
        Event(Step::Kind::kSwitch, "from where the machine stands");
        return;
      }
    }
    poses_ ? MovePose(before) : MoveJoints(before);
    Joints given;
    for (int i = 0; i < 6; ++i) given[i] = words_.at("XYZABC"[i]);
    trace.steps.back().programmed = given;
  }

  double Length(const std::map<char, double>& before, std::string_view letters) const {
    double squared = 0;
    for (const char letter : letters) {
      const auto was = before.find(letter);
      if (was != before.end()) squared += std::pow(words_.at(letter) - was->second, 2);
    }
    return std::sqrt(squared);
  }

  /// "G94", "G93": F along X, Y, Z, or along A, B, C where these stand; rs274 makes of G93 at least 0.1 a
  /// minute.
  double Seconds(const std::map<char, double>& before) const {
    const double xyz = Length(before, "XYZ"), length = xyz > 0 ? xyz : Length(before, "ABC");
    if (length == 0) return 0;
    return length / (feed_mode_ == 93 ? std::max(0.1, length * feed_) : feed_) * 60;
  }

  void MoveJoints(const std::map<char, double>& before) {
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = words_.at("XYZABC"[i]) * kRadPerDeg;
    Step& step = motion_ == 0 ? WayTo(q) : TimedTo(q);
    step.exact = exact_;
    step.words = Modes();
    step.aside = Plane();
    if (motion_ == 0) return;
    step.seconds = Seconds(before);
    step.blend = blend_ * kRadPerDeg * 3500;     // of joints, at about the arm's reach
    step.angle_blend = blend_ * kRadPerDeg * 2;  // the wrist turns by about as much
    if (!exact_) step.aside += modal_.at(13) + (unbounded_ ? "unbounded" : "");
  }

  void MovePose(const std::map<char, double>& before) {
    const double a = words_.at('A'), b = words_.at('B'), c = words_.at('C');
    const Eigen::Matrix3d R = Oriented(machine_.rotation, a, b, c) * machine_.R_TC.transpose();
    const Pose X_BF = Frame(words_.at('X'), words_.at('Y'), words_.at('Z'), R) * machine_.X_FT.inverse();
    if (motion_ == 0) {
      WayTo(X_BF, std::nullopt, std::nullopt).words = "G0 to a pose";
      return;
    }
    Step& step = CutTo(X_BF);
    step.angles = Eigen::Vector3d(a, b, c) * kRadPerDeg;
    step.exact = exact_;
    step.blend = blend_;
    step.words = Modes() + (exact_ ? std::string() : modal_.at(13));  // moves of A, B, C are not merged
    step.aside = Plane() + (!exact_ && unbounded_ ? "unbounded" : "");
    const bool moves = before.empty() || Length(before, "XYZ") > 0;
    if (moves && feed_mode_ == 94)
      step.feed = feed_;
    else
      step.seconds = Seconds(before);
  }

  std::map<char, double> words_;                   // degrees; mm and degrees of tool poses
  std::map<int, std::string> modal_ = {{13, ""}};  // by group; 100, 101: offsets
  double feed_ = 0, feed_mode_ = 94, blend_ = 1e6, speed_ = 0, motion_ = 80;
  bool fresh_feed_ = false, exact_ = false, turning_ = false, poses_ = false, ended_ = false;
  bool unbounded_ = true;  // rounding, as the machine has it
};

}  // namespace

Trace RunLinuxCnc(const Files& files, const Machine& machine) {
  return LinuxCnc(machine).Run(files.begin()->second);
}

}  // namespace millpose::campaign
