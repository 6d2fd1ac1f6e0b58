// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_cycle.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr double kAptChipRetract = 1;  // mm: the machine's own parameter; the hole is the same whatever it is

// What the words behind the kind of the cycle say.
struct Words {
  bool deep = false, chips = false;
  std::optional<double> depth, clearance, retract, step;
};

void LayStrokes(double depth, AptCycle& cycle) {
  Drilling drilling;
  drilling.clearance = cycle.clearance;
  drilling.bottoms = cycle.step ? EvenStrokes(cycle.clearance, -depth, *cycle.step, cycle.place)
                                : std::vector<double>{-depth};
  drilling.chip_retract = cycle.chip_retract;
  cycle.strokes = Heights(drilling, cycle.place);
}

class CycleReader {
 public:
  CycleReader(const AptStatement& statement, AptFeed feed, double unit)
      : statement_(statement), feed_(feed), unit_(unit) {}

  AptCycle Read() {
    const std::string kind = Text(0);
    cycle_.name = "CYCLE/" + kind.substr(0, 20);
    if (kind != "DRILL" && kind != "DEEP" && kind != "FACE" && kind != "BRKCHP") {
      cycle_.left_out = "it is not known to be a straight motion in and out alone";
      return cycle_;
    }
    words_.deep = kind == "DEEP";
    words_.chips = kind == "BRKCHP";
    cycle_.place = statement_.major.place;
    if (ParseNumber(Text(1))) TakePlaces();
    while (at_ < statement_.minors.size() && cycle_.left_out.empty()) TakeWord();
    if (cycle_.left_out.empty()) Finish();
    cycle_.feed = feed_.Rate();
    return cycle_;
  }

 private:
  std::string Text(size_t i) const { return i < statement_.minors.size() ? statement_.minors[i].text : ""; }

  double Length() {
    const auto number = ParseNumber(Text(at_));
    if (!number)
      throw InputError(at_ < statement_.minors.size() ? statement_.minors[at_].place : statement_.major.place,
                       fmt::format("{} needs a number behind {}, found \"{}\"", cycle_.name, Text(at_ - 1),
                                   Text(at_).substr(0, 40)));
    ++at_;
    return unit_ * *number;
  }

  static bool IsFeedUnit(const std::string& word) {
    return word == "MMPM" || word == "IPM" || word == "MMPR" || word == "IPR" || word == "PERMIN" ||
           word == "PERREV";
  }

  // "12,MMPM,120,5" and "12,120,MMPM,5": depth, feed, clearance. Where the unit is last, or missing, the
  // order is not the same in all files.
  void TakePlaces() {
    words_.depth = Length();
    if (Text(at_) == "INCR" || Text(at_) == "STEP") {
      ++at_;
      words_.step = Length();
    }
    const bool unit_first = IsFeedUnit(Text(at_)) && ParseNumber(Text(at_ + 1));
    const bool unit_behind = !unit_first && ParseNumber(Text(at_)) && IsFeedUnit(Text(at_ + 1));
    if (unit_first == unit_behind || !ParseNumber(Text(at_ + 2))) {
      cycle_.left_out =
          "its numbers without words are read as depth, unit of feed, feed, clearance, or as depth, feed, "
          "unit, "
          "clearance alone";
      return;
    }
    AptStatement feed;
    feed.major = statement_.minors[at_];
    feed.minors = {statement_.minors[at_], statement_.minors[at_ + 1]};
    feed_.Take(feed, unit_);
    at_ += 2;
    words_.clearance = Length();
    if (!(*words_.depth > 0) || !(*words_.clearance >= 0))
      throw InputError(
          statement_.major.place,
          fmt::format("{}: a depth above 0 and a clearance of 0 or more are read by places, found "
                      "{:.6g} mm and {:.6g} mm",
                      cycle_.name, *words_.depth, *words_.clearance));
    cycle_.by_place = words_.depth;
    while (Text(at_) == "DWELL" || (Text(at_).empty() && at_ < statement_.minors.size())) {
      ++at_;
      if (Text(at_ - 1) == "DWELL") TakeDwell();
    }
    if (at_ < statement_.minors.size())
      cycle_.left_out =
          fmt::format("its word \"{}\" behind numbers without words is not known", Text(at_).substr(0, 40));
  }

  void TakeWord() {
    const std::string word = Text(at_++);
    if (word == "DEEP") {
      words_.deep = true;
    } else if (word == "BRKCHP") {
      words_.chips = true;
    } else if (word == "DEPTH") {
      words_.depth = Length();
    } else if (word == "FEDTO") {
      TakeFedto();
    } else if (word == "CLEAR" || word == "RAPTO") {
      words_.clearance = Length();
    } else if (word == "RTRCTO") {
      if (Text(at_) == "AUTO" || Text(at_) == "MANUAL")
        ++at_;
      else
        words_.retract = Length();
    } else if (word == "STEP" || word == "INCR") {
      words_.step = Length();
    } else if (word == "DWELL") {
      TakeDwell();
    } else if (IsFeedUnit(word)) {
      TakeFeed();
    } else if (word != "AUTO" && word != "MANUAL") {
      cycle_.left_out = fmt::format("its word \"{}\" is not known", word.substr(0, 40));
    }
  }

  // NX: a height below the point; other systems: a depth. Only the first has a sign of its own.
  void TakeFedto() {
    const double height = Length();
    if (height < 0)
      words_.depth = -height;
    else
      cycle_.left_out = "FEDTO above 0 may be a depth or a height";
  }

  // DWELL,t or DWELL,REV,n: time alone.
  void TakeDwell() {
    if (Text(at_) == "REV" || Text(at_) == "SEC" || Text(at_) == "ON") ++at_;
    if (ParseNumber(Text(at_))) ++at_;
  }

  void TakeFeed() {
    AptStatement feed;
    feed.major = statement_.minors[at_ - 1];
    feed.minors = {statement_.minors[at_ - 1]};
    if (at_ < statement_.minors.size()) feed.minors.push_back(statement_.minors[at_++]);
    feed_.Take(feed, unit_);
  }

  void Finish() {
    if (!words_.depth || !words_.clearance) {
      cycle_.left_out =
          words_.depth ? "it names no clearance (CLEAR, RAPTO)" : "it names no depth (DEPTH, FEDTO)";
      return;
    }
    if ((words_.deep || words_.chips) && !words_.step) {
      cycle_.left_out = "it names no STEP";
      return;
    }
    cycle_.clearance = *words_.clearance;
    cycle_.step = words_.step;
    cycle_.chip_retract = words_.chips ? kAptChipRetract : 0;
    cycle_.retract = std::max(cycle_.clearance, words_.retract.value_or(cycle_.clearance));
    LayStrokes(*words_.depth, cycle_);
  }

  const AptStatement& statement_;
  AptFeed feed_;
  double unit_;
  AptCycle cycle_;
  Words words_;
  size_t at_ = 1;
};

}  // namespace

AptCycle FromBottom(const AptCycle& cycle, double height) {
  AptCycle moved = cycle;
  moved.clearance = moved.retract = cycle.clearance - height;
  LayStrokes(0, moved);
  return moved;
}

AptCycle ReadCycle(const AptStatement& statement, AptFeed feed, double unit) {
  return CycleReader(statement, feed, unit).Read();
}

}  // namespace millpose
