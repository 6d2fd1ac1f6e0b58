// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/text.hpp"
#include "toolpath/cam/gcode_cutters.hpp"
#include "toolpath/cam/gcode_cycle.hpp"
#include "toolpath/cam/gcode_leftover.hpp"
#include "toolpath/cam/gcode_words.hpp"
#include "toolpath/cam/heidenhain.hpp"
#include "toolpath/cam/word_tally.hpp"
#include "toolpath/cam/zero_offset.hpp"

namespace millpose {
namespace {

using Kind = GcodeWord::Kind;

// "S1=", "M1=": of one spindle.
bool IsOfOneSpindle(const std::string& address) {
  return address.size() == 2 && (address[0] == 'S' || address[0] == 'M') && address[1] >= '0' &&
         address[1] <= '9';
}

class GcodeReader {
 public:
  GcodeReader(std::string_view bytes, const std::string& name, const CamReadOptions& options)
      : scanner_(bytes, name),
        bytes_(bytes),
        name_(name),
        options_(options),
        recognised_(options.sender ? Recognised{*options.sender, ""} : RecogniseSender(bytes, true)),
        rules_(&RulesOf(recognised_.sender)),
        value_of_([this](const GcodeWord& word) { return variables_.ValueOf(word); }),
        motion_(options, modes_, sections_, path_, value_of_),
        cycles_(modes_, motion_),
        calls_(modes_, motion_, variables_),
        heidenhain_(modes_, motion_, value_of_) {}

  CamPath Read() {
    motion_.SetTipProgramming(options_.tip_programming.value_or(false));
    modes_.inch = modes_.inch_feed = options_.unit.value_or(1) != 1;
    motion_.StartWithOffset(rules_->offset);
    if (!options_.offsets.empty()) CheckFirstOffset();
    GcodeBlock block;
    try {
      while (!ended_ && scanner_.Next(block)) {
        skippable_ += block.skippable ? 1 : 0;
        if (scanner_.heidenhain()) rules_ = &RulesOf(CamSender::kHeidenhain);
        Take(block);
      }
      if (tally_.empty()) CheckUnit();
    } catch (const InputError& error) {
      tally_.RefuseUnknown(error.problems());
    }
    tally_.RefuseUnknown({});
    if (path_.points.empty() && path_.holes_left_out.empty())
      throw InputError({name_}, "the program holds no motion");
    CheckReach(path_, name_);
    AddNotes();
    AddSource();
    return std::move(path_);
  }

 private:
  // Where offsets are stated, the one in force before a word names one is among them or never cut under.
  void CheckFirstOffset() {
    const std::string first(rules_->offset);
    if (options_.offsets.contains(first)) motion_.SetOffset(first, {name_});
  }

  void CheckUnit() const {
    if (modes_.unit_taken == 0 || options_.unit) return;
    throw InputError({name_, modes_.unit_taken},
                     "no G20, G21 (G70, G71, G700, G710) stands before the program's lengths: state "
                     "toolpath.cam.unit: mm or inch, whichever the control assumes");
  }

  void Take(const GcodeBlock& source) {
    if (variables_.Take(source)) return;
    if (IsProgrammeName(source)) return;
    if (GcodeFrame::IsFrameWord(source.words[0].address)) return motion_.TakeFrame(source);
    GcodeMove move;
    move.place = source.words[0].place;
    parameters_.clear();
    call_ = nullptr;
    offset_ = nullptr;
    changes_tool_ = moves_ = false;
    if (scanner_.heidenhain() && heidenhain_.TakeBlock(source, move)) return;
    if (GoesToFixedPoint(source)) {
      move.reference = true;
      return motion_.Move(move);
    }
    for (const GcodeWord& word : source.words)
      if (word.address == "G" && !(scanner_.heidenhain() && heidenhain_.TakeG(word))) TakeG(word, move);
    for (const GcodeWord& word : source.words)
      if (word.address != "G") TakeWord(word, move);
    if (changes_tool_) sections_.ChangeTool();
    if (offset_) motion_.SetOffset(ZeroOffsetOf(*offset_, move, moves_, *rules_, value_of_), offset_->place);
    TakeTurns(move);
    const bool cycle = cycles_.active() && !move.machine && !move.reference;
    if (call_ && (move.dwell || cycle))
      throw InputError(call_->place, fmt::format("{} together with {} in one block is not read",
                                                 call_->address, move.dwell ? "a dwell" : "another cycle"));
    if (move.dwell) return;
    modes_.SetFeed();
    if (scanner_.heidenhain()) heidenhain_.TakePole(move);
    CheckNumbers(move);
    if (cycle) return cycles_.Run(move, value_of_);
    motion_.Move(move);
    if (call_) {
      calls_.Call(*call_, false);
      call_ = nullptr;
    } else if (calls_.modal() && move.HasLinear() && !move.machine && !move.reference) {
      calls_.RunModal(move.place);
    }
  }

  // P of an arc, where no other word of the block takes it.
  void TakeTurns(GcodeMove& move) {
    const bool arc = modes_.motion > 1 && !cycles_.active();
    if (!arc || !rules_->turns_by_p || parameters_.find('P') != std::string::npos) return;
    if (!move.HasLinear() && !move.HasCentre() && !move.radius) return;
    if (const GcodeWord* p = move.Parameter('P')) {
      move.turns_begun = p;
      parameters_ += 'P';
    }
  }

  // "ONONAME", ":100", "O100": the first word of a program may be its name.
  bool IsProgrammeName(const GcodeBlock& source) {
    const bool first = !begun_;
    begun_ = true;
    return first && source.words.size() == 1 && source.words[0].kind == Kind::kName &&
           source.words[0].address[0] == 'O';
  }

  // "G74 X1=0", "G75 Z1=0": SINUMERIK's reference and fixed points, of machine axes.
  bool GoesToFixedPoint(const GcodeBlock& source) const {
    const auto any = [&](auto&& is) { return std::ranges::any_of(source.words, is); };
    return any([&](const GcodeWord& w) {
             return w.address == "G" && (value_of_(w) == 74 || value_of_(w) == 75);
           }) &&
           any([](const GcodeWord& w) {
             return w.address.size() == 2 && w.address[0] != 'R' && w.address[1] >= '0' &&
                    w.address[1] <= '9';
           });
  }

  void TakeG(const GcodeWord& word, GcodeMove& move) {
    const double g = value_of_(word);
    const auto is = [&](std::initializer_list<double> list) {
      return std::ranges::find(list, g) != list.end();
    };
    parameters_ += ParametersOfG(g);
    if (modes_.TakeG(g)) {
      if (g <= 3) {
        cycles_.End();
        moves_ = true;
      }
    } else if (is({43.4, 43.5, 234, 49})) {
      motion_.SetTipProgramming(g != 49);
      modes_.vector_in_ijk = g == 43.5;
    } else if (is({53, 153})) {
      move.machine = true;
    } else if (is({28, 30})) {
      move.reference = true;
      parameters_ += "UVW";
    } else if (is({4})) {
      move.dwell = true;
    } else if (!cycles_.TakeG(g)) {
      TakeOtherG(word, g);
    }
    if (cycles_.active()) parameters_ += "PQL";
  }

  void TakeOtherG(const GcodeWord& word, double g) {
    const GcodeMeaning meaning = MeaningOfG(g);
    if (meaning == GcodeMeaning::kRefused)
      throw InputError(word.place,
                       fmt::format("G{} is not read: let the CAM system write G0, G1, G2 and G3", g));
    const std::string text = fmt::format("G{}", g);
    if (g == 5) {
      high_speed_ = true;
      return;
    }
    if (meaning == GcodeMeaning::kUnknown)
      tally_.AddUnknown(text, word.place);
    else
      tally_.CountHarmless(text);
    if (IsZeroOffset(g)) TakeOffsetWord(word);
  }

  void TakeOffsetWord(const GcodeWord& word) {
    if (scanner_.heidenhain()) return;
    if (offset_) throw InputError(word.place, "two zero offsets in one block");
    offset_ = &word;
  }

  void TakeWord(const GcodeWord& word, GcodeMove& move) {
    const std::string& address = word.address;
    if (word.kind == Kind::kName || word.kind == Kind::kCall) return TakeName(word, move);
    if (move.Put(word, modes_.vector_in_ijk)) return;
    if (address == "CR" || address == "R") {
      move.radius = &word;
    } else if (address == "TURN") {
      move.turns = &word;
    } else if (address == "F") {
      if (!move.dwell) modes_.feed_word = value_of_(word);
    } else if (address == "S") {
      if (!move.dwell && word.kind != Kind::kText) TakeSpeed(word);
    } else if (address == "M") {
      TakeM(word, move);
    } else if (address == "T") {
      ++tools_;
      motion_.NameTool();
      sections_.NameTool(word.kind == Kind::kText ? word.text : ShortestNumber(value_of_(word)));
    } else if (IsOfOneSpindle(address)) {
      if (address[0] == 'S')
        TakeSpeed(word);
      else
        TakeSense(value_of_(word));
    } else if (address.size() == 1 && std::string_view("PQLEUVW").find(address) != std::string::npos) {
      move.parameters[address[0]] = &word;
    } else {
      TakeOther(word);
    }
  }

  void TakeSpeed(const GcodeWord& word) {
    const double value = value_of_(word);
    if (!(value >= 0)) throw InputError(word.place, "a spindle speed below 0");
    modes_.revolutions = value / 60;
    if (value > 0) sections_.SetSpeed(value / 60);
  }

  // M13 and M14 switch the coolant on as well.
  void TakeSense(double m) {
    if (m == 3 || m == 13) sections_.SetSense(SpindleSense::kClockwise);
    if (m == 4 || m == 14) sections_.SetSense(SpindleSense::kCounterClockwise);
  }

  void TakeOther(const GcodeWord& word) {
    const GcodeMeaning meaning = MeaningOfAddress(word.address);
    if (meaning == GcodeMeaning::kRefused)
      throw InputError(word.place,
                       fmt::format("{} is not read: let the CAM system write X, Y, Z with A, B, C or "
                                   "A3, B3, C3",
                                   word.address));
    if (variables_.IsAssignment(word)) return;  // taken over before
    if (meaning == GcodeMeaning::kUnknown)
      tally_.AddUnknown(word.address, word.place);
    else
      tally_.CountHarmless(word.address);
  }

  void TakeName(const GcodeWord& word, GcodeMove& move) {
    const std::string& name = word.address;
    const bool empty = word.text.find_first_not_of(" ,\t") == std::string::npos;
    if (name == "SUPA") {
      move.machine = true;
    } else if (name == "TRAORI") {
      if (word.text.find(',') != std::string::npos)
        throw InputError(word.place, "TRAORI with a basic orientation is not read");
      motion_.SetTipProgramming(true);
    } else if (name == "TRAFOOF") {
      motion_.SetTipProgramming(false);
    } else if (name == "RET") {
      ended_ = true;
    } else if (name == "MCALL") {
      calls_.EndModal();
      modal_line_ = word.place.line;
    } else if (SinumerikCycles::IsCycle(name)) {
      TakeCall(word);
    } else if (const GcodeMeaning meaning = MeaningHere(name, empty); meaning == GcodeMeaning::kRefused) {
      throw InputError(word.place,
                       fmt::format("{} is not read: let the CAM system write G0, G1, G2 and G3", name));
    } else if (meaning == GcodeMeaning::kUnknown) {
      throw InputError(word.place,
                       fmt::format("\"{}\" is not known: subprograms, cycles and statements of the "
                                   "control are not read",
                                   name.substr(0, 40)));
    } else {
      tally_.CountHarmless(name);
    }
  }

  GcodeMeaning MeaningHere(const std::string& name, bool empty) const {
    const bool swivels_back = name == "CYCLE800" && empty;
    if (swivels_back || (scanner_.heidenhain() && Heidenhain::IsHarmlessName(name)))
      return GcodeMeaning::kHarmless;
    return MeaningOfName(name);
  }

  // MCALL stands before the cycle that it makes modal.
  void TakeCall(const GcodeWord& word) {
    if (modal_line_ == word.place.line)
      calls_.Call(word, true);
    else
      call_ = &word;
  }

  void TakeM(const GcodeWord& word, GcodeMove& move) {
    const double m = value_of_(word);
    parameters_ += ParametersOfM(m);
    TakeSense(m);
    if (scanner_.heidenhain() && heidenhain_.TakeM(m, word.place, move)) return;
    if (m == 97 || m == 98)
      throw InputError(word.place, fmt::format("M{}: subprograms are not read: write their blocks out", m));
    if (m == 2 || m == 30 || m == 17 || m == 99) ended_ = true;
    if (m == 6) {
      motion_.SetFresh();
      changes_tool_ = true;
    }
    if (SwitchKinematics(m, word.place)) return;
    if (!IsKnownM(m)) ++unknown_m_[m];
  }

  // M128 and M129 are tip programming on Heidenhain's controls, M428 to M430 are what each LinuxCNC machine
  // makes of them.
  bool SwitchKinematics(double m, const SourceLocation& place) {
    const auto stated =
        std::ranges::find(options_.kinematics_codes, m, [](const auto& code) { return code.first; });
    if (stated != options_.kinematics_codes.end()) {
      motion_.SetTipProgramming(stated->second);
      return true;
    }
    if (m != 128 && m != 129 && m != 428 && m != 429 && m != 430) return false;
    if (options_.tip_programming) return true;
    RefuseKinematics(m, place);
  }

  void CheckNumbers(const GcodeMove& move) {
    const GcodeWord* p = move.Parameter('P');
    if (std::exchange(high_speed_, false)) CheckHighSpeed(move, p ? value_of_(*p) : -1, tally_);
    CheckLeftOver(move, modes_, cycles_.active(), parameters_, tally_);
  }

  void AddNotes() {
    const auto note = [&](size_t count, std::string_view text) {
      if (count > 0) path_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(motion_.arcs(), "arcs expanded by the chord tolerance");
    note(motion_.holes(),
         "holes of drilling cycles, in and out straight at the programmed feed, without dwells");
    if (tools_ > 1) note(tools_, "tool changes");
    note(skippable_, "blocks that may be skipped (\"/\") were read");
    std::string list;
    for (const auto& [m, count] : unknown_m_)
      list += fmt::format("{}M{} ({})", list.empty() ? "" : ", ", m, count);
    if (!list.empty()) path_.notes.push_back("M codes that are not known, taken for no motion: " + list);
    tally_.AddNote(path_.notes);
  }

  void AddSource() {
    if (sections_.changes_by_m6()) motion_.KeepNamedWays();
    sections_.Finish(CuttersInComments(bytes_, modes_.Unit()), path_);
    CamSource& source = path_.source;
    source.sender = std::string(rules_->name);
    if (options_.sender) source.sender += " (by toolpath.cam.sender)";
    if (!recognised_.conflict.empty()) source.sender += ", with marks of " + recognised_.conflict;
    source.unit = modes_.inch ? "inches" : "mm";
    source.unit += modes_.unit_taken > 0 ? ", by toolpath.cam.unit" : ", by its G words";
    if (modes_.unit_taken > 0 && options_.unit) path_.keys_used.insert("unit");
    source.frame = motion_.offset().empty() ? "as written" : motion_.offset();
  }

  GcodeScanner scanner_;
  std::string_view bytes_;
  const std::string& name_;
  const CamReadOptions& options_;
  Recognised recognised_;
  const SenderRules* rules_;
  CamPath path_;
  SectionTracker sections_;
  GcodeModes modes_;
  GcodeVariables variables_;
  GcodeMotion::ValueOf value_of_;
  GcodeMotion motion_;
  GcodeCycles cycles_;
  SinumerikCycles calls_;
  Heidenhain heidenhain_;
  WordTally tally_;
  std::string parameters_;                     // letters that the block's G and M words take
  const GcodeWord* call_ = nullptr;            // a cycle of this block
  const GcodeWord* offset_ = nullptr;          // a zero offset of this block
  bool changes_tool_ = false, moves_ = false;  // M6, G0 to G3 in this block
  int modal_line_ = 0;                         // of the last MCALL
  bool ended_ = false, begun_ = false, high_speed_ = false;
  std::map<double, size_t> unknown_m_;
  size_t tools_ = 0, skippable_ = 0;
};

}  // namespace

CamPath ReadGcode(std::string_view bytes, const std::string& name, const CamReadOptions& options) {
  return GcodeReader(bytes, name, options).Read();
}

}  // namespace millpose
