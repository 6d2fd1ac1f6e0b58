// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `workpiece:`, one line each.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

Codec<TargetSettings> TargetFields() {
  using S = TargetSettings;
  return Section<S>(
      {Key<S>("nominal_mm", MILLPOSE_AT(nominal), Coordinates(), "In the workpiece frame.").Required(),
       Key<S>("measured_mm", MILLPOSE_AT(measured), Coordinates(), "In `frame`.").Required()});
}

void CheckPlacement(const Value& value, const Context& context, WorkpieceSettings& workpiece) {
  const bool pose = value.FindKey("pose") != nullptr, targets = value.FindKey("targets") != nullptr;
  if (pose == targets) context.Add(value.mark, "give either pose or targets");
  if (targets && workpiece.targets.size() < 3)
    context.Add(value.mark,
                fmt::format("a best fit needs 3 targets or more, given {}", workpiece.targets.size()));
}

Codec<WorkpieceSettings> StockFields() {
  using S = WorkpieceSettings;
  return Section<S>({
      Key<S>("mesh", MILLPOSE_AT(stock_file), Text(), "Mesh or STEP file, relative to the job file.")
          .Required(),
      Key<S>("unit", MILLPOSE_AT(stock_unit), LengthUnit(),
             "Unit of the mesh file; of a STEP file the one that it states.")
          .Required(),
  });
}

}  // namespace

Codec<WorkpieceSettings> WorkpieceFields() {
  using S = WorkpieceSettings;
  return Section<S>(
      {
          Key<S>("mesh", MILLPOSE_AT(mesh_file), Text(),
                 "Mesh or STEP file, relative to the job file; strategy cam, a list of holes and a trimmed "
                 "line go without.")
              .WhenSet([](const S& w) { return !w.mesh_file.empty(); }),
          Key<S>("unit", MILLPOSE_AT(unit), LengthUnit(),
                 "Unit of the mesh file; of a STEP file the one that it states.")
              .Required(),
          Key<S>(
              "frame", MILLPOSE_AT(frame),
              ChoiceOf<GivenFrame>({{"world", GivenFrame::kWorld}, {"robot_base", GivenFrame::kRobotBase}}),
              "Frame that the pose or the measured points are given in."),
          Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Place of the workpiece; this or targets.")
              .WhenSet([](const S& s) { return s.targets.empty(); }),
          Key<S>("targets", MILLPOSE_AT(targets), ListOf(TargetFields()),
                 "Points of the part with where they were measured; the workpiece is placed where they fit "
                 "best.")
              .WhenSet([](const S& s) { return !s.targets.empty(); }),
          Key<S>("max_residual_mm", MILLPOSE_AT(max_residual), Real(kMm, Positive(1000)),
                 "Largest distance of a measured target from where the fit puts it."),
          Key<S>("weld_tolerance_mm", MILLPOSE_AT(weld_tolerance), Real(kMm, UpTo(100)),
                 "Vertices of the mesh nearer than this become one."),
          Key<S>("flip", MILLPOSE_AT(flip), Flag(),
                 "Turn open sheets the other way round: their outside cannot be known."),
          Key<S>("chord_tolerance_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Between(1e-4, 100)),
                 "Of a STEP part: largest distance between its faces and their triangles."),
          Key<S>("step", kSelf,
                 Section<S>({
                     Key<S>("seconds", MILLPOSE_AT(step_seconds), Integer(1, 86400),
                            "Processor time and time on the clock."),
                     Key<S>("memory_MB", MILLPOSE_AT(step_memory), Integer(256, 1000000),
                            "Address space of the reading process."),
                 }),
                 "What the reading of a STEP file may take."),
          Key<S>("allowance_mm", MILLPOSE_AT(allowance), Maybe(Real(kMm, UpTo(1000))),
                 "Material on the part's surface, added to every clearance from it.")
              .DefaultText("toolpath.depth.total_mm"),
          Key<S>("stock", kSelf, StockFields(),
                 "The raw part, kept clear of between the cuts; in the workpiece's frame.")
              .WhenSet([](const S& s) { return !s.stock_file.empty(); }),
      },
      CheckPlacement);
}

}  // namespace millpose::config
