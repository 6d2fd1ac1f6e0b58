// SPDX-License-Identifier: GPL-3.0-or-later
// A job file: its sections, each with a table of its own.
#include "job/config/fields.hpp"
#include "job/config/operations.hpp"
#include "job/config/setups.hpp"
#include "planning/pose/expression.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "planning/pose/objective.hpp"
#include "toolpath/strategy.hpp"

namespace millpose::config {
namespace {

// Only a path from a file has points without a surface.
void CheckPart(const Value& value, const Context& context, JobSettings& job) {
  const Value::Key* programs = value.FindKey("programs");
  job.programs_line = programs ? programs->mark.line : 0;
  const Value::Key* workpiece = value.FindKey("workpiece");
  if (workpiece && job.workpiece.mesh_file.empty() && job.toolpath.strategy->NeedsPart())
    context.Child("workpiece")
        .Child("mesh")
        .Add(
            workpiece->mark,
            "missing; only strategy cam, drill with a list of holes and trim along a line go without a part");
  if (workpiece && job.toolpath.strategy->NeedsStock() && !job.workpiece.HasStock())
    context.Child("workpiece")
        .Child("stock")
        .Add(workpiece->mark, fmt::format("missing; required by strategy {}", job.toolpath.strategy->Name()));
}

// Keys of the process that nothing would follow.
void CheckFeeds(const Value& value, const Context& context, const JobSettings& job) {
  const Value* process = value.Find("process");
  const auto useless = [&](const char* key, const std::string& why) {
    if (const Value::Key* found = process->FindKey(key))
      context.Child("process").Child(key).Add(found->mark, "has no effect here: " + why);
  };
  if (job.feed_policy != FeedPolicy::kReduce) useless("min_feed_share", "process.feed: keep reduces no feed");
  if (job.approach_slow >= job.gaps.leave.height)
    useless("approach_feed_mm_min", fmt::format("the last {} mm of the approach run at the plunge feed, and "
                                                "gaps.retract_mm makes it {} mm long",
                                                job.approach_slow, job.gaps.leave.height));
  // A drill goes into the material at the plunge feed and out of it at the retract feed.
  if (job.toolpath.strategy->CutsAtPlungeFeed() && job.plunge_feed && *job.plunge_feed != job.feed)
    useless(
        "feed_mm_min",
        fmt::format("holes are drilled at plunge_feed_mm_min, {:.6g}; given {:.6g}; allowed: the same, or "
                    "feed_mm_min alone",
                    60 * *job.plunge_feed, 60 * job.feed));
}

// Where a force is known it decides, unless the job says what does; the paper's formulation knows eq. 23
// alone.
void ChooseObjective(const Value& value, const Context& context, JobSettings& job) {
  const Value* pose = value.Find("pose");
  const bool given = pose && pose->Find("objective");
  const std::string own = job.toolpath.strategy->DefaultObjective();
  job.objective_open = !given && own.empty() && job.cutting && job.formulation != Formulation::kPaper;
  if (job.objective_open) job.objective = TheObjective(&ObjectiveEntry::with_force).name;
  if (!given && !own.empty() && job.formulation != Formulation::kPaper) job.objective = own;
  const Value* process = value.Find("process");
  for (const std::string& key : kForceBounds) {
    const Value::Key* found = process->FindKey(key);
    if (found && !AsksForceBounds(job))
      context.Child("process").Child(key).Add(
          found->mark, fmt::format("has no effect here: objective {} does not ask for it", job.objective));
  }
}

// Where the job says what the part is milled from, that is what cuts meet.
void ChooseStanding(const Value& value, JobSettings& job) {
  if (job.workpiece.HasStock() && !value.Find("process")->FindKey("stock")) job.stock = Standing::kMesh;
}

// Of a drill's cut the tool, the feed and the hole say all, and it leaves no face.
void CheckDrillCutting(const Value& value, const Context& context, const JobSettings& job) {
  const Value* process = value.Find("process");
  const Value* cutting = process->Find("cutting");
  const auto useless = [&](const Value* of, const Context& at, const char* key, bool given,
                           const std::string& why) {
    if (const Value::Key* found = of->FindKey(key); found && given)
      at.Child(key).Add(found->mark, "has no effect with strategy drill: " + why);
  };
  const CuttingSettings usual, &own = job.cutting.value_or(usual);
  const Context at = context.Child("process");
  for (const auto& [key, given] :
       {std::pair("depth_mm", own.depth.has_value()), std::pair("width_mm", own.width.has_value()),
        std::pair("side", own.side.has_value())})
    useless(cutting, at.Child("cutting"), key, given, "the drill cuts the hole's diameter");
  for (const auto& [key, given] : {std::pair("radial_ratio", own.radial_ratio != usual.radial_ratio),
                                   std::pair("axial_ratio", own.axial_ratio != usual.axial_ratio)})
    useless(cutting, at.Child("cutting"), key, given,
            "its thrust has a law of its own (docs/process-force.md)");
  useless(process, at, "force_factors", job.force_factors != ForceFactors(),
          "a drill has no side of the cut; give kc11_N_mm2");
  if (const Value* pose = value.Find("pose"); pose && ObjectiveNamed(job.objective).with_lost_motion)
    useless(pose, context.Child("pose"), "objective", true, "it leaves no face; allowed: one of a point");
}

// The force of milling a surface is not that of a drill; that of an edge follows from what stands there.
void CheckCutting(const Value& value, const Context& context, const JobSettings& job) {
  const Value::Key* cutting = value.Find("process")->FindKey("cutting");
  const Strategy& strategy = *job.toolpath.strategy;
  if (!cutting || strategy.HasMillingForce()) return;
  if (strategy.DrillPoint()) return CheckDrillCutting(value, context, job);
  const Context at = context.Child("process").Child("cutting");
  if (!strategy.MillsWithSide())
    at.Add(cutting->mark, fmt::format("has no effect here: of the force of strategy {} nothing is known with "
                                      "its options as they stand (docs/drill-and-trim.md)",
                                      strategy.Name()));
  else if (job.stock != Standing::kMesh || (job.cutting && job.cutting->side))
    at.Add(cutting->mark, fmt::format("the force of strategy {} follows from the material that stands; "
                                      "allowed: with workpiece.stock (process.stock: mesh), without a side",
                                      strategy.Name()));
}

// What is known of the force must be followed by something, and what follows it must know it.
void CheckForce(const Value& value, const Context& context, const JobSettings& job) {
  const Value* process = value.Find("process");
  const Value::Key* file = process->FindKey("force_csv");
  const bool compensated = job.compensation.deflection != TakeOut::kOff;
  const auto add_to_deflection = [&](const char* why) {
    const Value::Key* found = value.Find("compensation")->FindKey("deflection");
    context.Child("compensation").Child("deflection").Add(found->mark, why);
  };
  const Strategy& strategy = *job.toolpath.strategy;
  if (compensated && !strategy.HasMillingForce() && !strategy.MillsWithSide())
    add_to_deflection(
        "has no effect with strategy drill: its thrust moves holes along themselves; allowed: off");
  else if (compensated && !job.cutting && job.force_file.empty())
    add_to_deflection("needs the cutting force: process.cutting, or process.force_csv");
  if (file && !compensated)
    context.Child("process")
        .Child("force_csv")
        .Add(file->mark, "has no effect here: only compensation.deflection normal or full follows it");
  if (const Value::Key* factors = process->FindKey("force_factors"); factors && !job.cutting)
    context.Child("process")
        .Child("force_factors")
        .Add(factors->mark, "has no effect here: needs process.cutting");
}

// Without a force from path and stock nothing knows what stands.
void CheckOverMissing(const Value& value, const Context& context, const JobSettings& job) {
  const Value* path = value.Find("path");
  const Value::Key* found = path ? path->FindKey("over_missing") : nullptr;
  if (found && (!job.cutting || job.cutting->side || job.toolpath.strategy->DrillPoint()))
    context.Child("path")
        .Child("over_missing")
        .Add(found->mark,
             "has no effect here: needs process.cutting, without a side, of a cut along a face or an edge");
}

void CheckFreedoms(const Value& value, const Context& context, const JobSettings& job) {
  const auto useless = [&](const char* section, const char* key, const std::string& why) {
    const Value* of = value.Find(section);
    if (const Value::Key* found = of ? of->FindKey(key) : nullptr)
      context.Child(section).Child(key).Add(found->mark, why);
  };
  if (!job.toolpath.Leans())
    useless("path", "max_lean_change_deg_per_mm",
            "has no effect here: needs a range in toolpath." + LeanKeys());
  if (!job.toolpath.freedoms.empty() && job.formulation == Formulation::kPaper)
    useless(
        "pose", "formulation",
        fmt::format("paper knows the rotation about the tool axis alone; leave out the range of toolpath.{}",
                    Freedoms().At(job.toolpath.freedoms.begin()->first).key->info.key));
}

void Check(const Value& value, const Context& context, JobSettings& job) {
  CheckPart(value, context, job);
  ChooseObjective(value, context, job);
  ChooseStanding(value, job);
  CheckCutting(value, context, job);
  CheckFeeds(value, context, job);
  CheckOverMissing(value, context, job);
  CheckFreedoms(value, context, job);
  CheckForce(value, context, job);
}

}  // namespace

const Codec<JobSettings>& JobFields() {
  using S = JobSettings;
  static const std::vector<Field<S>> kOwn = {
      VersionKey<S>("millpose_job", 1),
      Key<S>("name", MILLPOSE_AT(name), FileName(), "Name of the job, and of its files.").Required(),
      Key<S>("cell", MILLPOSE_AT(cell_file), Text(), "Cell file, relative to the job file.").Required(),
      Key<S>("tool", MILLPOSE_AT(tool), Text(), "Which of the cell's `tools`.").WhenSet([](const S& s) {
        return !s.tool.empty();
      }),
      Key<S>("base_in_world", MILLPOSE_AT(base_in_world), Maybe(PoseFields()),
             "Where the robot's base is, in place of the cell's `base_in_world`."),
      Key<S>("operation", MILLPOSE_AT(operation), Text(),
             "Of a job that millpose wrote: which operation of a job with several it is.")
          .WhenSet([](const S& s) { return !s.operation.empty(); }),
      Key<S>("operation_of", MILLPOSE_AT(operation_of), Text(), "Likewise: the name of that job.")
          .WhenSet([](const S& s) { return !s.operation_of.empty(); }),
      Key<S>(
          "tool_held", MILLPOSE_AT(tool_held), Flag(),
          "Likewise: the operation before has the same tool, which programs then compare and do not change.")
          .WhenSet([](const S& s) { return s.tool_held; }),
      Key<S>("seed", MILLPOSE_AT(seed), Seed(), "Seed of all random numbers."),
      Key<S>("workpiece", MILLPOSE_AT(workpiece), WorkpieceFields(), "The part and its place.").Required(),
      Key<S>("toolpath", MILLPOSE_AT(toolpath), ToolpathFields(), "Where the tool goes.")
          .RequiredUnless("operations"),
      Key<S>("process", kSelf, ProcessFields(), "Feed and speed.").RequiredUnless("operations"),
      Key<S>("pose", kSelf, PoseSearchFields(), "How the pose at each point is chosen."),
      Key<S>("limits", kSelf, LimitFields(), "What makes a pose admissible."),
      Key<S>("path", kSelf, PathFields(), "How poses are joined along a pass."),
      Key<S>("interference", kSelf, InterferenceFields(), "How interference is checked."),
      Key<S>("gaps", kSelf, LinkMoveFields(), "How the tool moves from one pass to the next."),
      Key<S>("programs", MILLPOSE_AT(programs), ListOf(Choice(Posts().Names())),
             "Controllers to write programs for."),
      Key<S>("program_options", MILLPOSE_AT(program_options), ProgramOptionFields(),
             "What becomes of the planned points in programs."),
      Key<S>("compensation", MILLPOSE_AT(compensation), CompensationFields(),
             "What of the tool's expected error the programs take out (docs/compensation.md).")
          .WhenSet([](const S& s) { return s.compensation.IsOn(); }),
      Key<S>("external", MILLPOSE_AT(external), ListOf(ExternalFields()),
             "Where the cell's external axes stand (docs/external-axes.md); those without an entry stand at "
             "home.")
          .WhenSet([](const S& s) { return !s.external.empty(); }),
      Key<S>("placement", MILLPOSE_AT(placement), Maybe(PlacementFields()),
             "Where `millpose place` may put the part (docs/placement.md); `plan` does not look at it."),
  };
  static const Codec<S> fields = [] {
    std::vector<Field<S>> all = kOwn;
    all.push_back(SetupsField(kOwn));
    all.push_back(OperationsField(kOwn));
    Codec<S> job = Section<S>(std::move(all), Check);
    job.schema = [whole = job.schema] {
      Value schema = whole();
      LeaveToOperations(schema);
      return schema;
    };
    return job;
  }();
  return fields;
}

}  // namespace millpose::config
