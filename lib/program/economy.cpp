// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/economy.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"

namespace millpose {
namespace {

constexpr size_t kLongest = 512;  // points that one motion may stand for: bounds the work
// Of the tolerances: the rest is for rounding in the text and for places between the points.
constexpr double kUsed = 0.95;

/// Which points may be left out: of a cut, blended, between two others at one feed, without an event.
std::vector<bool> MayGo(const MotionProgram& program) {
  const std::vector<Motion>& motions = program.motions;
  std::vector<bool> may(motions.size(), false);
  for (size_t i = 1; i + 1 < motions.size(); ++i) {
    may[i] = motions[i].type == MotionType::kLinear && !motions[i].exact && motions[i].point >= 0 &&
             motions[i + 1].type == MotionType::kLinear && motions[i + 1].feed == motions[i].feed &&
             motions[i + 1].point >= 0;
  }
  for (const ProgramEvent& event : program.events) {
    if (event.before_motion > 0) may[event.before_motion - 1] = false;
  }
  return may;
}

/// Whether the external axes, which run evenly from where motion `first` − 1 ends to where motion `last`
/// does, are within tolerance of where motion `i` has them at `share` of that way.
bool KeepsExternal(const MotionProgram& program, size_t first, size_t last, size_t i, double share,
                   const EconomyOptions& options) {
  for (size_t k = 0; k < program.external_axes.size(); ++k) {
    const double from = program.motions[first - 1].external[k], to = program.motions[last].external[k];
    const bool linear = program.external_axes[k].kind == AxisKind::kLinear;
    const double off = std::abs(from + share * (to - from) - program.motions[i].external[k]);
    if (off > kUsed * (linear ? options.position_tolerance : options.angle_tolerance)) return false;
  }
  return true;
}

/// Whether the controller's straight motion `line` from pose `a` to pose `b` passes the targets first..last−1
/// within tolerance, in order.
bool Passes(const ProgrammedLine& line, const Pose& a, const Pose& b, const MotionProgram& program,
            size_t first, size_t last, const EconomyOptions& options) {
  const std::vector<Motion>& motions = program.motions;
  const Eigen::Vector3d along = b.translation() - a.translation();
  double before = 0;
  const auto near = [&](double share, const Eigen::Matrix3d& R) {
    return AngleBetween(line.At(share).linear(), R) <= kUsed * options.angle_tolerance;
  };
  for (size_t i = first; i < last; ++i) {
    const Eigen::Vector3d offset = motions[i].X_PT.translation() - a.translation();
    const double share = line.length() > 0 ? offset.dot(along) / along.squaredNorm() : -1;
    if (share < before || share > 1) return false;
    const double off = (offset - share * along).norm();
    if (off > kUsed * options.position_tolerance || !near(share, motions[i].X_PT.linear())) return false;
    if (!KeepsExternal(program, first, last, i, share, options)) return false;
    // Another course of the orientation than the planned one leaves it between the points too.
    if (!options.lines.empty() &&
        !near((before + share) / 2, PoseLine(motions[i - 1].X_PT, motions[i].X_PT).At(0.5).linear()))
      return false;
    before = share;
  }
  return options.lines.empty() ||
         near((before + 1) / 2, PoseLine(motions[last - 1].X_PT, motions[last].X_PT).At(0.5).linear());
}

/// Which motions of a program remain.
class Thinning {
 public:
  Thinning(const MotionProgram& program, const EconomyOptions& options)
      : program_(program), motions_(program.motions), options_(options), may_go_(MayGo(program)) {}

  std::vector<size_t> Kept() {
    for (size_t i = 0; i < motions_.size();) {
      const size_t end = i > 0 && options_.position_tolerance > 0 ? Farthest(i) : i;
      kept_.push_back(end);
      if (!may_go_[end]) SpreadLast();
      i = end + 1;
    }
    return std::move(kept_);
  }

  double Length(size_t from, size_t to) const {
    return (motions_[to].X_PT.translation() - motions_[from].X_PT.translation()).norm();
  }

 private:
  /// Whether one motion from the end of `from` to that of `to` passes everything between.
  bool Stands(size_t from, size_t to) const {
    const Pose &a = motions_[from].X_PT, &b = motions_[to].X_PT;
    if (to == from + 1) return true;  // nothing is left out
    if (options_.lines.empty()) return Passes({a, b}, a, b, program_, from + 1, to, options_);
    return std::ranges::all_of(options_.lines, [&](const LineModel& line) {
      return Passes(line(a, b), a, b, program_, from + 1, to, options_);
    });
  }

  /// The farthest motion found that can stand for those from `i` on: steps of twice the length each, then
  /// halved.
  size_t Farthest(size_t i) const {
    size_t limit = i;
    while (may_go_[limit] && limit - i < kLongest) ++limit;
    size_t good = i, step = 1;
    while (good < limit && Stands(i - 1, std::min(good + step, limit))) {
      good = std::min(good + step, limit);
      step *= 2;
    }
    for (; step > 0; step /= 2) {
      if (good + step <= limit && Stands(i - 1, good + step)) good += step;
    }
    return good;
  }

  /// Moves the last point but one back where the last stretch is shorter than the spacing.
  void SpreadLast() {
    if (kept_.size() < 3) return;
    const size_t before = kept_[kept_.size() - 3], last = kept_.back();
    size_t& moved = kept_[kept_.size() - 2];
    if (!may_go_[moved] || Length(moved, last) >= options_.spacing) return;
    for (size_t k = moved; k-- > before + 1;) {
      if (Length(k, last) < options_.spacing) continue;
      if (Length(before, k) >= options_.spacing && Stands(before, k) && Stands(k, last)) moved = k;
      return;
    }
  }

  const MotionProgram& program_;
  const std::vector<Motion>& motions_;
  const EconomyOptions& options_;
  std::vector<bool> may_go_;
  std::vector<size_t> kept_;
};

/// What motion comes before `motion` now.
void BeginWhere(const Motion& before, Motion& motion) {
  motion.X_BP_begin.reset();
  if (HasFeed(motion) && motion.external != before.external) motion.X_BP_begin = before.X_BP;
}

}  // namespace

EconomyResult Economise(const MotionProgram& program, const EconomyOptions& options) {
  Thinning thinning(program, options);
  EconomyResult result;
  result.origin = thinning.Kept();
  result.saved = static_cast<int>(program.motions.size() - result.origin.size());
  result.program = program;
  result.program.motions.clear();
  std::vector<size_t> place(program.motions.size() + 1, result.origin.size());  // new index of each motion
  for (size_t k = 0; k < result.origin.size(); ++k) {
    const size_t from = k == 0 ? 0 : result.origin[k - 1] + 1, i = result.origin[k];
    for (size_t old = from; old <= i; ++old) place[old] = k;
    const Motion& motion = program.motions[i];
    result.program.motions.push_back(motion);
    if (k > 0) BeginWhere(program.motions[result.origin[k - 1]], result.program.motions.back());
    const bool cut = k > 0 && motion.point >= 0 && program.motions[result.origin[k - 1]].point >= 0;
    if (cut && thinning.Length(result.origin[k - 1], i) < options.spacing) ++result.near;
  }
  for (ProgramEvent& event : result.program.events) event.before_motion = place[event.before_motion];
  return result;
}

std::vector<size_t> AddHandovers(MotionProgram& program, int most) {
  std::vector<size_t> places;
  size_t begin = 0;  // of the motions since the last place where a file may end
  std::vector<size_t> ends;
  for (const ProgramEvent& event : program.events) {
    if (event.kind == ProgramEvent::Kind::kPassEnd) ends.push_back(event.before_motion);
  }
  ends.push_back(program.motions.size());
  for (const size_t end : ends) {
    // Equal parts, so that no short rest remains.
    const size_t parts = (end - begin + static_cast<size_t>(most) - 1) / static_cast<size_t>(most);
    for (size_t part = 1; part < parts; ++part) {
      size_t place = begin + part * (end - begin) / parts;
      while (place < end && (program.motions[place].point < 0 || program.motions[place - 1].point < 0))
        ++place;
      if (place == end) continue;
      program.motions[place - 1].exact = true;
      places.push_back(place);
    }
    begin = end;
  }
  for (const size_t place : places) {
    const auto after = std::find_if(program.events.begin(), program.events.end(),
                                    [&](const ProgramEvent& event) { return event.before_motion > place; });
    program.events.insert(after, {ProgramEvent::Kind::kHandover, place, 0, 0, {}, 0, 0});
  }
  return places;
}

std::vector<size_t> StateEntriesByJoints(MotionProgram& program, const AxisConvention& axes, double least) {
  std::vector<size_t> changed;
  for (size_t i = 0; i < program.motions.size(); ++i) {
    Motion& motion = program.motions[i];
    if (!motion.q || !motion.turn) continue;
    const Joints angles = axes.FromArm(*motion.q);
    if (std::ranges::none_of(angles, [&](double a) { return std::abs(std::remainder(a, 2 * kPi)) < least; }))
      continue;
    motion.status.reset();
    motion.turn.reset();
    changed.push_back(i);
  }
  return changed;
}

}  // namespace millpose
