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

constexpr size_t kTriangle = 21;  // of a symmetric matrix of six rows

/// Symmetric, and no correlation above 1: what rounding may have cost is let pass.
void CheckCovariance(const Value& value, const Context& context, RegisteredSettings& s) {
  constexpr double kRounded = 1e-4;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) {
      const double both = s.covariance(i, i) * s.covariance(j, j);
      if (s.covariance(i, i) < 0 || s.covariance(i, j) * s.covariance(i, j) > (1 + kRounded) * both)
        return context.Child("covariance_mm_mrad")
            .Add(value.FindKey("covariance_mm_mrad")->mark,
                 fmt::format("is no covariance: row {}, column {}; allowed: what `millpose register` wrote",
                             i + 1, j + 1));
    }
}

/// The lower triangle row by row; turns in mrad.
Codec<Eigen::Matrix<double, 6, 6>> CovarianceFields() {
  const Range range = Between(-1e9, 1e9);
  const std::array<Codec<double>, 3> by_turns = {Real({"mm²", 1, 1}, range), Real({"mm·mrad", 1, 1e3}, range),
                                                 Real({"mrad²", 1, 1e6}, range)};
  const auto codec_at = [by_turns](int i, int j) { return by_turns[(i >= 3 ? 1 : 0) + (j >= 3 ? 1 : 0)]; };
  Codec<Eigen::Matrix<double, 6, 6>> codec;
  codec.type = fmt::format("list of {} numbers", kTriangle);
  codec.schema = codec_detail::ListSchema(by_turns[0].schema, kTriangle);
  codec.read = [codec_at](const Value& value, const Context& context, Eigen::Matrix<double, 6, 6>& result) {
    if (value.kind != Value::Kind::kList || value.items.size() != kTriangle)
      return context.AddWrong(value, fmt::format("a list of {} numbers", kTriangle));
    size_t next = 0;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j <= i; ++j, ++next) {
        codec_at(i, j).read(value.items[next], context.Child(next), result(i, j));
        result(j, i) = result(i, j);
      }
  };
  codec.write = [codec_at](const Eigen::Matrix<double, 6, 6>& matrix) {
    Value list = Value::List();
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j <= i; ++j) list.items.push_back(codec_at(i, j).write(matrix(i, j)));
    return list;
  };
  return codec;
}

Codec<RegisteredSettings> RegisteredFields() {
  using S = RegisteredSettings;
  return Section<S>(
      {Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "The pose that was found: workpiece.pose.").Required(),
       Key<S>("centre_mm", MILLPOSE_AT(centre), Coordinates(),
              "Point of the part, workpiece's frame, about which turns count.")
           .Required(),
       Key<S>("covariance_mm_mrad", MILLPOSE_AT(covariance), CovarianceFields(),
              "Covariance of the part's shift along x, y, z (mm) and turn about x, y, z (mrad), workpiece's "
              "frame: the lower triangle, row by row.")
           .Required()},
      CheckCovariance);
}

// A pose changed by hand is not the one that was measured.
void CheckRegistered(const Value& value, const Context& context, const WorkpieceSettings& workpiece) {
  if (!workpiece.registered) return;
  const PoseSettings& found = workpiece.registered->pose;
  if (found.position == workpiece.pose.position && found.abc == workpiece.pose.abc) return;
  context.Child("registered")
      .Add(value.FindKey("registered")->mark,
           "is of another pose than workpiece.pose; allowed: the pose that `millpose "
           "register` wrote with it, or no workpiece.registered");
}

void CheckPlacement(const Value& value, const Context& context, WorkpieceSettings& workpiece) {
  const bool pose = value.FindKey("pose") != nullptr, targets = value.FindKey("targets") != nullptr;
  if (pose == targets) context.Add(value.mark, "give either pose or targets");
  if (targets && workpiece.targets.size() < 3)
    context.Add(value.mark,
                fmt::format("a best fit needs 3 targets or more, given {}", workpiece.targets.size()));
  for (const char* key : {"registration", "registered"})
    if (const Value::Key* found = value.FindKey(key); found && targets)
      context.Child(key).Add(found->mark, "has no effect here: the part is placed by its targets");
  CheckRegistered(value, context, workpiece);
}

Codec<StockBox> StockBoxFields() {
  using S = StockBox;
  return Section<S>(
      {Key<S>("lower_mm", MILLPOSE_AT(lower), Coordinates(), "Its corner with the least x, y, z.").Required(),
       Key<S>("upper_mm", MILLPOSE_AT(upper), Coordinates(), "The opposite corner.").Required()},
      [](const Value& value, const Context& context, const S& box) {
        if ((box.upper - box.lower).minCoeff() <= 0)
          context.Add(value.mark, "is empty; allowed: upper_mm above lower_mm along x, y and z");
      });
}

Codec<StockCylinder> StockCylinderFields() {
  using S = StockCylinder;
  return Section<S>(
      {Key<S>("centre_mm", MILLPOSE_AT(centre), Coordinates(), "Centre of its first end.").Required(),
       Key<S>("axis", MILLPOSE_AT(axis), Direction(), "From there to the other end."),
       Key<S>("radius_mm", MILLPOSE_AT(radius), Real(kMm, Positive(1e5)), "Of the cylinder.").Required(),
       Key<S>("length_mm", MILLPOSE_AT(length), Real(kMm, Positive(1e5)), "Along the axis.").Required()});
}

void CheckStock(const Value& value, const Context& context, const WorkpieceSettings& workpiece) {
  const bool mesh = value.FindKey("mesh") != nullptr;
  const int given = (mesh ? 1 : 0) + (workpiece.stock_box ? 1 : 0) + (workpiece.stock_cylinder ? 1 : 0);
  if (given != 1) context.Add(value.mark, "give one of mesh, box and cylinder");
  const Value::Key* unit = value.FindKey("unit");
  if (mesh && !unit) context.Add(value.mark, "unit: missing; required with mesh");
  if (!mesh && unit) context.Child("unit").Add(unit->mark, "has no effect without mesh");
}

Codec<WorkpieceSettings> StockFields() {
  using S = WorkpieceSettings;
  const auto by_file = [](const S& s) { return !s.stock_file.empty(); };
  return Section<S>(
      {
          Key<S>("mesh", MILLPOSE_AT(stock_file), Text(),
                 "Mesh or STEP file, relative to the job file; or box or cylinder.")
              .WhenSet(by_file),
          Key<S>("unit", MILLPOSE_AT(stock_unit), LengthUnit(),
                 "Unit of the mesh file; of a STEP file the one that it states.")
              .WhenSet(by_file),
          Key<S>("box", MILLPOSE_AT(stock_box), Maybe(StockBoxFields()), "A box along the workpiece's axes."),
          Key<S>("cylinder", MILLPOSE_AT(stock_cylinder), Maybe(StockCylinderFields()), "A round bar."),
          Key<S>("resolution_mm", MILLPOSE_AT(stock_resolution), Real(kMm, Between(0.05, 10)),
                 "Between the lines on which it is known where material stands (docs/stock.md)."),
      },
      CheckStock);
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
          Key<S>("registration", kSelf,
                 Section<S>({Key<S>("tolerance_mm", MILLPOSE_AT(registration_tolerance),
                                    Maybe(Real(kMm, Positive(1000))),
                                    "By how much the milled face may be off along its normal, since nobody "
                                    "knows the part's place better (95 %); `millpose register` refuses more.")
                                 .Required()}),
                 "What the part's place must be known to.")
              .WhenSet([](const S& s) { return s.registration_tolerance.has_value(); }),
          Key<S>("registered", MILLPOSE_AT(registered), Maybe(RegisteredFields()),
                 "How sure the pose is: written by `millpose register`."),
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
              .DefaultText("toolpath.depth.total_mm, with workpiece.stock 0"),
          Key<S>("stock", kSelf, StockFields(),
                 "The raw part, in the workpiece's frame: kept clear of between the cuts, and milled away "
                 "cut by cut.")
              .WhenSet([](const S& s) { return s.HasStock(); }),
      },
      CheckPlacement);
}

}  // namespace millpose::config
