// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `process:`, one line each.
#include "base/text.hpp"
#include "job/config/fields.hpp"
#include "planning/pose/expression.hpp"
#include "toolpath/engagement/cutting_material.hpp"

namespace millpose::config {
namespace {

/// Text, also where it looks like a number: 6061, 1.4404.
Codec<std::string> MaterialName() {
  Codec<std::string> codec = Text();
  codec.type = "name or number of a material";
  codec.schema = [text = codec.schema] {
    Value schema = text();
    schema.Put("type", Value::List({Value::Text("string"), Value::Text("number")}));
    return schema;
  };
  codec.read = [text = codec.read](const Value& value, const Context& context, std::string& result) {
    if (value.kind == Value::Kind::kScalar && value.plain && ParseNumber(value.text))
      result = value.text;
    else
      text(value, context, result);
  };
  return codec;
}

void CheckMaterial(const Value& value, const Context& context, const CuttingSettings& cutting) {
  if (const Value::Key* source = value.FindKey("kc11_source"); source && cutting.kc11 == 0)
    context.Child("kc11_source")
        .Add(source->mark, "has no effect without kc11_N_mm2: the table has its own source");
  if (cutting.kc11 > 0 || FindCuttingMaterial(cutting.material)) return;
  const Value* given = value.Find("material");
  context.Child("material").Add(given ? given->mark : value.mark, UnknownMaterial(cutting.material));
}

Codec<CuttingSettings> CuttingFields() {
  using S = CuttingSettings;
  const Unit specific{"N/mm²", 1, 1};
  const std::vector<Field<S>> fields = {
      Key<S>("material", MILLPOSE_AT(material), MaterialName(),
             "Material of the built-in table, by name or alias: AlMgSi, 6061, 7075, TiAl6V4, 316L, 1.4404, … "
             "(docs/process-force.md)."),
      Key<S>("kc11_N_mm2", MILLPOSE_AT(kc11), Real(specific, UpTo(1e5)),
             "Specific cutting force at 1 mm chip thickness in place of the table's."),
      Key<S>(
          "kc11_source", MILLPOSE_AT(kc11_source), Text(),
          "Where kc11_N_mm2 and mc come from, such as a cut with your own laminate and tool: said beside the "
          "forces' share of the error.")
          .WhenSet([](const S& s) { return !s.kc11_source.empty(); }),
      Key<S>("mc", MILLPOSE_AT(mc), Real(kOne, Between(0, 1)), "Exponent that goes with kc11_N_mm2."),
      Key<S>("teeth", MILLPOSE_AT(teeth), Integer(1, 100), "Teeth of the cutter.").Required(),
      Key<S>("depth_mm", MILLPOSE_AT(depth), Maybe(Real(kMm, Positive(1000))),
             "Axial depth of cut: the material on the surface; by default that of the layers of "
             "`toolpath.depth`, which it must equal."),
      Key<S>("width_mm", MILLPOSE_AT(width), Maybe(Real(kMm, Positive(1000))),
             "Radial width of cut, with `side`; the step-over by default, which it must equal."),
      Key<S>("side", MILLPOSE_AT(side), Maybe(ChoiceOf(kMillingSideWords)),
             "Conventional, climb, or full-width milling at every point, in place of what path and stock say "
             "(docs/engagement.md)."),
      Key<S>("radial_ratio", MILLPOSE_AT(radial_ratio), Real(kOne, Between(0, 2)),
             "Radial ÷ tangential force."),
      Key<S>("axial_ratio", MILLPOSE_AT(axial_ratio), Real(kOne, Between(-2, 2)),
             "Force on the tool towards the holder ÷ tangential force; negative pulls the tool out."),
  };
  return Section<S>(fields, CheckMaterial);
}

Codec<ForceFactors> ForceFactorFields() {
  using S = ForceFactors;
  const auto factor = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Real(kOne, Between(0.1, 10)), doc);
  };
  return Section<S>({
      factor("up", MILLPOSE_AT(up), "Where the edge meets thin chips first (conventional)."),
      factor("down", MILLPOSE_AT(down), "Where it meets thick ones first (climb)."),
      factor("slot", MILLPOSE_AT(slot), "At full width."),
  });
}

}  // namespace

bool AsksForceBounds(const JobSettings& job) {
  if (job.compensation.deflection != TakeOut::kOff) return true;
  return std::ranges::any_of(ObjectiveNamed(job.objective).parameters,
                             [](const ParameterRule& rule) { return rule.name == kForceBounds[0]; });
}

Codec<JobSettings> ProcessFields() {
  using S = JobSettings;
  return Section<S>({
      Key<S>("feed_mm_min", MILLPOSE_AT(feed), Real(kMmPerMin, Between(0.1, 2e5)), "Feed rate.").Required(),
      Key<S>("spindle_rpm", MILLPOSE_AT(spindle_speed), Real(kRevPerMin, UpTo(5e5)), "Spindle speed.")
          .Required(),
      Key<S>("plunge_feed_mm_min", MILLPOSE_AT(plunge_feed), Maybe(Real(kMmPerMin, Between(0.1, 2e5))),
             "Feed of every motion towards material: the last part of the straight approach, and lead-ins "
             "where theirs is higher; the feed rate by default."),
      Key<S>("approach_feed_mm_min", MILLPOSE_AT(approach_feed), Real(kMmPerMin, Between(0.1, 2e5)),
             "Feed of the straight approach before its last part.")
          .WhenSet([](const S& s) { return s.approach_slow < s.gaps.leave.height; }),
      Key<S>("approach_slow_mm", MILLPOSE_AT(approach_slow), Real(kMm, Positive(1e4)),
             "Last part of the approach, which runs at the plunge feed."),
      Key<S>("retract_feed_mm_min", MILLPOSE_AT(retract_feed), Real(kMmPerMin, Between(0.1, 2e5)),
             "Feed of the straight retract."),
      Key<S>("feed", MILLPOSE_AT(feed_policy),
             ChoiceOf<FeedPolicy>({{"keep", FeedPolicy::kKeep}, {"reduce", FeedPolicy::kReduce}}),
             "Where joints cannot hold the feed: reduce it there, or keep it (a finding)."),
      Key<S>("min_feed_share", MILLPOSE_AT(min_feed_share), Real(kOne, Between(0.01, 1)),
             "Share of the feed below which a reduced one is a finding: the edge rubs, and the force model "
             "no longer holds.")
          .WhenSet([](const S& s) { return s.feed_policy == FeedPolicy::kReduce; }),
      Key<S>("cutting", MILLPOSE_AT(cutting), Maybe(CuttingFields()),
             "What the cutter takes off: gives the cutting force and the predicted deflection."),
      Key<S>("force_factors", MILLPOSE_AT(force_factors), ForceFactorFields(),
             "Factors of the computed force, as a milled part gave them (millpose calibrate).")
          .WhenSet([](const S& s) { return s.force_factors != ForceFactors(); }),
      Key<S>("force_csv", MILLPOSE_AT(force_file), Text(),
             "Measured mean forces by point in place of the computed ones, for compensation; relative to the "
             "job file (docs/compensation.md).")
          .WhenSet([](const S& s) { return !s.force_file.empty(); }),
      Key<S>("stock", MILLPOSE_AT(stock),
             ChoiceOf<Standing>({{"region", Standing::kRegion}, {"mesh", Standing::kMesh}}),
             "The material before the first pass: the region raised by the depth of all layers, or what "
             "stands of "
             "`workpiece.stock`.")
          .WhenSet([](const S& s) { return s.cutting.has_value(); })
          .DefaultText("mesh with workpiece.stock, else region"),
      Key<S>("force_uncertainty_percent", MILLPOSE_AT(force_uncertainty_percent),
             Real({"%", 1, 1}, UpTo(1000)),
             "By how much the true cutting force may exceed the computed one; objectives surface_error and "
             "face_error, "
             "compensation.")
          .WhenSet(AsksForceBounds)
          .DefaultText("30"),
      Key<S>("force_direction_deg", MILLPOSE_AT(force_direction_deg), Real({"deg", 1, 1}, Between(0, 90)),
             "How far off the computed direction it may lie; objectives surface_error and face_error, "
             "compensation.")
          .WhenSet(AsksForceBounds)
          .DefaultText("20"),
  });
}

}  // namespace millpose::config
