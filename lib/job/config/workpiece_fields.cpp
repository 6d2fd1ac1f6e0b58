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
  const ProbeMatrix whole = s.WholeCovariance();
  for (int i = 0; i < whole.rows(); ++i)
    for (int j = 0; j <= i; ++j) {
      const double both = whole(i, i) * whole(j, j);
      if (whole(i, i) >= 0 && whole(i, j) * whole(i, j) <= (1 + kRounded) * both) continue;
      const char* key = i < 6 ? "covariance_mm_mrad" : "bending";
      return context.Child(key).Add(
          value.FindKey(key)->mark,
          fmt::format("is no covariance: row {}, column {}; allowed: what `millpose register` wrote", i + 1,
                      j + 1));
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
  codec.schema = [shift = by_turns[0].schema] {
    return codec_detail::ListSchema(shift(), kTriangle, kTriangle);
  };
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

/// The first three modes or more, by their names.
Codec<std::vector<double>> ModesFields() {
  const std::vector<std::string> names(kModeNames.begin(), kModeNames.end());
  const auto by_name = MapOf<double>(names, Real(kMm, Between(-100, 100)));
  Codec<std::vector<double>> codec;
  codec.type = by_name.type;
  codec.schema = by_name.schema;
  codec.keys = by_name.keys;
  codec.read = [by_name, names](const Value& value, const Context& context, std::vector<double>& result) {
    const size_t problems_before = context.problems.size();
    std::map<std::string, double> given;
    by_name.read(value, context, given);
    if (context.problems.size() > problems_before) return;
    result.clear();
    for (const std::string& name : names)
      if (result.size() == static_cast<size_t>(&name - names.data()) && given.contains(name))
        result.push_back(given.at(name));
    if (result.size() < kLeastModes || result.size() < given.size())
      context.Add(value.mark,
                  fmt::format("needs the first three or more of {}, none left out", fmt::join(names, ", ")));
  };
  codec.write = [names](const std::vector<double>& modes) {
    Value map = Value::Map();
    for (size_t i = 0; i < modes.size(); ++i)
      map.Put(names[i], Real(kMm, Between(-100, 100)).write(modes[i]));
    return map;
  };
  return codec;
}

/// Rows of modes, each from its first column to the diagonal.
Codec<std::vector<double>> ModeRowsFields() {
  const Codec<double> shifts = Real({"mm²", 1, 1}, Between(-1e9, 1e9)),
                      turns = Real({"mm·mrad", 1, 1e3}, Between(-1e9, 1e9));
  const auto codec_at = [=](size_t index) {
    size_t row = 7;
    for (; index >= row; ++row) index -= row;
    return index >= 3 && index < 6 ? turns : shifts;
  };
  Codec<std::vector<double>> codec;
  codec.type = "list of numbers";
  codec.schema = [shift = shifts.schema] { return codec_detail::ListSchema(shift()); };
  codec.read = [codec_at](const Value& value, const Context& context, std::vector<double>& result) {
    if (value.kind != Value::Kind::kList) return context.AddWrong(value, "a list of numbers");
    result.clear();
    for (size_t i = 0; i < value.items.size(); ++i)
      codec_at(i).read(value.items[i], context.Child(i), result.emplace_back());
  };
  codec.write = [codec_at](const std::vector<double>& numbers) {
    Value list = Value::List();
    for (size_t i = 0; i < numbers.size(); ++i) list.items.push_back(codec_at(i).write(numbers[i]));
    return list;
  };
  return codec;
}

void CheckBending(const Value& value, const Context& context, const BendingSettings& s) {
  constexpr double kShortest = 0.1, kNearlySquare = 0.99;  // mm; of the lengths' product
  const PartBending& bending = s.shape;
  const double lengths = bending.u.norm() * bending.v.norm();
  if (std::min(bending.u.norm(), bending.v.norm()) < kShortest ||
      bending.u.cross(bending.v).norm() < kNearlySquare * lengths)
    context.Add(value.mark, "u_mm and v_mm must be at right angles, of 0.1 mm or more");
  size_t numbers = 0;
  for (size_t i = 0; i < bending.modes.size(); ++i) numbers += 7 + i;
  if (s.covariance.size() != numbers)
    context.Child("covariance_mm_mrad")
        .Add(value.FindKey("covariance_mm_mrad")->mark,
             fmt::format("needs {} numbers for {} modes, given {}", numbers, bending.modes.size(),
                         s.covariance.size()));
}

Codec<BendingSettings> BendingFields() {
  using S = BendingSettings;
  return Section<S>(
      {Key<S>("origin_mm", MILLPOSE_AT(shape.origin), Coordinates(), "Where u = v = 0, workpiece's frame.")
           .Required(),
       Key<S>("u_mm", MILLPOSE_AT(shape.u), Coordinates(), "From there to u = 1.").Required(),
       Key<S>("v_mm", MILLPOSE_AT(shape.v), Coordinates(), "From there to v = 1, across u.").Required(),
       Key<S>("modes_mm", MILLPOSE_AT(shape.modes), ModesFields(),
              "Size of each mode at u = v = 1, along u × v (docs/registration.md).")
           .Required(),
       Key<S>("covariance_mm_mrad", MILLPOSE_AT(covariance), ModeRowsFields(),
              "The covariance's further rows: of each mode with shift, turn and the modes up to itself.")
           .Required()},
      CheckBending);
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
           .Required(),
       Key<S>("bending", MILLPOSE_AT(bending), Maybe(BendingFields()),
              "How the clamps bend the part: its surface and tool path are bent so.")},
      CheckCovariance);
}

// A pose changed by hand is not the one that was measured, and bending is what the job allows.
void CheckRegistered(const Value& value, const Context& context, const WorkpieceSettings& workpiece) {
  if (!workpiece.registered) return;
  if (workpiece.registered->bending && !(workpiece.max_bending.value_or(0) > 0))
    context.Child("registered")
        .Child("bending")
        .Add(value.FindKey("registered")->mark,
             "is not allowed by the job; allowed: workpiece.registration.max_bending_mm above what it bends, "
             "or "
             "no bending");
  const PoseSettings& found = workpiece.registered->pose;
  if (found.position == workpiece.pose.position && found.abc == workpiece.pose.abc) return;
  context.Child("registered")
      .Add(value.FindKey("registered")->mark,
           "is of another pose than workpiece.pose; allowed: the pose that `millpose "
           "register` wrote with it, or no workpiece.registered");
}

void CheckRegistration(const Value& value, const Context& context, const WorkpieceSettings& workpiece) {
  if (!workpiece.registration_tolerance && !workpiece.max_bending)
    context.Add(value.mark, "says nothing; allowed: tolerance_mm, max_bending_mm or both");
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
                 "Mesh, STEP or IGES file, relative to the job file; or box or cylinder.")
              .WhenSet(by_file),
          Key<S>("unit", MILLPOSE_AT(stock_unit), LengthUnit(),
                 "Unit of the mesh file; of a STEP, IGES or 3MF file the one that it states.")
              .WhenSet(by_file),
          Key<S>("box", MILLPOSE_AT(stock_box), Maybe(StockBoxFields()), "A box along the workpiece's axes."),
          Key<S>("cylinder", MILLPOSE_AT(stock_cylinder), Maybe(StockCylinderFields()), "A round bar."),
          Key<S>("resolution_mm", MILLPOSE_AT(stock_resolution), Real(kMm, Between(0.05, 10)),
                 "Between the lines on which it is known where material stands (docs/stock.md)."),
      },
      CheckStock);
}

Codec<FixtureSettings> FixtureFields() {
  using S = FixtureSettings;
  return Section<S>(
      {Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in findings; no other body has it.").Required(),
       Key<S>("mount", MILLPOSE_AT(mount),
              ChoiceOf<Mount>({{"workpiece", Mount::kWorkpiece}, {"world", Mount::kWorld}}),
              "Frame that its pose is given in: a clamp goes where the part goes, or stands on the table."),
       Key<S>("shape", MILLPOSE_AT(shape), ShapeFields(), "One shape.").Required(),
       Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Place of the shape in that frame.").Required()});
}

}  // namespace

Codec<WorkpieceSettings> WorkpieceFields() {
  using S = WorkpieceSettings;
  return Section<S>(
      {
          Key<S>("mesh", MILLPOSE_AT(mesh_file), Text(),
                 "Mesh, STEP or IGES file, relative to the job file; strategy cam, a list of holes and a "
                 "trimmed line go without.")
              .WhenSet([](const S& w) { return !w.mesh_file.empty(); }),
          Key<S>("unit", MILLPOSE_AT(unit), LengthUnit(),
                 "Unit of the mesh file; of a STEP, IGES or 3MF file the one that it states.")
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
          Key<S>(
              "registration", kSelf,
              Section<S>({Key<S>("tolerance_mm", MILLPOSE_AT(registration_tolerance),
                                 Maybe(Real(kMm, Positive(1000))),
                                 "By how much the milled face may be off along its normal, since nobody "
                                 "knows the part's place better (95 %); `millpose register` refuses more."),
                          Key<S>("max_bending_mm", MILLPOSE_AT(max_bending), Maybe(Real(kMm, UpTo(100))),
                                 "By how much the clamps may bend the part: `millpose register` takes "
                                 "bending up to that into account and refuses more; 0: the part is "
                                 "rigid, whatever the points say.")},
                         CheckRegistration),
              "What the part's place must be known to, and whether it may be bent.")
              .WhenSet([](const S& s) { return s.registration_tolerance || s.max_bending; }),
          Key<S>("registered", MILLPOSE_AT(registered), Maybe(RegisteredFields()),
                 "How sure the pose is: written by `millpose register`."),
          Key<S>("weld_tolerance_mm", MILLPOSE_AT(weld_tolerance), Real(kMm, UpTo(100)),
                 "Vertices of the mesh nearer than this become one."),
          Key<S>("flip", MILLPOSE_AT(flip), Flag(),
                 "Turn open sheets the other way round: their outside cannot be known."),
          Key<S>("chord_tolerance_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Between(1e-4, 100)),
                 "Of a STEP or IGES part: largest distance between its faces and their triangles."),
          Key<S>("step", kSelf,
                 Section<S>({
                     Key<S>("seconds", MILLPOSE_AT(step_seconds), Integer(1, 86400),
                            "Processor time and time on the clock."),
                     Key<S>("memory_MB", MILLPOSE_AT(step_memory), Integer(256, 1000000),
                            "Address space of the reading process."),
                 }),
                 "What the reading of a STEP, IGES or 3MF file may take."),
          Key<S>("allowance_mm", MILLPOSE_AT(allowance), Maybe(Real(kMm, UpTo(1000))),
                 "Material on the part's surface, added to every clearance from it.")
              .DefaultText("toolpath.depth.total_mm, with workpiece.stock 0"),
          Key<S>("stock", kSelf, StockFields(),
                 "The raw part, in the workpiece's frame: kept clear of between the cuts, and milled away "
                 "cut by cut.")
              .WhenSet([](const S& s) { return s.HasStock(); }),
          Key<S>("fixtures", MILLPOSE_AT(fixtures), ListOf(FixtureFields()),
                 "What clamps the part, beside the cell's bodies: kept clear of as a body of class fixture.")
              .WhenSet([](const S& s) { return !s.fixtures.empty(); }),
      },
      CheckPlacement);
}

}  // namespace millpose::config
