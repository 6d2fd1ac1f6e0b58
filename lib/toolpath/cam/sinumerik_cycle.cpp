// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <set>

#include "toolpath/cam/gcode_cycle.hpp"

namespace millpose {
namespace {

const std::set<std::string_view> kDrillingCycles{"CYCLE81", "CYCLE82", "CYCLE83"};
const std::set<std::string_view> kSpindleCycles{"CYCLE84", "CYCLE840", "CYCLE85", "CYCLE86",
                                                "CYCLE87", "CYCLE88",  "CYCLE89"};
constexpr double kCycle83Retract = 1;  // mm, CYCLE83's own where _VRT gives none
constexpr double kSameDepth = 1e-6;    // mm

}  // namespace

// The arguments of a call by their place; a text that is no number makes the hole one that is left out.
class SinumerikCycles::Arguments {
 public:
  Arguments(const std::string& text, const GcodeVariables& variables) {
    for (size_t begin = 0; begin <= text.size();) {
      const size_t end = std::min(text.find(',', begin), text.size());
      const std::string cell = text.substr(begin, end - begin);
      begin = end + 1;
      const bool empty = cell.find_first_not_of(" \t") == std::string::npos;
      values_.push_back(empty ? std::nullopt : variables.ValueOf(cell));
      if (!empty && !values_.back() && wrong_.empty()) wrong_ = cell;
    }
  }
  std::optional<double> operator[](size_t i) const { return i < values_.size() ? values_[i] : std::nullopt; }
  double Or0(size_t i) const { return (*this)[i].value_or(0); }
  /// An argument that is no number and no variable.
  const std::string& wrong() const { return wrong_; }
  /// The first argument from `first` on that is neither left out nor 0, besides those of `known`.
  std::optional<size_t> Unread(size_t first, const std::set<size_t>& known) const {
    for (size_t i = first; i < values_.size(); ++i)
      if (Or0(i) != 0 && !known.contains(i)) return i;
    return std::nullopt;
  }

 private:
  std::vector<std::optional<double>> values_;
  std::string wrong_;
};

bool SinumerikCycles::IsCycle(std::string_view name) {
  return kDrillingCycles.contains(name) || kSpindleCycles.contains(name);
}

void SinumerikCycles::Call(const GcodeWord& call, bool modal) {
  GcodeHole hole = Read(call);
  if (modal)
    modal_ = std::move(hole);
  else
    motion_.Drill({}, hole);
}

void SinumerikCycles::RunModal(const SourceLocation& place) {
  GcodeHole hole = *modal_;
  hole.place = place;
  motion_.Drill({}, hole);
}

// RTP, RFP, SDIS, DP, DPR: retraction and reference plane, distance before it, depth, depth below the
// reference.
void SinumerikCycles::ReadHeights(const Arguments& arguments, GcodeHole& hole) const {
  const double unit = modes_.Unit();
  hole.retract = unit * arguments.Or0(0);
  const double reference = unit * arguments.Or0(1);
  hole.clearance = reference + std::abs(unit * arguments.Or0(2));
  hole.retract = std::max(hole.retract, hole.clearance);
  if (!hole.left_out.empty()) return;
  if (!arguments.wrong().empty()) {
    hole.left_out = fmt::format("its argument \"{}\" is no number", arguments.wrong().substr(0, 40));
  } else if (!arguments[0] || !arguments[1] || (!arguments[3] && !arguments[4])) {
    hole.left_out = "it names no retraction plane, no reference plane or no depth";
  } else if (arguments[3] && arguments[4] &&
             std::abs(*arguments[3] - (*arguments[1] - std::abs(*arguments[4]))) > kSameDepth) {
    hole.left_out = "its two depths (DP and DPR) contradict";
  } else {
    ReadStrokes(arguments, hole, reference);
  }
}

void SinumerikCycles::ReadStrokes(const Arguments& arguments, GcodeHole& hole, double reference) const {
  const double unit = modes_.Unit();
  const double bottom = arguments[3] ? unit * *arguments[3] : reference - std::abs(unit * *arguments[4]);
  Drilling drilling{hole.clearance, {bottom}, 0};
  if (hole.name == "CYCLE83") {
    // FDEP, FDPR: the first depth; DAM: each further stroke is so much shorter; VARI 0 breaks chips.
    const double first = arguments[5]   ? unit * *arguments[5]
                         : arguments[6] ? reference - std::abs(unit * *arguments[6])
                                        : bottom;
    const double less = unit * arguments.Or0(7);
    if (less < 0 || arguments.Or0(11) < 0 || arguments.Or0(11) > 1 || first > hole.clearance ||
        first < bottom) {
      hole.left_out = "its first depth, degression or kind of work is not read";
      return;
    }
    drilling.bottoms = ShrinkingStrokes(reference, first, bottom, less, hole.place);
    drilling.chip_retract =
        arguments.Or0(11) == 0 ? (arguments.Or0(14) > 0 ? unit * arguments.Or0(14) : kCycle83Retract) : 0;
    if (arguments.Or0(10) > 0) hole.first_feed_share = arguments.Or0(10);
  }
  hole.strokes = Heights(drilling, hole.place);
}

GcodeHole SinumerikCycles::Read(const GcodeWord& call) const {
  GcodeHole hole;
  hole.name = call.address;
  hole.place = call.place;
  if (kSpindleCycles.contains(call.address))
    hole.left_out = "the cycle is not known to be straight motions alone";
  const Arguments arguments(call.text, variables_);
  // Behind the classic arguments: machining plane and which depth was stated; both may only say the usual.
  const bool deep = hole.name == "CYCLE83";
  const size_t plane = deep ? 18 : 7;
  const std::set<size_t> known = deep ? std::set<size_t>{14, 15, 16, 18, 19} : std::set<size_t>{7, 8};
  const double stated = arguments.Or0(plane);
  if (hole.left_out.empty() &&
      (arguments.Unread(deep ? 12 : 6, known) || (stated != 0 && stated != modes_.plane + 1)))
    hole.left_out =
        fmt::format("argument {} is not read", arguments.Unread(deep ? 12 : 6, known).value_or(plane) + 1);
  ReadHeights(arguments, hole);
  return hole;
}

}  // namespace millpose
