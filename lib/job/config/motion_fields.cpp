// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `path:`, `interference:` and `gaps:`, one line each.
#include "job/config/fields.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "toolpath/strategy.hpp"

namespace millpose::config {

namespace {

void CheckLifts(const Value& value, const Context& context, JobSettings& job) {
  const Value::Key* most = value.FindKey("max_lifts");
  if (most && job.path.lift_gain == 0)
    context.Child("max_lifts")
        .Add(most->mark, "has no effect here: lift_gain_percent is 0, so that no lift pays");
}

}  // namespace

Codec<JobSettings> PathFields() {
  using S = JobSettings;
  return Section<S>(
      {
          Key<S>("rotation_step_deg", MILLPOSE_AT(path.rotation_step), Real(kDeg, Between(0.01, 45)),
                 "Grid of rotations about the tool axis in the ladder search."),
          Key<S>(
              "max_joint_deg_per_mm", MILLPOSE_AT(path.steps.per_mm), Real(kDeg, Between(0.001, 1000)),
              "Largest change of each axis between neighbouring points, for each mm of way between them: of "
              "the tip, or of a point 300 mm up the tool where it turns on the spot."),
          Key<S>(
              "joint_speed_share", MILLPOSE_AT(path.steps.speed_share), Real(kOne, Between(0.001, 1)),
              "Largest speed of each axis between neighbouring points at the programmed feed, as a share of "
              "its own."),
          Key<S>("max_joint_step_deg", MILLPOSE_AT(path.steps.most), Numbers6(kDeg, Positive(360)),
                 "Largest change of each axis between neighbouring points however far they lie apart.")
              .WhenSet([](const S& s) { return s.path.steps.most.allFinite(); })
              .DefaultText("none"),
          Key<S>(
              "max_lean_change_deg_per_mm", MILLPOSE_AT(path.max_lean_change),
              Real(kDeg, Between(0.001, 1000)),
              fmt::format("Where toolpath.{} is a range: largest change of each between neighbouring points, "
                          "for each mm of way between them.",
                          LeanKeys()))
              .WhenSet([](const S& s) { return s.toolpath.Leans(); })
              .DefaultText("0.5"),
          Key<S>(
              "motion_share", MILLPOSE_AT(path.motion_share), Real(kOne, UpTo(1e6)),
              "Cost of joint motion relative to the objective: of one rad², as a share of the median optimum "
              "of the "
              "pass's points."),
          Key<S>("criterion", MILLPOSE_AT(worst_first),
                 Maybe(ChoiceOf<bool>({{"worst_then_sum", true}, {"sum", false}})),
                 "What makes a pass good: its worst point first, then the sum over it, or the sum alone; by "
                 "default "
                 "worst_then_sum for objectives surface_error and face_error, else sum."),
          Key<S>("smoothing_loss_percent", MILLPOSE_AT(path.smoothing_loss), Real(kPercent, Between(0, 100)),
                 "Share of a piece's objective that may be given up for smoother joints; 0: none."),
          Key<S>("split_overlap_mm", MILLPOSE_AT(path.overlap), Real(kMm, UpTo(1e4)),
                 "Way that is cut again where a pass has to be split; at least up to the next point."),
          Key<S>("lift_gain_percent", MILLPOSE_AT(path.lift_gain), Real(kPercent, Between(0, 100)),
                 "Share of a pass's objective that lifting the tool and entering again must gain, each time; "
                 "0: the "
                 "tool is lifted only where a pass cannot be planned in one piece."),
          Key<S>("max_lifts", MILLPOSE_AT(path.max_lifts), Integer(1, 3),
                 "Most lifts of a pass for `lift_gain_percent`.")
              .WhenSet([](const S& s) { return s.path.lift_gain > 0; })
              .DefaultText("1"),
          Key<S>(
              "max_halfway_deviation_mm", MILLPOSE_AT(path.max_deviation), Real(kMm, Between(0.001, 1000)),
              "Half-way between points, with the joints turning evenly, the tip's largest distance from its "
              "straight line; where the points lie too far apart for that, a quarter more than with the "
              "rotation unchanged."),
          Key<S>(
              "over_missing", MILLPOSE_AT(over_missing),
              ChoiceOf<OverMissing>({{"leave_out", OverMissing::kLeaveOut}, {"cut", OverMissing::kCut}}),
              "Passes that would cut more than 20 % wider or deeper than the job's own because points before "
              "them are skipped: leave_out: they are left out too, with all that lies over them; cut: they "
              "are cut. Needs process.cutting without a side.")
              .WhenSet([](const S& s) {
                return s.cutting && !s.cutting->side && !s.toolpath.strategy->DrillPoint();
              })
              .DefaultText("leave_out"),
      },
      CheckLifts);
}

Codec<JobSettings> InterferenceFields() {
  using S = JobSettings;
  return Section<S>(
      {Key<S>("swept_resolution_mm", MILLPOSE_AT(swept_resolution), Real(kMm, Between(0.001, 100)),
              "What a motion between two points may miss of a clearance.")});
}

Codec<JobSettings> LinkMoveFields() {
  using S = JobSettings;
  return Section<S>({
      Key<S>("retract_mm", MILLPOSE_AT(gaps.leave.height), Real(kMm, Positive(1e4)),
             "Distance along the tool axis by which the tool leaves and approaches the part."),
      Key<S>("limit_margin_deg", MILLPOSE_AT(gaps.leave.limit_margin), Real(kDeg, Between(0, 90)),
             "Distance kept from the arm's own limits between cuts, on every axis."),
      Key<S>("max_iterations", MILLPOSE_AT(gaps.max_iterations), Integer(1, 100000000),
             "Most iterations of the planner for one gap."),
      Key<S>("speed_share", MILLPOSE_AT(gaps.speed_share), Real(kOne, Between(0.01, 1)),
             "Share of the axes' largest speeds and accelerations used in gaps."),
  });
}

}  // namespace millpose::config
