// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a measurements file, and the CSV form of it.
#include "base/csv.hpp"
#include "base/rounded.hpp"
#include "base/yaml/edit.hpp"
#include "job/config/config.hpp"
#include "job/config/fields.hpp"
#include "job/config/measurements.hpp"

namespace millpose {
namespace config {
namespace {

const Unit kNewton{"N", 1, 1}, kRad{"rad", 1, 1};
const Range kNearFlange = Between(-10000, 10000);

std::vector<Field<MeasurementSettings>> MeasuredLoadFields() {
  using S = MeasurementSettings;
  std::vector<Field<S>> fields;
  fields.push_back(
      Key<S>("joints_deg", MILLPOSE_AT(joints), Numbers6(kDeg, Between(-3600, 3600)), "Joint angles.")
          .Required());
  fields.push_back(Key<S>("force_N", MILLPOSE_AT(force), Numbers3(kNewton, Between(-1e9, 1e9)),
                          "Force on the arm, robot base frame."));
  fields.push_back(Key<S>("moment_Nm", MILLPOSE_AT(moment), Numbers3(kNewtonMetre, Between(-1e9, 1e9)),
                          "Moment on the arm, robot base frame."));
  fields.push_back(Key<S>("load_point_mm", MILLPOSE_AT(load_point), Maybe(Numbers3(kMm, kNearFlange)),
                          "Where the load acts, flange frame; else as for the file."));
  fields.push_back(Key<S>("measured_point_mm", MILLPOSE_AT(measured_point), Maybe(Numbers3(kMm, kNearFlange)),
                          "Whose displacement was measured, flange frame; else as for the file."));
  return fields;
}

void CheckLoad(const Value& value, const Context& context, MeasurementSettings& load) {
  load.line = value.mark.line;
  if (load.force.isZero(0.0) && load.moment.isZero(0.0))
    context.Add(value.mark, "no load; allowed: force_N or moment_Nm other than 0");
}

Codec<MeasurementSettings> MeasurementFields() {
  using S = MeasurementSettings;
  std::vector<Field<S>> fields = MeasuredLoadFields();
  fields.push_back(Key<S>("displacement_mm", MILLPOSE_AT(displacement), Numbers3(kMm, Between(-1e6, 1e6)),
                          "Displacement against the unloaded arm, robot base frame.")
                       .Required());
  fields.push_back(Key<S>("rotation_rad", MILLPOSE_AT(rotation), Maybe(Numbers3(kRad, Between(-7, 7))),
                          "Rotation vector against the unloaded arm, robot base frame."));
  return Section<S>(std::move(fields), CheckLoad);
}

void CheckTwoWay(const Value& value, const Context& context, TwoWaySettings& reading) {
  const bool pushed = reading.push.has_value();
  const char *own[] = {"from_below_mm", "from_above_mm"}, *other[] = {"pushed_against_mm", "pushed_along_mm"};
  if (pushed) std::swap(own, other);
  for (const char* key : own)
    if (value.FindKey(key) == nullptr)
      context.Child(key).Add(value.mark,
                             fmt::format("missing; required {} push_N", pushed ? "with" : "without"));
  for (const char* key : other)
    if (const Value::Key* given = value.FindKey(key))
      context.Child(key).Add(given->mark, fmt::format("has no effect {} push_N; allowed: {}, {}",
                                                      pushed ? "with" : "without", own[0], own[1]));
  for (const char* key : own)
    if (const Value* list = value.Find(key); list != nullptr && list->items.empty())
      context.Child(key).Add(list->mark, "given no reading; allowed: at least one");
}

Codec<TwoWaySettings> TwoWayFields() {
  using S = TwoWaySettings;
  const Codec<std::vector<double>> readings = ListOf(Real(kMm, Between(-1000, 1000)));
  return Section<S>(
      {
          Key<S>("joint", MILLPOSE_AT(joint), Integer(1, 6), "The joint that moved, or that is pushed.")
              .Required(),
          Key<S>("joints_deg", MILLPOSE_AT(joints), Numbers6(kDeg, Between(-3600, 3600)), "Joint angles.")
              .Required(),
          Key<S>("measured_point_mm", MILLPOSE_AT(measured_point), Maybe(Numbers3(kMm, kNearFlange)),
                 "Where the dial touches, flange frame; else as for the file."),
          Key<S>("direction", MILLPOSE_AT(direction), yaml::Direction(),
                 "In which the dial counts, robot base frame.")
              .Required(),
          Key<S>("from_below_mm", MILLPOSE_AT(from_below), readings,
                 "Readings with the joint come from smaller angles."),
          Key<S>("from_above_mm", MILLPOSE_AT(from_above), readings, "The same from greater angles."),
          Key<S>(
              "push_N", MILLPOSE_AT(push), Maybe(Real(kNewton, Positive(1e5))),
              "In place of coming from both sides: force at the measured point along the direction, and as "
              "much against it."),
          Key<S>("pushed_against_mm", MILLPOSE_AT(pushed_against), readings,
                 "Readings with that force against the direction."),
          Key<S>("pushed_along_mm", MILLPOSE_AT(pushed_along), readings, "The same along it."),
      },
      CheckTwoWay);
}

const Codec<MeasurementsSettings>& MeasurementsFields() {
  using S = MeasurementsSettings;
  static const Codec<S> fields = Section<S>({
      VersionKey<S>("millpose_measurements", 1),
      Key<S>("cell", MILLPOSE_AT(cell_file), Text(),
             "Cell file with the arm's geometry, relative to this file."),
      Key<S>("load_point_mm", MILLPOSE_AT(load_point), Numbers3(kMm, kNearFlange),
             "Where loads act, flange frame."),
      Key<S>("measured_point_mm", MILLPOSE_AT(measured_point), Numbers3(kMm, kNearFlange),
             "Whose displacement is measured, flange frame."),
      Key<S>("displacement_deviation_mm", MILLPOSE_AT(displacement_deviation), Real(kMm, Between(1e-6, 100)),
             "Standard deviation of a displacement's component; weighs it against rotations."),
      Key<S>("rotation_deviation_rad", MILLPOSE_AT(rotation_deviation), Real(kRad, Between(1e-9, 1)),
             "Standard deviation of a rotation's component."),
      Key<S>("measurements", MILLPOSE_AT(measurements), ListOf(MeasurementFields()), "What was measured."),
      Key<S>("two_way", MILLPOSE_AT(two_way), ListOf(TwoWayFields()),
             "Readings taken both ways, for the lost motion of joints."),
      Key<S>("candidates", MILLPOSE_AT(candidates),
             ListOf(Section<MeasurementSettings>(MeasuredLoadFields(), CheckLoad)),
             "Poses and loads from which `identify --propose` chooses."),
  });
  return fields;
}

}  // namespace
}  // namespace config

MeasurementsSettings ParseMeasurements(std::string_view yaml, const std::string& name) {
  const config::Value root = config::ReadYaml(yaml, name);
  std::vector<Problem> problems;
  MeasurementsSettings settings;
  settings.file = name;
  config::MeasurementsFields().read(root, {name, problems, ""}, settings);
  if (!problems.empty()) throw InputError(std::move(problems));
  return settings;
}

MeasurementsSettings ParseMeasurementsCsv(std::string_view csv, const std::string& name) {
  const CsvTable table = ReadCsv(csv, name,
                                 {{"a1_deg", "a2_deg", "a3_deg", "a4_deg", "a5_deg", "a6_deg", "fx_N", "fy_N",
                                   "fz_N", "dx_mm", "dy_mm", "dz_mm"},
                                  {"mx_Nm", "my_Nm", "mz_Nm", "rx_rad", "ry_rad", "rz_rad"}});
  std::vector<Problem> problems;
  for (const auto& [first, second, third] :
       {std::array{"mx_Nm", "my_Nm", "mz_Nm"}, std::array{"rx_rad", "ry_rad", "rz_rad"}}) {
    const int given = table.Has(first) + table.Has(second) + table.Has(third);
    if (given != 0 && given != 3)
      problems.push_back(
          {{name, 1},
           fmt::format("only part of {},{},{}; allowed: all three, or none", first, second, third)});
  }
  MeasurementsSettings settings;
  settings.file = name;
  for (size_t row = 0; row < table.size(); ++row) {
    const auto three = [&](const char* x, const char* y, const char* z) {
      const auto value = [&](const char* column) { return table.Has(column) ? table.At(row, column) : 0.0; };
      return Eigen::Vector3d(value(x), value(y), value(z));
    };
    MeasurementSettings measurement;
    for (int j = 0; j < 6; ++j) {
      const std::string column = fmt::format("a{}_deg", j + 1);
      const double degrees = table.At(row, column);
      measurement.joints[j] = DegToRad(degrees);
      if (std::abs(degrees) > 3600)
        problems.push_back(
            {{name, table.line(row)}, fmt::format("{}: given {}; allowed: -3600 to 3600", column, degrees)});
    }
    measurement.force = three("fx_N", "fy_N", "fz_N");
    measurement.moment = 1000 * three("mx_Nm", "my_Nm", "mz_Nm");
    measurement.displacement = three("dx_mm", "dy_mm", "dz_mm");
    if (table.Has("rx_rad")) measurement.rotation = three("rx_rad", "ry_rad", "rz_rad");
    measurement.line = table.line(row);
    constexpr double kMost = 1e9, kFarthest = 1e6;  // as in the YAML form
    if (measurement.force.cwiseAbs().maxCoeff() > kMost ||
        measurement.moment.cwiseAbs().maxCoeff() > 1000 * kMost ||
        measurement.displacement.cwiseAbs().maxCoeff() > kFarthest ||
        (measurement.rotation && measurement.rotation->cwiseAbs().maxCoeff() > 7))
      problems.push_back({{name, measurement.line},
                          "a number is too large; allowed: within ±1e9 N and N·m, ±1e6 mm and ±7 rad"});
    if (measurement.force.isZero(0.0) && measurement.moment.isZero(0.0))
      problems.push_back({{name, measurement.line}, "no load; allowed: a force or a moment other than 0"});
    settings.measurements.push_back(measurement);
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return settings;
}

std::vector<TrackedRow> ParseTracked(std::string_view csv, const std::string& name) {
  constexpr size_t kMost = 4;  // reflectors
  constexpr double kFarthest = 1e6, kTurned = 3600;
  CsvColumns columns{{"a1_deg", "a2_deg", "a3_deg", "a4_deg", "a5_deg", "a6_deg"}, {"x_mm", "y_mm", "z_mm"}};
  for (size_t k = 1; k <= kMost; ++k)
    for (const char axis : {'x', 'y', 'z'}) columns.optional.push_back(fmt::format("{}{}_mm", axis, k));
  const CsvTable table = ReadCsv(csv, name, columns);
  std::vector<Problem> problems;
  std::vector<std::string> present;  // what stands behind x, y and z of each reflector
  const auto look = [&](const std::string& number) {
    int given = 0;
    for (const char axis : {'x', 'y', 'z'}) given += table.Has(fmt::format("{}{}_mm", axis, number));
    if (given == 3) present.push_back(number);
    if (given == 1 || given == 2)
      problems.push_back(
          {{name, 1},
           fmt::format("only part of x{0}_mm,y{0}_mm,z{0}_mm; allowed: all three, or none", number)});
  };
  look("");
  for (size_t k = 1; k <= kMost; ++k) look(std::to_string(k));
  if (present.empty() && problems.empty())
    problems.push_back({{name, 1}, "no reflector; needed: x_mm,y_mm,z_mm, or x1_mm,y1_mm,z1_mm and so on"});
  if (present.size() > 1 && present.front().empty())
    problems.push_back({{name, 1}, "given x_mm and x1_mm …; allowed: one of the two"});
  std::vector<TrackedRow> rows;
  for (size_t row = 0; row < table.size() && problems.empty(); ++row) {
    TrackedRow& read = rows.emplace_back();
    read.line = table.line(row);
    for (int j = 0; j < 6; ++j) {
      const double degrees = table.At(row, fmt::format("a{}_deg", j + 1));
      if (std::abs(degrees) > kTurned)
        problems.push_back(
            {{name, read.line}, fmt::format("a{}_deg: given {}; allowed: -3600 to 3600", j + 1, degrees)});
      read.joints[j] = DegToRad(degrees);
    }
    for (const std::string& number : present) {
      const auto at = [&](char axis) { return table.At(row, fmt::format("{}{}_mm", axis, number)); };
      read.reflectors.emplace_back(at('x'), at('y'), at('z'));
      if (read.reflectors.back().cwiseAbs().maxCoeff() > kFarthest)
        problems.push_back({{name, read.line}, "a coordinate is too large; allowed: within 1e6 mm"});
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return rows;
}

std::string ReplaceDeviations(const std::string& cell_yaml, const std::string& name,
                              const DeviationSettings& deviations, const std::string& serial) {
  DeviationSettings whole = deviations;
  const ArmSettings before = ParseCell(cell_yaml, name).arm;
  if (before.deviations && before.serial == serial) {
    const std::vector<JointCoupling>& known = before.deviations->couplings;
    whole.gears = before.deviations->gears;
    whole.couplings.insert(whole.couplings.begin(), known.begin(), known.end());
    for (DeviationPattern& pattern : whole.patterns)
      if (!pattern.factors.empty()) pattern.factors.insert(pattern.factors.begin(), known.size(), 0);
  }
  std::string text = config::WithKey(cell_yaml, name, "arm", "deviations",
                                     config::WriteYamlLine(config::DeviationFields().write(whole)));
  text = config::WithKey(text, name, "arm", "serial", config::WriteYamlLine(config::Value::Text(serial)));
  ParseCell(text, name);
  return text;
}

std::string ReplaceJointStiffness(const std::string& cell_yaml, const std::string& name,
                                  const IdentifiedStiffness& found) {
  const auto list = [](const config::Unit& unit, const Vector6& values) {
    std::vector<std::string> numbers;
    for (const double value : values) numbers.push_back(config::ShortestIn(unit, value));
    return fmt::format("[{}]", fmt::join(numbers, ", "));
  };
  const config::Value root = config::ReadYaml(cell_yaml, name);
  const config::Value* arm = root.Find("arm");
  if (!arm || !arm->Find("joint_stiffness_Nm_per_rad"))
    throw InputError({name}, "arm.joint_stiffness_Nm_per_rad is missing");
  std::string text = config::WithKey(cell_yaml, name, "arm", "stiffness_uncertainty_percent",
                                     list(config::kPercent, found.uncertainty));
  text = config::WithKey(text, name, "arm", "joint_stiffness_Nm_per_rad",
                         list(config::kNmPerRad, found.stiffness));
  if (!arm->Find("joint_stiffness_source")) return text;
  return config::WithKey(text, name, "arm", "joint_stiffness_source",
                         config::WriteYamlLine(config::Value::Text(found.source)));
}

std::string ReplaceCompliances(const std::string& cell_yaml, const std::string& name,
                               const std::vector<ComplianceSettings>& found) {
  constexpr std::string_view kOwn = "identified ";  // what their names begin with
  const config::Value root = config::ReadYaml(cell_yaml, name);
  const config::Value* stiffness = root.Find("stiffness");
  const config::Value* standing = stiffness ? stiffness->Find("compliances") : nullptr;
  std::vector<config::Value> entries;
  for (size_t i = 0; standing && i < standing->items.size(); ++i) {
    const config::Value* called = standing->items[i].Find("name");
    if (called && called->text.starts_with(kOwn)) continue;
    entries.push_back(standing->items[i]);
    if (!found.empty())
      throw InputError(
          {name, standing->items[i].mark.line, standing->items[i].mark.column},
          "stiffness.compliances: has entries that millpose identify has not written, and what it finds "
          "would "
          "count them twice; allowed: a cell without them, or --springs, which finds the joints' alone");
  }
  if (found.empty() && entries.size() == (standing ? standing->items.size() : 0)) return cell_yaml;
  const auto digits = [](double value) { return WithDigits(value, 3); };
  for (ComplianceSettings one : found) {
    one.name = std::string(kOwn) + one.name;
    one.translational = one.translational.unaryExpr(digits);
    one.rotational = one.rotational.unaryExpr(digits);
    entries.push_back(config::ComplianceFields().write(one));
  }
  return config::WithKey(cell_yaml, name, "stiffness", "compliances",
                         config::WriteYamlLine(config::Value::List(std::move(entries))));
}

std::string ReplaceLostMotion(const std::string& cell_yaml, const std::string& name, const Vector6& width,
                              const std::string& source) {
  std::vector<std::string> numbers;
  for (const double value : width)  // three digits: no dial carries more
    numbers.push_back(fmt::format("{:.3g}", value * config::kArcmin.divisor / config::kArcmin.factor));
  const std::string text = config::WithKey(cell_yaml, name, "arm", "lost_motion_arcmin",
                                           fmt::format("[{}]", fmt::join(numbers, ", ")));
  return config::WithKey(text, name, "arm", "lost_motion_source",
                         config::WriteYamlLine(config::Value::Text(source)));
}

}  // namespace millpose
