// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job file: one line each.
#include "config/fields.hpp"

namespace millpose::config {
namespace {

Codec<TargetSettings> TargetFields() {
  using S = TargetSettings;
  return Section<S>(
      {Key<S>("nominal_mm", MILLPOSE_AT(nominal), Numbers3(kMm, Between(-1e6, 1e6)),
              "In the workpiece frame.")
           .Required(),
       Key<S>("measured_mm", MILLPOSE_AT(measured), Numbers3(kMm, Between(-1e6, 1e6)), "In `frame`.")
           .Required()});
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
      KeyBy<S, std::string>(
          "unit", [](const S& s) { return LengthUnitName(s.stock_unit); },
          [](S& s, const std::string& name) { s.stock_unit = LengthUnit(name); }, Choice(LengthUnits()),
          "Unit of the mesh file; of a STEP file the one that it states.")
          .Required(),
  });
}

Codec<WorkpieceSettings> WorkpieceFields() {
  using S = WorkpieceSettings;
  return Section<S>(
      {
          Key<S>("mesh", MILLPOSE_AT(mesh_file), Text(),
                 "Mesh or STEP file, relative to the job file; strategy cam alone goes without.")
              .WhenSet([](const S& w) { return !w.mesh_file.empty(); }),
          KeyBy<S, std::string>(
              "unit", [](const S& s) { return s.unit_name; },
              [](S& s, const std::string& name) {
                s.unit_name = name;
                s.unit = LengthUnit(name);
              },
              Choice(LengthUnits()), "Unit of the mesh file; of a STEP file the one that it states.")
              .Required(),
          Key<S>("frame", MILLPOSE_AT(frame), Choice({"world", "robot_base"}),
                 "Frame that the pose or the measured points are given in."),
          Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Place of the workpiece; this or targets.")
              .WhenSet([](const S& s) { return s.targets.empty(); }),
          Key<S>(
              "targets", MILLPOSE_AT(targets), ListOf(TargetFields()),
              "Points of the part with where they were measured; the workpiece stands where they fit best.")
              .WhenSet([](const S& s) { return !s.targets.empty(); }),
          Key<S>("max_residual_mm", MILLPOSE_AT(max_residual), Real(kMm, Above(0)),
                 "Largest distance of a measured target from where the fit puts it."),
          Key<S>("weld_tolerance_mm", MILLPOSE_AT(weld_tolerance), Real(kMm, AtLeast(0)),
                 "Vertices of the mesh nearer than this become one."),
          Key<S>("chord_tolerance_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Between(1e-4, 100)),
                 "Of a STEP part: largest distance between its faces and their triangles."),
          Key<S>("allowance_mm", MILLPOSE_AT(allowance), Maybe(Real(kMm, AtLeast(0))),
                 "Material on the part's surface, added to every clearance from it.")
              .DefaultText("toolpath.depth.total_mm"),
          Key<S>("stock", kSelf, StockFields(),
                 "The raw part, kept clear of between the cuts; in the workpiece's frame.")
              .WhenSet([](const S& s) { return !s.stock_file.empty(); }),
      },
      CheckPlacement);
}

Codec<CamRotaryAxisSettings> CamRotaryAxisFields() {
  using S = CamRotaryAxisSettings;
  return Section<S>(
      {Key<S>("axis", MILLPOSE_AT(axis), Choice({"A", "B", "C"}), "Its address in the programme.").Required(),
       Key<S>("direction", MILLPOSE_AT(direction), Direction(),
              "Positive angles turn right-handed about it; workpiece frame, all rotary axes at 0.")
           .Required(),
       Key<S>("carries", MILLPOSE_AT(carries), Choice({"tool", "workpiece"}), "What it turns."),
       Key<S>("point_mm", MILLPOSE_AT(point), Numbers3(kMm, Between(-1e6, 1e6)),
              "A point of the axis: in the workpiece frame, of one that carries the tool from its tip. "
              "Needed where "
              "the programme does not name the tip (no TRAORI, no G43.4).")});
}

// A strategy's own section must be given with it and with no other.
void CheckStrategySections(const Value& value, const Context& context, ToolpathSettings& toolpath) {
  for (const auto& [section, strategy] :
       {std::pair("planes", "parallel_planes"), std::pair("rings", "rings"), std::pair("pad", "pad"),
        std::pair("curve", "curve"), std::pair("cam", "cam")}) {
    const Value::Key* key = value.FindKey(section);
    if (toolpath.strategy == strategy && !key)
      context.Child(section).Add(value.mark, fmt::format("missing; required by strategy {}", strategy));
    if (toolpath.strategy != strategy && key)
      context.Child(section).Add(
          key->mark, fmt::format("belongs to strategy {}, given {}", strategy, toolpath.strategy));
  }
}

void CheckCurve(const Value& value, const Context& context, ToolpathSettings& toolpath) {
  if (toolpath.curve_points.size() < 2)
    context.Add(value.mark,
                fmt::format("a line needs 2 points or more, given {}", toolpath.curve_points.size()));
}

Codec<DepthSettings> DepthFields() {
  using S = DepthSettings;
  return Section<S>({
      Key<S>("total_mm", MILLPOSE_AT(total), Real(kMm, AtLeast(0)), "Material above the surface."),
      Key<S>("per_layer_mm", MILLPOSE_AT(per_layer), Real(kMm, Above(0)), "Largest depth of a layer."),
      Key<S>("allowance_mm", MILLPOSE_AT(allowance), Real(kMm, AtLeast(0)), "Left on the surface."),
      Key<S>("finishing_mm", MILLPOSE_AT(finishing), Real(kMm, AtLeast(0)),
             "Depth of the last layer, of the total; 0: as deep as the others."),
  });
}

Codec<GougeSettings> GougeFields() {
  using S = GougeSettings;
  return Section<S>({
      Key<S>(
          "action", MILLPOSE_AT(action), Choice({"skip", "lift", "report"}),
          "Skip such points, lift them along the tool axis until the cutter is clear, or only report them."),
      Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, AtLeast(0.001)),
             "How deep the cutter may go into the part."),
  });
}

Codec<PassEndSettings> PassEndFields() {
  using S = PassEndSettings;
  return Section<S>({
      Key<S>("overrun_mm", MILLPOSE_AT(overrun), Real(kMm, AtLeast(0)), "Straight on beyond both ends."),
      Key<S>("lead", MILLPOSE_AT(lead), Choice({"none", "normal", "ramp", "arc"}),
             "How passes are entered and left."),
      Key<S>("lead_length_mm", MILLPOSE_AT(lead_length), Real(kMm, Above(0)),
             "Length of the lead; of an arc its radius."),
      Key<S>("ramp_deg", MILLPOSE_AT(ramp_angle), Real(kDeg, Between(0.1, 89)),
             "Angle of a ramp with the surface."),
  });
}

Codec<ToolpathSettings> ToolpathFields() {
  using S = ToolpathSettings;
  const auto strategy_is = [](const char* strategy) {
    return [strategy](const S& s) { return s.strategy == strategy; };
  };
  Codec<S> codec = Section<S>(
      {
          Key<S>("strategy", MILLPOSE_AT(strategy),
                 Choice({"parallel_planes", "rings", "pad", "contours", "curve", "cam"}),
                 "How passes are laid on the surface.")
              .Required(),
          Key<S>("region", MILLPOSE_AT(region), RegionFields(), "What is milled; everything by default."),
          Key<S>("planes", kSelf,
                 Section<S>({Key<S>("normal", MILLPOSE_AT(plane_normal), Direction(),
                                    "Normal of the planes, in the workpiece frame.")
                                 .Required()}),
                 "Strategy parallel_planes.")
              .WhenSet(strategy_is("parallel_planes")),
          Key<S>("rings", kSelf,
                 Section<S>({Key<S>("point_mm", MILLPOSE_AT(axis_point), Numbers3(kMm, Between(-1e6, 1e6)),
                                    "A point of the axis, in the workpiece frame.")
                                 .Required(),
                             Key<S>("axis", MILLPOSE_AT(axis_direction), Direction(),
                                    "Direction of the axis, in the workpiece frame.")
                                 .Required(),
                             Key<S>("on", MILLPOSE_AT(ring_surface), Choice({"auto", "faces", "walls"}),
                                    "Rings by radius (faces across the axis) or by height (walls around it); "
                                    "auto: what suits most of the region."),
                             Key<S>("path", MILLPOSE_AT(ring_path), Choice({"closed", "spiral"}),
                                    "A pass per ring, or one pass that winds on from ring to ring."),
                             Key<S>("seam_step_deg", MILLPOSE_AT(seam_step), Real(kDeg, Between(-360, 360)),
                                    "Angle by which each ring begins after the one before.")}),
                 "Strategy rings: around an axis.")
              .WhenSet(strategy_is("rings")),
          Key<S>("pad", kSelf,
                 Section<S>({Key<S>("pattern", MILLPOSE_AT(pad_pattern), Choice({"zigzag", "spiral"}),
                                    "Lines joined along the border, or rings from the border inwards."),
                             Key<S>("along", MILLPOSE_AT(pad_direction), Direction(),
                                    "Direction of the zigzag's lines, in the workpiece frame."),
                             Key<S>("offset_mm", MILLPOSE_AT(pad_offset), Maybe(Real(kMm, AtLeast(0))),
                                    "Distance of the tool from borders and islands; the cutter's radius by "
                                    "default.")}),
                 "Strategy pad: a plane region.")
              .WhenSet(strategy_is("pad")),
          Key<S>("curve", kSelf,
                 Section<S>(
                     {Key<S>("points_mm", MILLPOSE_AT(curve_points),
                             ListOf(Numbers3(kMm, Between(-1e6, 1e6))), "A polyline, in the workpiece frame.")
                          .Required(),
                      Key<S>("direction", MILLPOSE_AT(curve_direction), Direction(),
                             "Along it the line is projected onto the faces that face it.")
                          .Required()},
                     CheckCurve),
                 "Strategy curve: a single line.")
              .WhenSet(strategy_is("curve")),
          Key<S>("cam", kSelf,
                 Section<S>(
                     {Key<S>("file", MILLPOSE_AT(cam_file), Text(),
                             "APT CLDATA, G-code or CSV, in the workpiece frame.")
                          .Required(),
                      Key<S>("contact_distance_mm", MILLPOSE_AT(cam_contact_distance), Real(kMm, Above(0)),
                             "Points farther from the part at a pass's ends are its lead-in and lead-out."),
                      Key<S>("rotary_axes", MILLPOSE_AT(cam_rotary_axes), ListOf(CamRotaryAxisFields()),
                             "Of the machine that G-code was written for: those that carry the tool from the "
                             "bed to "
                             "the tool, those that carry the workpiece from the bed to it.")}),
                 "Strategy cam: an imported tool path.")
              .WhenSet(strategy_is("cam")),
          Key<S>("stepover_mm", MILLPOSE_AT(stepover), Real(kMm, Above(0)),
                 "Distance of neighbouring passes; not for strategies curve and cam.")
              .WhenSet([](const S& s) { return s.stepover > 0; }),
          Key<S>("stepover_on", MILLPOSE_AT(stepover_on), Choice({"planes", "surface"}),
                 "Whether the step-over is the distance of the planes (radii) or the way on the surface."),
          Key<S>(
              "scallop_mm", MILLPOSE_AT(scallop), Real(kMm, AtLeast(0)),
              "Height of what neighbouring passes leave between them; above 0 the step-over follows from it "
              "and from cutter and surface, stepover_mm at most."),
          Key<S>("direction", MILLPOSE_AT(direction), Choice({"zigzag", "one_way", "climb", "conventional"}),
                 "Every second pass backwards, all the same way, or with the unmilled material on the right "
                 "(climb) or left of a cutter that turns clockwise seen from its holder."),
          Key<S>("order", MILLPOSE_AT(order), Choice({"laid", "travel"}),
                 "Passes as the strategy lays them, or by short ways from each to the next."),
          Key<S>("chord_tolerance_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Above(0)),
                 "Largest distance between the surface's line and the straight line between points."),
          Key<S>("spacing_mm", MILLPOSE_AT(spacing), Real(kMm, Above(0)),
                 "Largest distance of neighbouring points."),
          Key<S>("crease_deg", MILLPOSE_AT(crease), Real(kDeg, Between(0, 180)),
                 "Normals are not averaged across edges sharper than this."),
          Key<S>("normal_smoothing_mm", MILLPOSE_AT(normal_smoothing), Real(kMm, AtLeast(0)),
                 "Length over which normals are averaged, for noisy meshes; creases are kept."),
          Key<S>("gouges", MILLPOSE_AT(gouges), GougeFields(),
                 "What is done where the cutter would go into the part."),
          Key<S>("depth", MILLPOSE_AT(depth), DepthFields(),
                 "Layers along the normals; one on the surface by default."),
          Key<S>("ends", MILLPOSE_AT(ends), PassEndFields(),
                 "What is added at the ends of passes; closed ones are opened for a lead."),
          Key<S>("lead_deg", MILLPOSE_AT(lead), Real(kDeg, Between(-89, 89)),
                 "Tool axis leans towards the feed direction."),
          Key<S>("tilt_deg", MILLPOSE_AT(tilt), Real(kDeg, Between(-89, 89)),
                 "Tool axis leans across the feed direction."),
          Key<S>("rotation_reference", MILLPOSE_AT(rotation_reference), Direction(),
                 "Direction in the world from which the rotation about the tool axis counts."),
      },
      CheckStrategySections);
  // Told beside other problems of the section, as keys that are always required are.
  codec.read = [read = codec.read](const Value& value, const Context& context, S& toolpath) {
    const Value* strategy = value.Find("strategy");
    const bool without = strategy != nullptr && (strategy->text == "curve" || strategy->text == "cam");
    if (value.kind == Value::Kind::kMap && !without && !value.FindKey("stepover_mm"))
      context.Child("stepover_mm").Add(value.mark, "missing; required: number > 0, mm");
    read(value, context, toolpath);
  };
  return codec;
}

Codec<GeneticSettings> GeneticFields() {
  using S = GeneticSettings;
  const auto check = [](const Value& value, const Context& context, S& genetic) {
    if (genetic.elite >= genetic.population)
      context.Child("elite").Add(value.mark, fmt::format("given {}; allowed: less than population, {}",
                                                         genetic.elite, genetic.population));
  };
  return Section<S>(
      {
          Key<S>("population", MILLPOSE_AT(population), Integer(2, 100000), "Candidates of a generation."),
          Key<S>("generations", MILLPOSE_AT(generations), Integer(1, 100000), "Most generations."),
          Key<S>("crossover_rate", MILLPOSE_AT(crossover_rate), Real(kOne, Between(0, 1)),
                 "Share of children with two parents."),
          Key<S>("mutation_rate", MILLPOSE_AT(mutation_rate), Real(kOne, Between(0, 1)),
                 "Share of children that are changed at random."),
          Key<S>("elite", MILLPOSE_AT(elite), Integer(0, 100000), "Best candidates kept as they are."),
          Key<S>("max_evaluations", MILLPOSE_AT(max_evaluations), Integer(10, 10000000),
                 "Most evaluations of the objective for one point."),
      },
      check);
}

Codec<PaperSettings> PaperFields() {
  using S = PaperSettings;
  const Unit compliance{"mm/N", 1, 1};
  const auto check = [](const Value& value, const Context& context, S& paper) {
    if (paper.elite >= paper.population)
      context.Child("elite").Add(value.mark, fmt::format("given {}; allowed: less than population, {}",
                                                         paper.elite, paper.population));
  };
  return Section<S>(
      {
          Key<S>("population", MILLPOSE_AT(population), Integer(2, 100000), "Candidates of a generation."),
          Key<S>("generations", MILLPOSE_AT(generations), Integer(1, 100000), "Generations."),
          Key<S>("elite", MILLPOSE_AT(elite), Integer(1, 100000), "Best candidates kept as they are."),
          Key<S>("crossover_rate", MILLPOSE_AT(crossover_rate), Real(kOne, Between(0, 1)),
                 "Share of children with two parents; the others are changed at random."),
          Key<S>("c_max_mm_N", MILLPOSE_AT(c_max), Real(compliance, Above(0)),
                 "Objective at which the fitness begins (eq. 29)."),
          Key<S>("penalty_mm_N", MILLPOSE_AT(penalty), Real(compliance, AtLeast(0)),
                 "Loss of fitness per squared error, errors in units of the tolerance (eq. 32-35)."),
      },
      check);
}

Codec<CuttingSettings> CuttingFields() {
  using S = CuttingSettings;
  const Unit specific{"N/mm²", 1, 1};
  return Section<S>(
      {
          Key<S>("material", MILLPOSE_AT(material), Text(),
                 "Material of the built-in table (docs/process-force.md)."),
          Key<S>("kc11_N_mm2", MILLPOSE_AT(kc11), Real(specific, AtLeast(0)),
                 "Specific cutting force at 1 mm chip thickness in place of the table's."),
          Key<S>("mc", MILLPOSE_AT(mc), Real(kOne, Between(0, 1)), "Exponent that goes with kc11_N_mm2."),
          Key<S>("teeth", MILLPOSE_AT(teeth), Integer(1, 100), "Teeth of the cutter.").Required(),
          Key<S>("depth_mm", MILLPOSE_AT(depth), Real(kMm, Above(0)), "Axial depth of cut.").Required(),
          Key<S>("width_mm", MILLPOSE_AT(width), Real(kMm, Above(0)), "Radial width of cut.").Required(),
          Key<S>("side", MILLPOSE_AT(side), Choice({"up", "down", "slot"}),
                 "Conventional, climb, or full-width milling."),
          Key<S>("radial_ratio", MILLPOSE_AT(radial_ratio), Real(kOne, Between(0, 2)),
                 "Radial ÷ tangential force."),
          Key<S>("axial_ratio", MILLPOSE_AT(axial_ratio), Real(kOne, Between(-2, 2)),
                 "Force on the tool towards the holder ÷ tangential force; negative pulls the tool out."),
      },
      nullptr);
}

// {name: …, further keys: numbers}; which keys an objective knows is the objective's own matter.
using Objective = std::pair<std::string, std::map<std::string, double>>;
Codec<Objective> ObjectiveFields() {
  const Codec<std::string> name = Text();
  const Codec<double> number = Real(kOne, Any());
  Codec<Objective> codec;
  codec.type = "map of name and the objective's parameters";
  codec.schema = codec_detail::SectionSchema({{"name", name.type, "", "Name of the objective.", true, {}}},
                                             {name.schema}, {Value()});
  codec.schema.items.back() = number.schema;  // additionalProperties
  codec.read = [=](const Value& value, const Context& context, Objective& result) {
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "a map of keys");
    if (!value.Find("name")) context.Child("name").Add(value.mark, "missing; required: " + name.type);
    result.second.clear();
    for (size_t i = 0; i < value.items.size(); ++i) {
      const std::string& key = value.keys[i].text;
      if (key == "name")
        name.read(value.items[i], context.Child(key), result.first);
      else
        number.read(value.items[i], context.Child(key), result.second[key]);
    }
  };
  codec.write = [=](const Objective& objective) {
    Value map = Value::Map();
    map.Put("name", name.write(objective.first));
    for (const auto& [key, parameter] : objective.second) map.Put(key, number.write(parameter));
    return map;
  };
  return codec;
}

// The paper's fitness knows eq. 23 alone.
void CheckFormulation(const Value& value, const Context& context, JobSettings& job) {
  if (job.formulation != "paper") return;
  const Value::Key* key = value.FindKey("formulation");
  const bool normalised =
      job.objective_parameters.contains("reference_t2") || job.objective_parameters.contains("reference_n");
  if (job.objective != "chen2021" || normalised)
    context.Child("formulation")
        .Add(key ? key->mark : value.mark,
             fmt::format("given paper; allowed only with objective chen2021 without references, given {}{}",
                         job.objective, normalised ? " with references" : ""));
}

Codec<JobSettings> PoseSearchFields() {
  using S = JobSettings;
  return Section<S>(
      {
          KeyBy<S, Objective>(
              "objective",
              [](const S& s) {
                return Objective{s.objective, s.objective_parameters};
              },
              [](S& s, const Objective& objective) {
                s.objective = objective.first;
                s.objective_parameters = objective.second;
              },
              ObjectiveFields(), "What is minimised at each point."),
          Key<S>("formulation", MILLPOSE_AT(formulation), Choice({"freedoms", "paper"}),
                 "What the genetic algorithm varies: the freedoms of a point, or, to compare, the six joint "
                 "angles "
                 "of Chen et al. 2021."),
          Key<S>("genetic", MILLPOSE_AT(genetic), GeneticFields(), "The genetic algorithm per point."),
          Key<S>("paper", MILLPOSE_AT(paper), PaperFields(), "Formulation paper."),
          Key<S>("exhaustive_step_deg", MILLPOSE_AT(exhaustive_step), Real(kDeg, Between(0.001, 30)),
                 "Grid of the exhaustive search that judges the genetic algorithm."),
      },
      CheckFormulation);
}

Codec<JobSettings> LimitFields() {
  using S = JobSettings;
  return Section<S>({
      Key<S>("margin_deg", MILLPOSE_AT(limit_margin), Real(kDeg, Between(0, 45)),
             "Distance that every axis keeps from its limits."),
      Key<S>("dexterity_min", MILLPOSE_AT(dexterity_min), Real(kOne, Between(0, 1)), "Least dexterity."),
      Key<S>("singularity_min", kSelf,
             Section<S>({
                 Key<S>("wrist", MILLPOSE_AT(wrist_min), Real(kOne, Between(0, 1)), "Least |sin A5|."),
                 Key<S>("elbow", MILLPOSE_AT(elbow_min), Real(kOne, Between(0, 1)),
                        "Least |sin| of the angle between upper arm and forearm."),
                 Key<S>("shoulder_mm", MILLPOSE_AT(shoulder_min), Real(kMm, AtLeast(0)),
                        "Least distance of the wrist centre from axis 1."),
             }),
             "Distances kept from singularities."),
      Key<S>("joints_deg", MILLPOSE_AT(task_limits), Maybe(Limits()),
             "Narrows the arm's own limits for this job."),
  });
}

Codec<JobSettings> PathFields() {
  using S = JobSettings;
  return Section<S>({
      Key<S>("rotation_step_deg", MILLPOSE_AT(rotation_step), Real(kDeg, Between(0.01, 45)),
             "Grid of rotations about the tool axis in the layered search."),
      Key<S>("max_joint_step_deg", MILLPOSE_AT(max_joint_step), Numbers6(kDeg, Above(0)),
             "Largest change of each axis between neighbouring points."),
      Key<S>("motion_weight", MILLPOSE_AT(motion_weight), Real({"objective's unit per rad²"}, AtLeast(0)),
             "Cost of joint motion beside the objective."),
      Key<S>("smoothing_loss_percent", MILLPOSE_AT(smoothing_loss), Real(kPercent, Between(0, 100)),
             "Share of a piece's objective that may be given up for smoother joints; 0: none."),
      Key<S>("split_overlap_mm", MILLPOSE_AT(overlap), Real(kMm, AtLeast(0)),
             "Way that is cut again where a pass has to be split; at least up to the next point."),
      Key<S>(
          "max_halfway_deviation_mm", MILLPOSE_AT(max_deviation), Real(kMm, AtLeast(0.001)),
          "Largest distance half-way between points of the tip from its straight line when the joints turn "
          "evenly."),
  });
}

Codec<JobSettings> GapFields() {
  using S = JobSettings;
  return Section<S>({
      Key<S>("retract_mm", MILLPOSE_AT(retract), Real(kMm, Above(0)),
             "Distance along the tool axis by which the tool leaves and approaches the part."),
      Key<S>("limit_margin_deg", MILLPOSE_AT(gap_limit_margin), Real(kDeg, Between(0, 90)),
             "Distance kept from the arm's own limits between cuts, on every axis."),
      Key<S>("max_iterations", MILLPOSE_AT(gap_iterations), Integer(1, 100000000),
             "Most iterations of the planner for one gap."),
      Key<S>("speed_share", MILLPOSE_AT(gap_speed_share), Real(kOne, Between(0.01, 1)),
             "Share of the axes' largest speeds and accelerations used in gaps."),
  });
}

Codec<ProgramOptionSettings> ProgramOptionFields() {
  using S = ProgramOptionSettings;
  return Section<S>({
      Key<S>("point_economy", kSelf,
             Section<S>({
                 Key<S>("chord_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Between(0, 0.015)),
                        "A point is left out where the controller's own motion passes it this near; 0 keeps "
                        "every point."),
                 Key<S>("angle_deg", MILLPOSE_AT(angle_tolerance), Real(kDeg, Between(0, 0.02)),
                        "Likewise for the tool's orientation."),
                 Key<S>("spacing_mm", MILLPOSE_AT(spacing), Real(kMm, AtLeast(0)),
                        "Least distance of points, where the tolerances allow it; nearer ones are counted."),
             }),
             "Points that the controller's own interpolation makes needless are left out."),
      Key<S>("dry_run_offset_mm", MILLPOSE_AT(dry_run_offset), Real(kMm, AtLeast(0)),
             "Lifts every cut along the tool axis, to see the program run in the air."),
      Key<S>("base_window", kSelf,
             Section<S>({
                 Key<S>("shift_mm", MILLPOSE_AT(base_shift), Real(kMm, AtLeast(0)), "Along X, Y and Z."),
                 Key<S>("turn_deg", MILLPOSE_AT(base_turn), Real(kDeg, Between(0, 5)), "About X, Y and Z."),
             }),
             "With workpiece.targets: how far $BASE may be shifted; reach and clearance are re-verified for "
             "it."),
      Key<S>("date", MILLPOSE_AT(date), Text(), "Printed in the programs' headers; none by default.")
          .WhenSet([](const S& s) { return !s.date.empty(); }),
  });
}

// Only a path from CAM has points without a surface.
void CheckPart(const Value& value, const Context& context, JobSettings& job) {
  const Value::Key* programs = value.FindKey("programs");
  job.programs_line = programs ? programs->mark.line : 0;
  const Value::Key* workpiece = value.FindKey("workpiece");
  if (workpiece && job.workpiece.mesh_file.empty() && job.toolpath.strategy != "cam")
    context.Child("workpiece")
        .Child("mesh")
        .Add(workpiece->mark, "missing; only strategy cam goes without a part");
}

}  // namespace

const Codec<JobSettings>& JobFields() {
  using S = JobSettings;
  static const Codec<S> fields = Section<S>(
      {
          VersionKey<S>("millpose_job", 1),
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name of the job.").Required(),
          Key<S>("cell", MILLPOSE_AT(cell_file), Text(), "Cell file, relative to the job file.").Required(),
          Key<S>("seed", MILLPOSE_AT(seed), Seed(), "Seed of all random numbers."),
          Key<S>("workpiece", MILLPOSE_AT(workpiece), WorkpieceFields(), "The part and its place.")
              .Required(),
          Key<S>("toolpath", MILLPOSE_AT(toolpath), ToolpathFields(), "Where the tool goes.").Required(),
          Key<S>(
              "process", kSelf,
              Section<S>({
                  Key<S>("feed_mm_min", MILLPOSE_AT(feed), Real(kMmPerMin, Above(0)), "Feed rate.")
                      .Required(),
                  Key<S>("spindle_rpm", MILLPOSE_AT(spindle_speed), Real(kRevPerMin, AtLeast(0)),
                         "Spindle speed.")
                      .Required(),
                  Key<S>("approach_feed_mm_min", MILLPOSE_AT(approach_feed), Real(kMmPerMin, Above(0)),
                         "Feed of the straight approach, where it is above the feed rate."),
                  Key<S>("approach_slow_mm", MILLPOSE_AT(approach_slow), Real(kMm, AtLeast(0)),
                         "Last part of the approach that runs at the feed rate."),
                  Key<S>("retract_feed_mm_min", MILLPOSE_AT(retract_feed), Real(kMmPerMin, Above(0)),
                         "Feed of the straight retract, where it is above the feed rate."),
                  Key<S>("feed", MILLPOSE_AT(feed_policy), Choice({"keep", "reduce"}),
                         "Where joints cannot hold the feed: keep it (a finding) or reduce it there."),
                  Key<S>("cutting", MILLPOSE_AT(cutting), Maybe(CuttingFields()),
                         "What the cutter takes off: gives the cutting force and the predicted deflection."),
              }),
              "Feed and speed.")
              .Required(),
          Key<S>("pose", kSelf, PoseSearchFields(), "How the pose at each point is chosen."),
          Key<S>("limits", kSelf, LimitFields(), "What makes a pose admissible."),
          Key<S>("path", kSelf, PathFields(), "How poses are joined along a pass."),
          Key<S>("interference", kSelf,
                 Section<S>({Key<S>("swept_resolution_mm", MILLPOSE_AT(swept_resolution), Real(kMm, Above(0)),
                                    "What a motion between two points may miss of a clearance.")}),
                 "How interference is checked."),
          Key<S>("gaps", kSelf, GapFields(), "How the tool moves from one pass to the next."),
          Key<S>("programs", MILLPOSE_AT(programs), ListOf(Choice({"krl", "sinumerik", "linuxcnc"})),
                 "Controllers to write programs for."),
          Key<S>("program_options", MILLPOSE_AT(program_options), ProgramOptionFields(),
                 "What becomes of the planned points in programs."),
      },
      CheckPart);
  return fields;
}

}  // namespace millpose::config
