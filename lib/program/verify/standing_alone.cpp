// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/standing_alone.hpp"

#include "machine/robot/kinematics.hpp"
#include "program/stated_speeds.hpp"
#include "program/verify/compare_events.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

using Kind = ProgramEvent::Kind;

constexpr double kAlongAxis = 0.99;    // cosine: approaches come down along the tool, retracts go up
constexpr double kLengthSlack = 1e-2;  // mm

bool IsDryRun(const MotionProgram& program) {
  return std::ranges::any_of(program.header, [](const auto& line) { return line.first == "dry_run"; });
}

class StandingAlone {
 public:
  StandingAlone(const Replayed& replayed, const Cell& cell, const VerifyOptions& options,
                std::vector<Finding>& findings)
      : replayed_(replayed),
        program_(replayed.program),
        cell_(cell),
        options_(options),
        findings_(findings) {}

  void CheckSpindle() {
    if (!program_.switches_spindle) return;
    const std::optional<double> stated = StatedSpindle(program_);
    bool on = false;
    size_t next = 0;
    for (const FeedRun& run : replayed_.runs) {
      for (; next < program_.events.size() && program_.events[next].before_motion <= run.first; ++next)
        Switch(program_.events[next], stated, on);
      if (!on && !IsDryRun(program_)) Say(run.first, Cause::kSwitching, "the spindle stands still in a cut");
    }
    for (; next < program_.events.size(); ++next) Switch(program_.events[next], stated, on);
    if (on) Say(program_.motions.size() - 1, Cause::kSwitching, "the spindle turns at the end");
  }

  void CheckCalls() {
    for (const ProgramEvent& event : program_.events)
      if (event.kind == Kind::kCall && !event.of.empty())
        Say(event, Cause::kSwitching,
            fmt::format("{} stands outside the cell's text {}", Describe(event), event.of));
  }

  void CheckEnds() {
    const std::vector<Motion>& motions = program_.motions;
    if (HasFeed(motions.back())) Say(motions.size() - 1, Cause::kWay, "the last motion is one of a cut");
    for (size_t i = 0; i + 1 < motions.size(); ++i)
      if (!motions[i].exact && HasFeed(motions[i]) != HasFeed(motions[i + 1]))
        Say(i, Cause::kStop, "no stop between a way and a cut");
  }

  /// A pass that begins ends before the next one.
  void CheckMarks() {
    const ProgramEvent* begun = nullptr;
    for (const ProgramEvent& event : program_.events) {
      if (event.kind != Kind::kPassBegin && event.kind != Kind::kPassEnd) continue;
      const bool begins = event.kind == Kind::kPassBegin;
      const bool fits = begins ? !begun : begun && begun->value == event.value && begun->piece == event.piece;
      if (!fits)
        Say(event, Cause::kOther,
            begins ? fmt::format("{} is before {} has ended", Describe(event), PassOf(*begun))
                   : fmt::format("{} is where it has not begun", Describe(event)));
      begun = begins ? &event : nullptr;
    }
    if (begun)
      Say(program_.motions.size() - 1, Cause::kOther, fmt::format("{} does not end", PassOf(*begun)));
  }

  void CheckFeeds() {
    const std::optional<StatedFeeds> stated = StatedFeedsOf(program_);
    if (!stated) return;
    for (const FeedRun& run : replayed_.runs) {
      std::vector<FedMotion> motions;
      for (size_t i = run.first; i <= run.last; ++i) motions.push_back(FedAt(i));
      const auto [first, last] = ApproachAndRetract(motions);
      double length = 0;
      for (size_t k = 0; k < motions.size(); ++k) {
        if (k == first || k + last == motions.size()) length = 0;
        length += motions[k].length;
        const bool in = k < first, out = k + last >= motions.size();
        double most = in ? stated->approach : out ? stated->retract : stated->cut;
        const bool beside = (in || out) && length <= stated->length + kLengthSlack &&
                            Along(run.first + k) * (in ? -1 : 1) >= kAlongAxis;
        if (!beside) most = stated->cut;
        if (motions[k].feed <= most * options_.feed_most) continue;
        Say(run.first + k, Cause::kFeed,
            fmt::format("runs at {:.3f} mm/min; the header states {:.3f} mm/min at most {}",
                        motions[k].feed * 60, most * 60,
                        !beside ? "in cuts"
                        : in    ? "in approaches"
                                : "in retracts"));
      }
    }
  }

 private:
  static std::string PassOf(const ProgramEvent& mark) {
    return fmt::format("pass {} piece {}", mark.value, mark.piece);
  }

  void Switch(const ProgramEvent& event, const std::optional<double>& stated, bool& on) {
    if (event.kind == Kind::kSpindleOff) on = false;
    if (event.kind != Kind::kSpindleOn) return;
    on = event.value > 0;
    if (stated && std::abs(event.value - *stated) > options_.spindle_tolerance)
      Say(event, Cause::kSwitching,
          fmt::format("{}; the header states {:.3f} 1/min", Describe(event), *stated * 60));
  }

  Pose Tool(size_t i) const {
    return BaseInPart(cell_, program_.motions[i].external) *
           ForwardFlange(cell_.arm, replayed_.replay.targets[i]) * cell_.X_FT;
  }

  FedMotion FedAt(size_t i) const {
    const Motion& motion = program_.motions[i];
    const double length = (Tool(i).translation() - Tool(i - 1).translation()).norm();
    return {motion.duration > 0 ? length / motion.duration : motion.feed, length, motion.exact};
  }

  /// Cosine between the way of motion `i` and the tool's axis, away from the part.
  double Along(size_t i) const {
    const Pose to = Tool(i);
    const Eigen::Vector3d way = to.translation() - Tool(i - 1).translation();
    return way.norm() > 0 ? to.linear().col(2).dot(way.normalized()) : 0;
  }

  void Say(size_t motion, Cause cause, const std::string& message) {
    findings_.push_back(At(program_, motion, cause, message));
  }
  void Say(const ProgramEvent& event, Cause cause, const std::string& message) {
    Finding finding =
        At(program_, std::min(event.before_motion, program_.motions.size() - 1), cause, message);
    finding.line = event.line;
    if (static_cast<size_t>(event.file) < program_.files.size())
      finding.file = program_.files[static_cast<size_t>(event.file)];
    findings_.push_back(finding);
  }

  const Replayed& replayed_;
  const MotionProgram& program_;
  const Cell& cell_;
  const VerifyOptions& options_;
  std::vector<Finding>& findings_;
};

}  // namespace

std::vector<Finding> CheckStandingAlone(const MotionProgram& program, const Cell& cell, bool own_world,
                                        const VerifyOptions& options) {
  std::vector<Finding> findings;
  if (program.motions.empty()) return findings;  // told by Verify()
  std::vector<Finding> said;                     // likewise
  const Replayed replayed{program, ReplayTargets(program, cell, said), FeedRuns(program)};
  StandingAlone check(replayed, cell, options, findings);
  check.CheckSpindle();
  check.CheckCalls();
  check.CheckEnds();
  check.CheckMarks();
  check.CheckFeeds();
  if (own_world && !program.frames_checked)
    findings.push_back(At(program, 0, Cause::kOther,
                          "nothing stops the program before its first motion where the controller's frame is "
                          "another: the check of $ROBROOT is missing"));
  return findings;
}

std::string ScopeOf(const MotionProgram& program) {
  std::string scope = "reach, limits, speeds, singularity, interference";
  std::vector<std::string> lacks;
  if (!program.switches_spindle)
    lacks.emplace_back("the cell has no text that switches the spindle");
  else
    scope += ", spindle";
  if (IsDryRun(program)) lacks.emplace_back("a dry run: the spindle may stand still");
  if (!StatedSpindle(program)) lacks.emplace_back("the header states no spindle speed");
  if (!StatedFeedsOf(program)) lacks.emplace_back("the header states no feeds");
  scope += "; not the plan";
  for (const std::string& lack : lacks) scope += "; " + lack;
  return scope;
}

}  // namespace millpose
