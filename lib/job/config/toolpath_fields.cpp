// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `toolpath:`, one line each.
#include "job/config/fields.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose::config {
namespace {

Codec<double> Stepover() { return Real(kMm, Between(0.001, 1e4)); }

Codec<ToolAxisOptions> ToolAxisFields() {
  using S = ToolAxisOptions;
  const auto by_place = [](const S& s) { return s.rule == AxisRule::kToward || s.rule == AxisRule::kAway; };
  const auto check = [by_place](const Value& value, const Context& context, S& axis) {
    const auto key = [&](const char* name, bool required, bool allowed) {
      const Value::Key* found = value.FindKey(name);
      if (required && !found) context.Child(name).Add(value.mark, "missing; required by this rule");
      if (found && !allowed) context.Child(name).Add(found->mark, "has no effect with this rule");
    };
    const bool along = axis.rule == AxisRule::kFixed || axis.rule == AxisRule::kWall;
    key("direction", along, along || by_place(axis));
    key("point_mm", by_place(axis), by_place(axis));
  };
  return Section<S>(
      {Key<S>("rule", MILLPOSE_AT(rule),
              ChoiceOf<AxisRule>({{"normal", AxisRule::kNormal},
                                  {"fixed", AxisRule::kFixed},
                                  {"toward", AxisRule::kToward},
                                  {"away", AxisRule::kAway},
                                  {"wall", AxisRule::kWall}}),
              "Along the surface's normal, in one direction, with the holder towards or away from a point "
              "or a line, or along the wall.")
           .Required(),
       Key<S>("direction", MILLPOSE_AT(direction), Direction(),
              "Of fixed and wall: from tip to holder, of wall about; of toward and away the line's through "
              "point_mm, and without it "
              "the point counts.")
           .WhenSet([](const S& s) { return s.direction.norm() > 0; }),
       Key<S>("point_mm", MILLPOSE_AT(point), Coordinates(), "Of toward and away, in the workpiece frame.")
           .WhenSet(by_place)},
      check);
}

// Keys that nothing would follow as the strategy's options stand.
void CheckUseless(const Value& value, const Context& context, const ToolpathSettings& toolpath) {
  for (const std::string& name : toolpath.strategy->WithoutEffect())
    if (const Value::Key* key = value.FindKey(name))
      context.Child(name).Add(key->mark, fmt::format("has no effect with strategy {} here; leave it out",
                                                     toolpath.strategy->Name()));
}

// Leans that the search chooses need a surface that they lean over.
void CheckLeans(const Value& value, const Context& context, const ToolpathSettings& toolpath) {
  const auto refuse = [&](const std::string& key, const std::string& why) {
    if (const Value::Key* found = value.FindKey(key)) context.Child(key).Add(found->mark, why);
  };
  const auto refuse_ranges = [&](const std::string& why) {
    for (const FreedomEntry& entry : Freedoms().entries())
      if (entry.leans && toolpath.Find(entry.name)) refuse(entry.key->info.key, why);
  };
  if (dynamic_cast<const SurfaceStrategy*>(toolpath.strategy.get()) == nullptr)
    refuse_ranges("a range is for strategies that mill a surface along it; give a number with strategy " +
                  toolpath.strategy->Name());
  else if (toolpath.tool_axis.rule != AxisRule::kNormal)
    refuse_ranges("a range leans the tool from the surface's normal; give a number, or leave tool_axis out");
  if (!toolpath.Leans())
    refuse("min_cutting_speed_share", "has no effect here: needs a range in " + LeanKeys());
  else if (toolpath.lead == 0 && toolpath.tilt == 0)
    refuse("min_cutting_speed_share", "has no effect here: at the nominal lean, 0, the cutting speed is 0");
}

// A strategy's own section must be given with it and with no other.
void CheckStrategySections(const Value& value, const Context& context, ToolpathSettings& toolpath) {
  const std::string given = toolpath.strategy->Name();
  for (const StrategyEntry& entry : Strategies().entries()) {
    if (entry.section.empty()) continue;
    const Value::Key* key = value.FindKey(entry.section);
    if (given == entry.name && !key)
      context.Child(entry.section)
          .Add(value.mark, fmt::format("missing; required by strategy {}", entry.name));
    if (given != entry.name && key)
      context.Child(entry.section)
          .Add(key->mark, fmt::format("belongs to strategy {}, given {}", entry.name, given));
  }
  CheckUseless(value, context, toolpath);
  CheckLeans(value, context, toolpath);
}

Codec<Layers> DepthFields() {
  using S = Layers;
  return Section<S>({
      Key<S>("total_mm", MILLPOSE_AT(total), Real(kMm, UpTo(1000)), "Material above the surface."),
      Key<S>("per_layer_mm", MILLPOSE_AT(per_layer), Real(kMm, Between(0.001, 1000)),
             "Largest depth of a layer."),
      Key<S>("allowance_mm", MILLPOSE_AT(allowance), Real(kMm, UpTo(1000)), "Left on the surface."),
      Key<S>("finishing_mm", MILLPOSE_AT(finishing), Real(kMm, UpTo(1000)),
             "Depth of the last layer, of the total; 0: as deep as the others."),
  });
}

Codec<GougeOptions> GougeFields() {
  using S = GougeOptions;
  return Section<S>({
      Key<S>(
          "action", MILLPOSE_AT(action),
          ChoiceOf<GougeAction>(
              {{"skip", GougeAction::kSkip}, {"lift", GougeAction::kLift}, {"report", GougeAction::kReport}}),
          "Skip such points, lift them along the tool axis until the cutter is clear, or only report them."),
      Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, Between(0.001, 100)),
             "How deep the cutter may go into the part."),
  });
}

Codec<PathSection> ShareFields() {
  using S = PathSection;
  const auto check = [](const Value& value, const Context& context, S& share) {
    if (!value.FindKey("from_mm") && !value.FindKey("to_mm"))
      context.Add(value.mark, "missing; required: from_mm or to_mm, or both");
    if (share.from >= share.to) context.Add(value.mark, "to_mm must be more than from_mm");
  };
  const auto bound = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Real(kMm, Between(-1e6, 1e6)), doc).WhenSet([access](const S& s) {
      return std::isfinite(access(s));
    });
  };
  return Section<S>(
      {Key<S>("direction", MILLPOSE_AT(direction), Direction(), "In the workpiece frame.").Required(),
       bound("from_mm", MILLPOSE_AT(from), "Where the share begins along it; missing: with the path."),
       bound("to_mm", MILLPOSE_AT(to), "Where it ends; missing: with the path."),
       Key<S>("overlap_mm", MILLPOSE_AT(overlap), Real(kMm, UpTo(10000)),
              "Passes run on by half of it beyond both, so that neighbouring shares overlap by it.")},
      check);
}

Codec<PassEnds> PassEndFields() {
  using S = PassEnds;
  return Section<S>({
      Key<S>("overrun_mm", MILLPOSE_AT(overrun), Real(kMm, UpTo(1000)), "Straight on beyond both ends."),
      Key<S>(
          "lead", MILLPOSE_AT(lead),
          ChoiceOf<LeadShape>({{"none", LeadShape::kNone},
                               {"normal", LeadShape::kNormal},
                               {"ramp", LeadShape::kRamp},
                               {"arc", LeadShape::kArc},
                               {"along", LeadShape::kAlong}}),
          "How passes are entered and left; along: entered to and fro along the pass itself, ever deeper."),
      Key<S>("lead_length_mm", MILLPOSE_AT(lead_length), Real(kMm, Positive(1000)),
             "Length of the lead; of an arc its radius, of along its height."),
      Key<S>("ramp_deg", MILLPOSE_AT(ramp_angle), Real(kDeg, Between(0.1, 89)),
             "Angle of a ramp, and of along, with the surface."),
  });
}

// The keys that all strategies share, up to those of freedoms.
std::vector<Field<ToolpathSettings>> CommonKeys() {
  using S = ToolpathSettings;
  using Way = millpose::Direction;
  return {
      Key<S>("share", MILLPOSE_AT(share), Maybe(ShareFields()),
             "What of the laid path is milled: the part from one of several stations (docs/placement.md)."),
      Key<S>("stepover_mm", MILLPOSE_AT(stepover), Stepover(),
             "Distance of neighbouring passes; not for strategies curve and cam.")
          .WhenSet([](const S& s) { return s.stepover > 0; }),
      Key<S>("stepover_on", MILLPOSE_AT(stepover_on_surface),
             ChoiceOf<bool>({{"planes", false}, {"surface", true}}),
             "Whether the step-over is the distance of the planes (radii) or the way on the surface."),
      Key<S>("scallop_mm", MILLPOSE_AT(scallop), Real(kMm, UpTo(100)),
             "Height of what neighbouring passes leave between them; above 0 the step-over follows from "
             "it and from cutter and surface, stepover_mm at most."),
      Key<S>("direction", MILLPOSE_AT(direction),
             ChoiceOf<Way>({{"zigzag", Way::kZigzag},
                            {"one_way", Way::kOneWay},
                            {"climb", Way::kClimb},
                            {"conventional", Way::kConventional}}),
             "Every second pass backwards, all the same way, or with the unmilled material on the right "
             "(climb) or left of a cutter that turns clockwise seen from its holder."),
      Key<S>("order", MILLPOSE_AT(order_by_travel), ChoiceOf<bool>({{"laid", false}, {"travel", true}}),
             "Passes as the strategy lays them, or by short ways from each to the next."),
      Key<S>("chord_tolerance_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Between(1e-5, 100)),
             "Largest distance between the surface's line and the straight line between points."),
      Key<S>("spacing_mm", MILLPOSE_AT(spacing), Real(kMm, Between(0.001, 1e4)),
             "Largest distance of neighbouring points."),
      Key<S>("crease_deg", MILLPOSE_AT(crease), Real(kDeg, Between(0, 180)),
             "Normals are not averaged across edges sharper than this."),
      Key<S>("normal_smoothing_mm", MILLPOSE_AT(normal_smoothing), Real(kMm, UpTo(1000)),
             "Length over which normals are averaged, for noisy meshes; creases are kept."),
      Key<S>("gouges", MILLPOSE_AT(gouges), GougeFields(),
             "What is done where the cutter would go into the part."),
      Key<S>("depth", MILLPOSE_AT(layers), DepthFields(),
             "Layers along the normals; one on the surface by default."),
      Key<S>("ends", MILLPOSE_AT(ends), PassEndFields(),
             "What is added at the ends of passes; closed ones are opened for a lead."),
      Key<S>("tool_axis", MILLPOSE_AT(tool_axis), ToolAxisFields(),
             "Where the tool comes from; along the surface's normal by default.")
          .WhenSet([](const S& s) { return s.tool_axis.rule != AxisRule::kNormal; }),
  };
}

// The keys that open freedoms: each freedom's own (lib/planning/pose/freedoms/).
std::vector<Field<ToolpathSettings>> FreedomKeys() {
  std::vector<Field<ToolpathSettings>> keys;
  for (const FreedomEntry& entry : Freedoms().entries())
    if (const auto& key = entry.key) keys.push_back({*key, key->read, key->write});
  return keys;
}

// And those behind them.
std::vector<Field<ToolpathSettings>> LastKeys() {
  using S = ToolpathSettings;
  return {
      Key<S>(
          "min_cutting_speed_share", MILLPOSE_AT(min_cutting_speed_share), Real(kOne, UpTo(1)),
          "Where leans are ranges, of a ball: least cutting speed at the contact, as a share of that at the "
          "nominal lean.")
          .WhenSet([](const S& s) { return s.Leans() && (s.lead != 0 || s.tilt != 0); })
          .DefaultText("0.3"),
      Key<S>("rotation_reference", MILLPOSE_AT(world_reference), Direction(),
             "Direction in the world from which the rotation about the tool axis counts."),
  };
}

// The strategy's name; its own section comes later and replaces its options.
Field<ToolpathSettings> StrategyKey() {
  using S = ToolpathSettings;
  return KeyBy<S, std::string>(
             "strategy", [](const S& s) { return s.strategy ? s.strategy->Name() : std::string(); },
             [](S& s, const std::string& name) { s.strategy = Strategies().At(name).make(); },
             Choice(Strategies().Names()), "How passes are laid on the surface.")
      .Required();
}

// What a job may not give, its resolved text does not show.
void LeaveOutUseless(Field<ToolpathSettings>& field) {
  field.write = [key = field.info.key, write = field.write](const ToolpathSettings& toolpath) {
    if (!toolpath.strategy) return write(toolpath);
    const std::vector<std::string> useless = toolpath.strategy->WithoutEffect();
    return std::ranges::find(useless, key) == useless.end() ? write(toolpath) : Value();
  };
}

Field<ToolpathSettings> OwnSection(const StrategyEntry& entry) {
  using S = ToolpathSettings;
  Codec<StrategyPointer> codec = entry.options;
  codec.read = [read = codec.read, name = entry.name](const Value& value, const Context& context,
                                                      StrategyPointer& strategy) {
    StrategyPointer made;
    read(value, context, made);  // wrong keys of another strategy's section are reported too
    if (strategy && strategy->Name() == name) strategy = made;
  };
  return Key<S>(entry.section, MILLPOSE_AT(strategy), codec, entry.doc)
      .WhenSet([name = entry.name](const S& s) { return s.strategy && s.strategy->Name() == name; });
}

}  // namespace

Codec<ToolpathSettings> ToolpathFields() {
  using S = ToolpathSettings;
  std::vector<Field<S>> fields{StrategyKey(), Key<S>("region", MILLPOSE_AT(region), RegionFields(),
                                                     "What is milled; everything by default.")};
  for (const StrategyEntry& entry : Strategies().entries())
    if (!entry.section.empty()) fields.push_back(OwnSection(entry));
  for (const auto& keys : {CommonKeys(), FreedomKeys(), LastKeys()})
    fields.insert(fields.end(), keys.begin(), keys.end());
  for (Field<S>& field : fields) LeaveOutUseless(field);
  Codec<S> codec = Section<S>(std::move(fields), CheckStrategySections);
  // Told beside other problems of the section, as keys that are always required are.
  codec.read = [read = codec.read](const Value& value, const Context& context, S& toolpath) {
    const Value* name = value.Find("strategy");
    const auto entry =
        std::ranges::find(Strategies().entries(), name ? name->text : "", &StrategyEntry::name);
    const bool prescribed = entry != Strategies().entries().end() && entry->make()->IsPrescribed();
    if (value.kind == Value::Kind::kMap && !prescribed && !value.FindKey("stepover_mm"))
      context.Child("stepover_mm").Add(value.mark, "missing; required: " + Stepover().type);
    read(value, context, toolpath);
    const Value* chord = value.Find("chord_tolerance_mm");
    if (chord != nullptr && toolpath.chord_tolerance > toolpath.gouges.tolerance)
      context.Child("chord_tolerance_mm")
          .Add(chord->mark,
               fmt::format("given {} mm; at most toolpath.gouges.tolerance_mm, {} mm: beyond it the chords "
                           "themselves count as gouges",
                           toolpath.chord_tolerance, toolpath.gouges.tolerance));
  };
  return codec;
}

}  // namespace millpose::config
