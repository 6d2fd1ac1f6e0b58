// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `toolpath:`, one line each.
#include "config/fields.hpp"

namespace millpose::config {
namespace {

Codec<double> Stepover() { return Real(kMm, Between(0.001, 1e4)); }

// A strategy's own section must be given with it and with no other.
void CheckStrategySections(const Value& value, const Context& context, ToolpathSettings& toolpath) {
  for (const auto& [strategy, section, fields, doc] : StrategySections()) {
    if (section.empty()) continue;
    const Value::Key* key = value.FindKey(section);
    if (toolpath.strategy == strategy && !key)
      context.Child(section).Add(value.mark, fmt::format("missing; required by strategy {}", strategy));
    if (toolpath.strategy != strategy && key)
      context.Child(section).Add(
          key->mark, fmt::format("belongs to strategy {}, given {}", strategy, toolpath.strategy));
  }
}

Codec<DepthSettings> DepthFields() {
  using S = DepthSettings;
  return Section<S>({
      Key<S>("total_mm", MILLPOSE_AT(total), Real(kMm, UpTo(1000)), "Material above the surface."),
      Key<S>("per_layer_mm", MILLPOSE_AT(per_layer), Real(kMm, Between(0.001, 1000)),
             "Largest depth of a layer."),
      Key<S>("allowance_mm", MILLPOSE_AT(allowance), Real(kMm, UpTo(1000)), "Left on the surface."),
      Key<S>("finishing_mm", MILLPOSE_AT(finishing), Real(kMm, UpTo(1000)),
             "Depth of the last layer, of the total; 0: as deep as the others."),
  });
}

Codec<GougeSettings> GougeFields() {
  using S = GougeSettings;
  return Section<S>({
      Key<S>(
          "action", MILLPOSE_AT(action), Choice({"skip", "lift", "report"}),
          "Skip such points, lift them along the tool axis until the cutter is clear, or only report them."),
      Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, Between(0.001, 100)),
             "How deep the cutter may go into the part."),
  });
}

Codec<PassEndSettings> PassEndFields() {
  using S = PassEndSettings;
  return Section<S>({
      Key<S>("overrun_mm", MILLPOSE_AT(overrun), Real(kMm, UpTo(1000)), "Straight on beyond both ends."),
      Key<S>("lead", MILLPOSE_AT(lead), Choice({"none", "normal", "ramp", "arc"}),
             "How passes are entered and left."),
      Key<S>("lead_length_mm", MILLPOSE_AT(lead_length), Real(kMm, Positive(1000)),
             "Length of the lead; of an arc its radius."),
      Key<S>("ramp_deg", MILLPOSE_AT(ramp_angle), Real(kDeg, Between(0.1, 89)),
             "Angle of a ramp with the surface."),
  });
}

// The keys that all strategies share.
std::vector<Field<ToolpathSettings>> CommonKeys() {
  using S = ToolpathSettings;
  return {
      Key<S>("stepover_mm", MILLPOSE_AT(stepover), Stepover(),
             "Distance of neighbouring passes; not for strategies curve and cam.")
          .WhenSet([](const S& s) { return s.stepover > 0; }),
      Key<S>("stepover_on", MILLPOSE_AT(stepover_on), Choice({"planes", "surface"}),
             "Whether the step-over is the distance of the planes (radii) or the way on the surface."),
      Key<S>("scallop_mm", MILLPOSE_AT(scallop), Real(kMm, UpTo(100)),
             "Height of what neighbouring passes leave between them; above 0 the step-over follows from "
             "it and from cutter and surface, stepover_mm at most."),
      Key<S>("direction", MILLPOSE_AT(direction), Choice({"zigzag", "one_way", "climb", "conventional"}),
             "Every second pass backwards, all the same way, or with the unmilled material on the right "
             "(climb) or left of a cutter that turns clockwise seen from its holder."),
      Key<S>("order", MILLPOSE_AT(order), Choice({"laid", "travel"}),
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
  };
}

std::vector<std::string> StrategyChoices() {
  std::vector<std::string> names;
  for (const StrategySection& section : StrategySections()) names.push_back(section.strategy);
  return names;
}

}  // namespace

Codec<ToolpathSettings> ToolpathFields() {
  using S = ToolpathSettings;
  std::vector<Field<S>> fields{
      Key<S>("strategy", MILLPOSE_AT(strategy), Choice(StrategyChoices()),
             "How passes are laid on the surface.")
          .Required(),
      Key<S>("region", MILLPOSE_AT(region), RegionFields(), "What is milled; everything by default."),
  };
  for (const auto& [strategy, section, own, doc] : StrategySections())
    if (!section.empty())
      fields.push_back(Key<S>(section, kSelf, own, doc).WhenSet([name = strategy](const S& s) {
        return s.strategy == name;
      }));
  std::ranges::move(CommonKeys(), std::back_inserter(fields));
  Codec<S> codec = Section<S>(std::move(fields), CheckStrategySections);
  // Told beside other problems of the section, as keys that are always required are.
  codec.read = [read = codec.read](const Value& value, const Context& context, S& toolpath) {
    const Value* strategy = value.Find("strategy");
    const bool without = strategy != nullptr && (strategy->text == "curve" || strategy->text == "cam");
    if (value.kind == Value::Kind::kMap && !without && !value.FindKey("stepover_mm"))
      context.Child("stepover_mm").Add(value.mark, "missing; required: " + Stepover().type);
    read(value, context, toolpath);
    const Value* chord = value.Find("chord_tolerance_mm");
    if (chord != nullptr && toolpath.chord_tolerance > toolpath.gouges.tolerance)
      context.Child("chord_tolerance_mm")
          .Add(chord->mark,
               fmt::format("given {} mm; at most gouges.tolerance_mm, {} mm: beyond it the chords themselves "
                           "count as gouges",
                           toolpath.chord_tolerance, toolpath.gouges.tolerance));
  };
  return codec;
}

}  // namespace millpose::config
