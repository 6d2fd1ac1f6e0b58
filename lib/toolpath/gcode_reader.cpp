// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <set>

#include "base/text.hpp"
#include "toolpath/gcode_motion.hpp"
#include "toolpath/gcode_words.hpp"

namespace millpose {
namespace {

using Kind = GcodeWord::Kind;

class GcodeReader {
 public:
  GcodeReader(std::string_view bytes, const std::string& name, const CamReadOptions& options)
      : scanner_(bytes, name),
        name_(name),
        motion_(options, modes_, path_, [this](const GcodeWord& word) { return ValueOf(word); }) {}

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
    if (TakeDefinition(source)) return;
    if (GcodeFrame::IsFrameWord(source.words[0].address)) return motion_.TakeFrame(source);
    GcodeMove move;
    move.place = source.words[0].place;
    for (const GcodeWord& word : source.words)
      if (word.address == "G") TakeG(word, move);
    for (const GcodeWord& word : source.words)
      if (word.address != "G") TakeWord(word, move);
    if (move.dwell) return;
    modes_.SetFeed();
    motion_.Move(move);
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

  void TakeG(const GcodeWord& word, GcodeMove& move) {
    const double g = ValueOf(word);
    const auto is = [&](std::initializer_list<double> list) {
      return std::ranges::find(list, g) != list.end();
    };
    if (is({0, 1, 2, 3})) {
      modes_.motion = static_cast<int>(g);
    } else if (is({17, 18, 19})) {
      modes_.plane = static_cast<int>(g) - 17;
    } else if (is({20, 70, 700})) {
      modes_.inch = true;
      modes_.inch_feed = g != 70;
    } else if (is({21, 71, 710})) {
      modes_.inch = modes_.inch_feed = false;
    } else if (is({90, 91})) {
      modes_.incremental = g == 91;
    } else if (is({90.1, 91.1})) {
      modes_.absolute_centre = g == 90.1;
    } else if (is({93, 94, 95})) {
      modes_.feed_mode = static_cast<int>(g);
      modes_.feed_word.reset();
    } else if (is({43.4})) {
      motion_.SetTipProgramming(true);
    } else if (is({49})) {
      motion_.SetTipProgramming(false);
    } else if (is({53, 153})) {
      move.machine = true;
    } else if (is({28, 30})) {
      move.reference = true;
    } else if (is({4})) {
      move.dwell = true;
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

  void TakeWord(const GcodeWord& word, GcodeMove& move) {
    const std::string& address = word.address;
    const auto slot = [&](std::string_view letters) { return letters.find(address[0]); };
    if (word.kind == Kind::kName || word.kind == Kind::kCall) return TakeName(word, move);
    if (address.size() == 1 && slot("XYZ") != std::string::npos) {
      move.linear[slot("XYZ")] = &word;
    } else if (address.size() == 1 && slot("ABC") != std::string::npos) {
      move.rotary[slot("ABC")] = &word;
    } else if (address.size() == 1 && slot("IJK") != std::string::npos) {
      move.centre[slot("IJK")] = &word;
    } else if (address.size() == 2 && address[1] == '3' && slot("ABC") != std::string::npos) {
      move.vector[slot("ABC")] = &word;
    } else if (address == "CR" || address == "R") {
      move.radius = &word;
    } else if (address == "TURN") {
      move.turns = &word;
    } else if (address == "F") {
      if (!move.dwell) modes_.feed_word = ValueOf(word);
    } else if (address == "S") {
      if (!move.dwell && word.kind != Kind::kText) modes_.revolutions = ValueOf(word) / 60;
    } else if (address == "M") {
      TakeM(word);
    } else if (address == "T") {
      ++tools_;
      motion_.SetFresh();
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

  void TakeName(const GcodeWord& word, GcodeMove& move) {
    const std::string& name = word.address;
    if (name == "SUPA") {
      move.machine = true;
    } else if (name == "TRAORI") {
      motion_.SetTipProgramming(true);
    } else if (name == "TRAFOOF") {
      motion_.SetTipProgramming(false);
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
    if (m == 6) motion_.SetFresh();
  }

  void AddNotes() {
    const auto note = [&](size_t count, std::string_view text) {
      if (count > 0) path_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(motion_.arcs(), "arcs expanded by the chord tolerance");
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
  CamPath path_;
  GcodeModes modes_;
  GcodeMotion motion_;
  bool ended_ = false;
  std::map<std::string, double> variables_;
  std::map<std::string, size_t> unknown_;
  std::set<double> offsets_;
  size_t tools_ = 0, skippable_ = 0;
};

}  // namespace

CamPath ReadGcode(std::string_view bytes, const std::string& name, const CamReadOptions& options) {
  return GcodeReader(bytes, name, options).Read();
}

}  // namespace millpose
