// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/compare_events.hpp"

#include "machine/robot/kinematics.hpp"
#include "program/program_place.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

using Kind = ProgramEvent::Kind;

constexpr double kSameSeconds = 0.5e-3;  // of dwells and delays
constexpr size_t kMostApart = 64;        // events that are more or missing in one place

/// An event, and where it happens.
struct Happening {
  const ProgramEvent* event = nullptr;
  size_t runs = 0;      ///< cuts before it, the one that it is in among them
  bool within = false;  ///< a cut
  bool head = false;    ///< before the first motion
  Joints q = Joints::Zero();
  ExternalPosition external;
  Pose X_PT = Pose::Identity();
};

bool MadeByTextsAlone(Kind kind) { return kind >= Kind::kText; }

bool Counts(const MotionProgram& program, const ProgramEvent& event, bool all, bool spindle) {
  if (event.kind == Kind::kHandover) return false;
  if (event.kind == Kind::kSpindleOn || event.kind == Kind::kSpindleOff) return spindle;
  if (event.kind == Kind::kDwell && !all) return PlaceOf(program, event.before_motion) == ProgramPlace::kStop;
  return all || !MadeByTextsAlone(event.kind);
}

/// `all`: those of texts and hands too; `spindle`: the cell has texts that switch it.
std::vector<Happening> HappeningsOf(const Replayed& replayed, bool all, bool spindle, const Cell& cell) {
  std::vector<Happening> list;
  size_t runs = 0;
  for (const ProgramEvent& event : replayed.program.events) {
    if (!Counts(replayed.program, event, all, spindle)) continue;
    while (runs < replayed.runs.size() && replayed.runs[runs].first < event.before_motion) ++runs;
    Happening here;
    here.event = &event;
    here.runs = runs;
    here.within = runs > 0 && event.before_motion <= replayed.runs[runs - 1].last;
    here.head = event.before_motion == 0;
    const size_t before = here.head ? 0 : event.before_motion - 1;
    here.q = replayed.replay.targets[before];
    here.external = replayed.program.motions[before].external;
    here.X_PT = BaseInPart(cell, here.external) * ForwardFlange(cell.arm, here.q) * cell.X_FT;
    list.push_back(std::move(here));
  }
  return list;
}

bool SameAction(const ProgramEvent& a, const ProgramEvent& b, const VerifyOptions& options) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case Kind::kSpindleOn:
      return std::abs(a.value - b.value) <= options.spindle_tolerance;
    case Kind::kPassBegin:
    case Kind::kPassEnd:
      return a.value == b.value && a.piece == b.piece;
    case Kind::kOutput:
      return a.output.number == b.output.number && a.output.on == b.output.on &&
             std::abs(a.output.delay - b.output.delay) < kSameSeconds;
    case Kind::kDwell:
      return std::abs(a.value - b.value) < kSameSeconds;
    default:
      return a.text == b.text;
  }
}

/// In a cut the tip tells the place, beside it the joints and the external axes.
bool SamePlace(const Happening& a, const Happening& b, const VerifyOptions& options) {
  if (a.runs != b.runs || a.head != b.head) return false;
  if (a.head) return true;
  const double tip = (a.X_PT.translation() - b.X_PT.translation()).norm();
  if ((a.within && b.within) || a.event->kind == Kind::kOutput) return tip <= options.position_tolerance;
  for (size_t k = 0; k < std::min(a.external.size(), b.external.size()); ++k)
    if (std::abs(a.external[k] - b.external[k]) > options.position_tolerance) return false;
  return (a.q - b.q).cwiseAbs().maxCoeff() <= options.gap_tolerance;
}

class EventComparison {
 public:
  EventComparison(const Replayed& replayed, std::vector<Happening> given, std::vector<Happening> wanted,
                  const VerifyOptions& options, std::vector<Finding>& findings)
      : replayed_(replayed),
        given_(std::move(given)),
        wanted_(std::move(wanted)),
        options_(options),
        findings_(findings) {}

  void Compare() {
    size_t i = 0, k = 0;
    while (i < given_.size() || k < wanted_.size()) {
      if (Match(i, k)) {
        ++i, ++k;
        continue;
      }
      const auto [more, missing] = NextMatch(i, k);
      if (more == 0 && missing == 0) return Differ(i, k);
      for (size_t n = 0; n < std::max(more, missing); ++n) {
        if (n < more && n < missing)
          Differ(i + n, k + n);
        else if (n < more)
          Say(given_[i + n], fmt::format("{} is not planned here", Describe(*given_[i + n].event)));
        else
          Missing(i, k + n);
      }
      i += more, k += missing;
    }
  }

 private:
  bool Match(size_t i, size_t k) const {
    return i < given_.size() && k < wanted_.size() && Same(given_[i], wanted_[k]);
  }
  bool Same(const Happening& a, const Happening& b) const {
    return SameAction(*a.event, *b.event, options_) && SamePlace(a, b, options_);
  }

  /// How many of both to go on by to the next that match, or to both ends.
  std::pair<size_t, size_t> NextMatch(size_t i, size_t k) const {
    for (size_t sum = 1; sum <= 2 * kMostApart; ++sum)
      for (size_t more = 0; more <= sum; ++more) {
        const size_t missing = sum - more;
        const bool ends = i + more == given_.size() && k + missing == wanted_.size();
        if (ends || Match(i + more, k + missing)) return {more, missing};
      }
    return {0, 0};
  }

  void Differ(size_t i, size_t k) {
    if (i >= given_.size()) return Missing(i, k);
    if (k >= wanted_.size()) return Say(given_[i], Describe(*given_[i].event) + " is not planned here");
    const ProgramEvent &given = *given_[i].event, &wanted = *wanted_[k].event;
    if (SameAction(given, wanted, options_))
      Say(given_[i], fmt::format("{} happens elsewhere than planned", Describe(given)));
    else
      Say(given_[i], fmt::format("{} is here, planned is {}", Describe(given), Describe(wanted)));
  }

  void Say(const Happening& given, const std::string& message) {
    const size_t motion = std::min(given.event->before_motion, replayed_.program.motions.size() - 1);
    Finding finding = At(replayed_.program, motion, CauseOf(*given.event), message);
    if (given.event->line > 0) {
      finding.line = given.event->line;
      const auto file = static_cast<size_t>(given.event->file);
      if (file < replayed_.program.files.size()) finding.file = replayed_.program.files[file];
    }
    findings_.push_back(finding);
  }

  /// What is missing shows behind the event before it, and where the cut before it ends.
  void Missing(size_t i, size_t k) {
    const Happening& wanted = wanted_[k];
    const size_t runs = std::min(wanted.runs, replayed_.runs.size());
    size_t motion = runs == 0 ? 0 : replayed_.runs[runs - 1].last;
    if (i > 0) motion = std::max(motion, given_[i - 1].event->before_motion);
    motion = std::min(motion, replayed_.program.motions.size() - 1);
    findings_.push_back(At(replayed_.program, motion, CauseOf(*wanted.event),
                           fmt::format("{} is missing here", Describe(*wanted.event))));
  }

  static Cause CauseOf(const ProgramEvent& event) {
    return event.kind == Kind::kDwell || event.kind == Kind::kStop || event.kind == Kind::kWait
               ? Cause::kStop
               : Cause::kSwitching;
  }

  const Replayed& replayed_;
  const std::vector<Happening> given_, wanted_;
  const VerifyOptions& options_;
  std::vector<Finding>& findings_;
};

}  // namespace

void CompareEvents(const Replayed& replayed, const Replayed& wanted, bool all, const Cell& cell,
                   const VerifyOptions& options, std::vector<Finding>& findings) {
  const bool spindle = replayed.program.switches_spindle;
  EventComparison(replayed, HappeningsOf(replayed, all, spindle, cell),
                  HappeningsOf(wanted, all, spindle, cell), options, findings)
      .Compare();
}

std::string Describe(const ProgramEvent& event) {
  switch (event.kind) {
    case Kind::kSpindleOn:
      return fmt::format("the spindle switched on at {:.3f} 1/min", event.value * 60);
    case Kind::kSpindleOff:
      return "the spindle switched off";
    case Kind::kPassBegin:
    case Kind::kPassEnd:
      return fmt::format("the mark of the {} of pass {} piece {}",
                         event.kind == Kind::kPassBegin ? "begin" : "end", event.value, event.piece);
    case Kind::kOutput:
      return fmt::format("output {} {}", event.output.number, event.output.on ? "on" : "off");
    case Kind::kHandover:
      return "a handover to another file";
    case Kind::kDwell:
      return fmt::format("a dwell of {} s", event.value);
    case Kind::kText:
      return fmt::format("the cell's text {}", event.text);
    case Kind::kCall:
      return fmt::format("the call of {}", event.text);
    case Kind::kStop:
      return fmt::format("the stop {}", event.text);
    case Kind::kWait:
      return fmt::format("{}", event.text);
    case Kind::kMessage:
      return fmt::format("the message \"{}\"", event.text);
    case Kind::kTool:
      return fmt::format("the change of tool {}", event.text);
  }
  return {};
}

}  // namespace millpose
