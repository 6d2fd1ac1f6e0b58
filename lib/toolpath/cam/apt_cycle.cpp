// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_cycle.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr double kChipRetract = 1;  // mm: the machine's own parameter; the hole is the same whatever it is

// What the words behind the kind of the cycle say.
struct Words {
  bool deep = false, chips = false;
  std::optional<double> depth, clearance, retract, step;
};

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
    for (at_ = 1; at_ < statement_.minors.size() && cycle_.left_out.empty();) TakeWord();
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
    } else if (word == "STEP") {
      words_.step = Length();
    } else if (word == "DWELL") {
      TakeDwell();
    } else if (word == "MMPM" || word == "IPM" || word == "MMPR" || word == "IPR" || word == "PERMIN" ||
               word == "PERREV") {
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
    Drilling drilling;
    const Place& place = statement_.major.place;
    drilling.clearance = cycle_.clearance = *words_.clearance;
    drilling.bottoms = words_.step ? EvenStrokes(*words_.clearance, -*words_.depth, *words_.step, place)
                                   : std::vector<double>{-*words_.depth};
    drilling.chip_retract = words_.chips ? kChipRetract : 0;
    cycle_.retract = std::max(cycle_.clearance, words_.retract.value_or(cycle_.clearance));
    cycle_.strokes = Heights(drilling, place);
  }

  const AptStatement& statement_;
  AptFeed feed_;
  double unit_;
  AptCycle cycle_;
  Words words_;
  size_t at_ = 1;
};

}  // namespace

AptCycle ReadCycle(const AptStatement& statement, AptFeed feed, double unit) {
  return CycleReader(statement, feed, unit).Read();
}

}  // namespace millpose
