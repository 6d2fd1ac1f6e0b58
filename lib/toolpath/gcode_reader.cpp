// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <optional>
#include <set>

#include "base/text.hpp"
#include "base/units.hpp"
#include "toolpath/cam_path.hpp"
#include "toolpath/gcode_arc.hpp"
#include "toolpath/gcode_block.hpp"
#include "toolpath/gcode_frame.hpp"
#include "toolpath/gcode_way.hpp"
#include "toolpath/gcode_words.hpp"

namespace millpose {
namespace {

constexpr double kInch = 25.4;
constexpr double kMaxLength = 1e7;  // mm

using Kind = GcodeWord::Kind;
using Vector = Eigen::Vector3d;

// What stands in one block besides modal state.
struct Block {
  std::array<const GcodeWord*, 3> linear{}, rotary{}, centre{}, vector{};
  const GcodeWord *radius = nullptr, *turns = nullptr;
  bool machine = false;    // SUPA, G53: machine coordinates
  bool reference = false;  // G28, G30
  bool dwell = false;
  bool HasLinear() const { return linear[0] || linear[1] || linear[2]; }
  bool HasTurn() const { return rotary[0] || rotary[1] || rotary[2] || vector[0] || vector[1] || vector[2]; }
};

class GcodeReader {
 public:
  GcodeReader(std::string_view bytes, const std::string& name, const CamReadOptions& options)
      : scanner_(bytes, name), name_(name), options_(options) {}

  CamPath Read() {
    GcodeBlock block;
    while (!ended_ && scanner_.Next(block)) {
      skippable_ += block.skippable ? 1 : 0;
      Take(block);
    }
    if (path_.points.empty()) throw InputError({name_}, "the programme holds no motion");
    CheckReach(path_, name_);
    AddNotes();
    return std::move(path_);
  }

 private:
  void Take(const GcodeBlock& source) {
    Block block;
    line_ = source.line;
    const GcodeWord& first = source.words[0];
    if (TakeDefinition(source)) return;
    if (GcodeFrame::IsFrameWord(first.address)) {
      frame_.Take(source, Unit(), [&](const GcodeWord& word) { return ValueOf(word); });
      if (!(known_[0] && known_[1] && known_[2])) known_ = {};
      if (known_[0]) at_ = frame_.ToProgrammed(base_);
      return;
    }
    for (const GcodeWord& word : source.words)
      if (word.address == "G") TakeG(word, block);
    for (const GcodeWord& word : source.words)
      if (word.address != "G") TakeWord(word, block);
    if (block.dwell) return;
    SetFeed();
    Move(block, source);
  }

  // DEF lines and assignments to variables.
  bool TakeDefinition(const GcodeBlock& source) {
    const bool definition = source.words[0].address == "DEF";
    for (const GcodeWord& word : source.words) {
      if (!definition && !IsAssignment(word)) continue;
      if (word.kind == Kind::kValue || word.kind == Kind::kVariable) variables_[word.address] = ValueOf(word);
    }
    return definition || std::ranges::all_of(source.words, IsAssignment);
  }

  // A variable is what is no known address: R parameters and names of two characters or more.
  static bool IsAssignment(const GcodeWord& word) {
    static const std::set<std::string> addresses{"CR",   "TURN", "SPOS", "AP",   "RP", "RND",
                                                 "RNDM", "CHF",  "CHR",  "STAT", "TU", "CTOL",
                                                 "OTOL", "FRC",  "FRCM", "ADIS", "ANG"};
    if (word.kind == Kind::kName || word.kind == Kind::kCall || word.kind == Kind::kText) return false;
    if (word.address[0] == 'R' && word.address.size() > 1 && word.address[1] <= '9') return true;
    return word.address.size() > 2 && word.address[1] > '9' && !addresses.contains(word.address);
  }

  double ValueOf(const GcodeWord& word) const {
    if (word.kind == Kind::kText) throw InputError(word.place, word.address + " needs a number");
    if (word.kind != Kind::kVariable) return word.value;
    const auto found = variables_.find(word.text);
    if (found == variables_.end())
      throw InputError(word.place, fmt::format("the variable \"{}\" has no value", word.text.substr(0, 40)));
    return word.negative ? -found->second : found->second;
  }

  double Unit() const { return inch_ ? kInch : 1; }

  void TakeG(const GcodeWord& word, Block& block) {
    const double g = ValueOf(word);
    const auto is = [&](std::initializer_list<double> list) {
      return std::ranges::find(list, g) != list.end();
    };
    if (is({0, 1, 2, 3})) {
      motion_ = static_cast<int>(g);
    } else if (is({17, 18, 19})) {
      plane_ = static_cast<int>(g) - 17;
    } else if (is({20, 70, 700})) {
      inch_ = true;
      inch_feed_ = g != 70;
    } else if (is({21, 71, 710})) {
      inch_ = inch_feed_ = false;
    } else if (is({90, 91})) {
      incremental_ = g == 91;
    } else if (is({90.1, 91.1})) {
      absolute_centre_ = g == 90.1;
    } else if (is({93, 94, 95})) {
      feed_mode_ = static_cast<int>(g);
      feed_word_.reset();
    } else if (is({43.4})) {
      SetTipProgramming(true);
    } else if (is({49})) {
      SetTipProgramming(false);
    } else if (is({53, 153})) {
      block.machine = true;
    } else if (is({28, 30})) {
      block.reference = true;
    } else if (is({4})) {
      block.dwell = true;
    } else {
      TakeOtherG(word, g);
    }
  }

  void TakeOtherG(const GcodeWord& word, double g) {
    const GcodeMeaning meaning = MeaningOfG(g);
    if (meaning == GcodeMeaning::kRefused)
      throw InputError(word.place,
                       fmt::format("G{} is not read: let the CAM system write G0, G1, G2 and G3", g));
    if (meaning == GcodeMeaning::kUnknown) ++unknown_[fmt::format("G{}", g)];
    if ((g >= 54 && g < 60) || (g >= 505 && g <= 599)) offsets_.insert(g);
  }

  void TakeWord(const GcodeWord& word, Block& block) {
    const std::string& address = word.address;
    const auto slot = [&](std::string_view letters) { return letters.find(address[0]); };
    if (word.kind == Kind::kName || word.kind == Kind::kCall) return TakeName(word, block);
    if (address.size() == 1 && slot("XYZ") != std::string::npos) {
      block.linear[slot("XYZ")] = &word;
    } else if (address.size() == 1 && slot("ABC") != std::string::npos) {
      block.rotary[slot("ABC")] = &word;
    } else if (address.size() == 1 && slot("IJK") != std::string::npos) {
      block.centre[slot("IJK")] = &word;
    } else if (address.size() == 2 && address[1] == '3' && slot("ABC") != std::string::npos) {
      block.vector[slot("ABC")] = &word;
    } else if (address == "CR" || address == "R") {
      block.radius = &word;
    } else if (address == "TURN") {
      block.turns = &word;
    } else if (address == "F") {
      if (!block.dwell) feed_word_ = ValueOf(word);
    } else if (address == "S") {
      if (!block.dwell && word.kind != Kind::kText) revolutions_ = ValueOf(word) / 60;
    } else if (address == "M") {
      TakeM(word);
    } else if (address == "T") {
      ++tools_;
      fresh_ = true;
    } else {
      TakeOther(word);
    }
  }

  void TakeOther(const GcodeWord& word) {
    static const std::set<std::string> harmless{"D", "H", "SPOS", "CTOL", "OTOL", "FRC", "FRCM", "ADIS"};
    static const std::set<std::string> refused{"U",    "V",  "W",   "A2", "B2", "C2",  "A4",   "B4",  "C4",
                                               "A5",   "B5", "C5",  "AP", "RP", "RND", "RNDM", "CHF", "CHR",
                                               "STAT", "TU", "ANG", "A6", "B6", "C6",  "L"};
    if (refused.contains(word.address))
      throw InputError(word.place,
                       fmt::format("{} is not read: let the CAM system write X, Y, Z with A, B, C or "
                                   "A3, B3, C3",
                                   word.address));
    if (IsAssignment(word))
      variables_[word.address] = ValueOf(word);
    else if (!harmless.contains(word.address) && word.address[0] != 'S' && word.address[0] != 'M')
      ++unknown_[word.address.substr(0, 40)];
  }

  void TakeName(const GcodeWord& word, Block& block) {
    const std::string& name = word.address;
    if (name == "SUPA") {
      block.machine = true;
    } else if (name == "TRAORI") {
      SetTipProgramming(true);
    } else if (name == "TRAFOOF") {
      SetTipProgramming(false);
    } else if (name == "RET") {
      ended_ = true;
    } else if (name == "CYCLE800" && word.text.find_first_not_of(" ,\t") == std::string::npos) {
      return;  // swivels back
    } else if (const GcodeMeaning meaning = MeaningOfName(name); meaning == GcodeMeaning::kRefused) {
      throw InputError(word.place,
                       fmt::format("{} is not read: let the CAM system write G0, G1, G2 and G3", name));
    } else if (meaning == GcodeMeaning::kUnknown) {
      throw InputError(word.place,
                       fmt::format("\"{}\" is not known: subprogrammes, cycles and statements of the "
                                   "control are not read",
                                   name.substr(0, 40)));
    }
  }

  void TakeM(const GcodeWord& word) {
    const double m = ValueOf(word);
    if (m == 97 || m == 98)
      throw InputError(word.place, fmt::format("M{}: subprogrammes are not read: write their blocks out", m));
    if (m == 2 || m == 30 || m == 17 || m == 99) ended_ = true;
    if (m == 6) fresh_ = true;
  }

  // The tip stays where it is; what X, Y, Z mean changes.
  void SetTipProgramming(bool on) {
    if (on == tip_programmed_) return;
    const bool known = known_[0] && known_[1] && known_[2];
    if (known) {
      const Vector machine = tip_programmed_ ? options_.rotary_axes.Machine(base_, direction_.angles) : base_;
      base_ = on ? options_.rotary_axes.Tip(machine, direction_.angles) : machine;
      at_ = frame_.ToProgrammed(base_);
    } else {
      known_ = {};
    }
    tip_programmed_ = on;
  }

  void SetFeed() {
    if (!feed_word_) return;
    const double unit = inch_feed_ ? kInch : 1;
    if (feed_mode_ == 93) {
      inverse_time_ = *feed_word_ / 60;
      feed_ = 0;
      feed_word_.reset();  // holds for its block
    } else {
      feed_ = *feed_word_ * unit * (feed_mode_ == 95 ? revolutions_ : 1.0 / 60);
    }
  }

  void Move(const Block& block, const GcodeBlock& source) {
    if (block.machine || block.reference) return LeaveWorkpiece(block);
    GcodeWay way;
    way.start = direction_;
    way.place = source.words[0].place;
    if (block.HasTurn()) TakeDirection(block);
    if (!block.HasLinear() && !block.HasTurn() && !block.centre[0] && !block.centre[1] && !block.centre[2])
      return;
    Vector to = at_;
    for (int i = 0; i < 3; ++i) TakeCoordinate(block.linear[i], i, to);
    const bool placed = known_[0] && known_[1] && known_[2];
    const bool was_known = !path_.points.empty() && !lost_;
    if (motion_ > 0 && !placed)
      throw InputError(source.words[0].place, "a cut before X, Y and Z have been given in this system");
    const bool travels = block.HasLinear() || motion_ > 1;
    if (!placed || (!travels && !block.HasTurn())) {
      at_ = to;
      return;
    }
    way.from = at_;
    way.cut_from_known = was_known;
    if (motion_ > 1) {
      if (!was_known) throw InputError(way.place, "an arc needs a point before it");
      way.points = Arc(block, source, to);
    } else {
      way.points = {to};
    }
    Append(std::move(way));
    at_ = to;
    base_ = frame_.ToBase(at_);
    lost_ = false;
  }

  // Motions in machine coordinates lead away from the part: where, only the machine knows.
  void LeaveWorkpiece(const Block& block) {
    for (int i = 0; i < 3; ++i)
      if (block.linear[i] || block.reference) known_[i] = false;
    for (int i = 0; i < 3; ++i)
      if (block.rotary[i]) direction_.angles[i] = DegToRad(ValueOf(*block.rotary[i]));
    SetAxis();
    if (block.HasLinear() || block.reference || block.HasTurn()) lost_ = fresh_ = true;
  }

  void TakeCoordinate(const GcodeWord* word, int i, Vector& to) {
    if (!word) return;
    const double value = ValueOf(*word) * Unit();
    if (!(std::abs(value) <= kMaxLength))
      throw InputError(word->place, fmt::format("{} mm is beyond ±{} mm", value, kMaxLength));
    const bool step = word->kind == Kind::kIncremental || (incremental_ && word->kind != Kind::kAbsolute);
    if (step && !known_[i]) throw InputError(word->place, "a step from a place that is not known");
    to[i] = step ? at_[i] + value : value;
    known_[i] = true;
  }

  // Rotary axes and tool vectors; either replaces the other.
  void TakeDirection(const Block& block) {
    if (block.vector[0] || block.vector[1] || block.vector[2]) {
      Vector vector = Vector::Zero();
      const GcodeWord* any = nullptr;
      for (int i = 0; i < 3; ++i)
        if (block.vector[i]) {
          vector[i] = ValueOf(*block.vector[i]);
          any = block.vector[i];
        }
      if (!(vector.norm() > 1e-6 && vector.norm() < 1e6))
        throw InputError(any->place, "the tool vector has no length");
      direction_.axis = (frame_.linear() * vector).normalized();
      direction_.by_vector = true;
      return;
    }
    for (size_t i = 0; i < 3; ++i) {
      const GcodeWord* word = block.rotary[i];
      if (!word) continue;
      const double value = ValueOf(*word);
      if (!(std::abs(value) <= 1e5)) throw InputError(word->place, "an angle beyond ±100000 degrees");
      const bool step = word->kind == Kind::kIncremental || (incremental_ && word->kind != Kind::kAbsolute);
      double& angle = direction_.angles[i];
      angle = DegToRad(value) + (step ? angle : 0);
      const char letter = "ABC"[i];
      if (angle != 0 && !options_.rotary_axes.Has(letter))
        throw InputError(word->place,
                         fmt::format("the programme turns axis {0}, and toolpath.cam.rotary_axes does not "
                                     "state an axis {0}",
                                     letter));
    }
    direction_.by_vector = false;
    SetAxis();
  }

  void SetAxis() {
    if (!direction_.by_vector) direction_.axis = options_.rotary_axes.ToolAxis(direction_.angles);
  }

  std::vector<Vector> Arc(const Block& block, const GcodeBlock& source, const Vector& to) {
    GcodeArc arc;
    arc.from = at_;
    arc.to = to;
    arc.plane = plane_;
    arc.counter_clockwise = motion_ == 3;
    for (size_t i = 0; i < 3; ++i)
      if (const GcodeWord* word = block.centre[i]) {
        arc.centre[i] = ValueOf(*word) * Unit();
        arc.absolute[i] =
            word->kind == Kind::kAbsolute || (absolute_centre_ && word->kind != Kind::kIncremental);
      }
    if (block.radius) arc.radius = ValueOf(*block.radius) * Unit();
    if (block.turns) arc.full_turns = ValueOf(*block.turns);
    arc.place = source.words[0].place;
    ++arcs_;
    return PointsOf(arc, options_.chord_tolerance);
  }

  void Append(GcodeWay way) {
    way.end = direction_;
    way.tip_programmed = tip_programmed_;
    way.rapid = motion_ == 0;
    way.feed = feed_;
    way.inverse_time = std::exchange(inverse_time_, 0);
    if (feed_mode_ == 93 && !way.rapid && way.inverse_time == 0)
      throw InputError(way.place, "under G93 each cut needs its F");
    const size_t first = path_.points.size();
    AppendWay(way, frame_, options_, path_);
    path_.points[first].fresh = std::exchange(fresh_, false) && first > 0;
  }

  void AddNotes() {
    const auto note = [&](size_t count, std::string_view text) {
      if (count > 0) path_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(arcs_, "arcs expanded by the chord tolerance");
    if (tools_ > 1) note(tools_, "tool changes; all are taken as passes of one job");
    if (offsets_.size() > 1)
      note(offsets_.size(), "zero offsets are named; all are taken as the workpiece frame");
    note(skippable_, "blocks that may be skipped (\"/\") were read");
    size_t listed = 0;
    for (const auto& [word, count] : unknown_)
      if (++listed <= 50) note(count, fmt::format("\"{}\" not known, ignored", word));
    if (listed > 50) note(listed - 50, "further kinds of words not known, ignored");
  }

  GcodeScanner scanner_;
  const std::string& name_;
  const CamReadOptions& options_;
  CamPath path_;
  GcodeFrame frame_;
  int motion_ = 0, plane_ = 0, feed_mode_ = 94, line_ = 0;
  bool incremental_ = false, absolute_centre_ = false, inch_ = false, inch_feed_ = false;
  bool tip_programmed_ = false, ended_ = false;
  bool lost_ = false;   // the tool left the part for a place that is not known
  bool fresh_ = false;  // the next point is reached in a way that is no cut
  std::optional<double> feed_word_;
  double feed_ = 0, inverse_time_ = 0, revolutions_ = 0;  // mm/s, 1/s, 1/s
  Vector at_ = Vector::Zero();                            // programmed coordinates
  Vector base_ = Vector::Zero();                          // the same without frames
  std::array<bool, 3> known_{};                           // of X, Y, Z
  GcodeDirection direction_;
  std::map<std::string, double> variables_;
  std::map<std::string, size_t> unknown_;
  std::set<double> offsets_;
  size_t arcs_ = 0, tools_ = 0, skippable_ = 0;
};

}  // namespace

CamPath ReadGcode(std::string_view bytes, const std::string& name, const CamReadOptions& options) {
  return GcodeReader(bytes, name, options).Read();
}

}  // namespace millpose
