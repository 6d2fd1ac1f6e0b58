// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `tool:`, one line each.
#include "job/config/fields.hpp"

namespace millpose {

double CornerRadius(const ToolSettings& tool) {
  return tool.cutter_tip == CutterTip::kBall   ? tool.cutter_diameter / 2
         : tool.cutter_tip == CutterTip::kBull ? tool.corner_radius
                                               : 0;
}

namespace config {
namespace {

Codec<ToolPartSettings> ToolPartFields() {
  using S = ToolPartSettings;
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in findings and `excluded_pairs`.").Required(),
          Key<S>("class", MILLPOSE_AT(body_class),
                 ChoiceOf<BodyClass>({{"cutter", BodyClass::kCutter},
                                      {"holder", BodyClass::kHolder},
                                      {"spindle", BodyClass::kSpindle}}),
                 "Decides the clearance and whether the part may touch the workpiece while cutting.")
              .Required(),
          Key<S>("length_mm", MILLPOSE_AT(length), Real(kMm, Positive(5000)), "Length along the tool axis.")
              .Required(),
          Key<S>("diameter_mm", MILLPOSE_AT(diameter), Real(kMm, Positive(5000)),
                 "Diameter at the lower end.")
              .Required(),
          Key<S>("top_diameter_mm", MILLPOSE_AT(top_diameter), Real(kMm, Positive(5000)),
                 "Diameter at the upper end.")
              .DefaultText("as `diameter_mm`"),
      },
      [](const Value& value, const Context&, S& part) {
        if (!value.Find("top_diameter_mm")) part.top_diameter = part.diameter;
      });
}

/// Radius of the cutter's own outline at height z above the tip.
double OutlineRadius(const ToolSettings& tool, double z) {
  const double radius = tool.cutter_diameter / 2, corner = CornerRadius(tool);
  const double below = std::max(0.0, corner - z);  // the centre of the corner's circle
  return radius - corner + std::sqrt(std::max(0.0, corner * corner - below * below));
}

/// How much thinner a part is than the cutter's outline, at the worst height between `bottom` (of the part)
/// and `top`, mm.
double Lack(const ToolSettings& tool, const ToolPartSettings& part, double bottom, double top) {
  const double corner = CornerRadius(tool);
  const double slope = (part.top_diameter - part.diameter) / 2 / part.length;
  // The outline is straight or bulges outwards, so that the worst height is an end, where its corner begins,
  // or where both rise alike.
  const double alike = corner - corner * slope / std::sqrt(1 + slope * slope);
  double worst = 0;
  for (const double z : {bottom, std::clamp(corner, bottom, top), std::clamp(alike, bottom, top), top})
    worst = std::max(worst, OutlineRadius(tool, z) - (part.diameter / 2 + slope * (z - bottom)));
  return worst;
}

/// What is milled with must be what interference is checked with: where the cutter may be in the material the
/// stack has a cutter there, at least as thick.
void CheckStack(const Value& value, const Context& context, const ToolSettings& tool) {
  constexpr double kSame = 1e-6;  // mm
  const Value& stack = *value.Find("stack");
  const Context at_stack = context.Child("stack");
  double bottom = 0;
  for (size_t i = 0; i < tool.stack.size() && bottom < tool.cutting_length; ++i) {
    const ToolPartSettings& part = tool.stack[i];
    const double top = std::min(bottom + part.length, tool.cutting_length);
    const Context at_part = at_stack.Child(i);
    if (part.body_class != BodyClass::kCutter) {
      at_part.Add(
          stack.items[i].mark,
          fmt::format("a {} from {:.6g} mm above the tip; allowed within cutting_length_mm, {:.6g}: class "
                      "cutter",
                      WordOf(kBodyClassWords, part.body_class), bottom, tool.cutting_length));
    } else if (const double lack = Lack(tool, part, bottom, top); lack > kSame) {
      at_part.Add(stack.items[i].mark,
                  fmt::format("up to {:.6g} mm thinner than the cutter of diameter_mm {:.6g}; allowed within "
                              "cutting_length_mm: at least as thick",
                              2 * lack, tool.cutter_diameter));
    }
    bottom += part.length;
  }
  if (bottom + kSame < tool.cutting_length)
    at_stack.Add(stack.mark, fmt::format("{:.6g} mm long; allowed: at least cutter.cutting_length_mm, {:.6g}",
                                         bottom, tool.cutting_length));
}

Codec<ToolLoad> LoadFields() {
  using S = ToolLoad;
  return Section<S>({
      Key<S>("mass_kg", MILLPOSE_AT(mass), Real({"kg"}, Between(0.001, 10000)), "Mass.").Required(),
      Key<S>("centre_in_flange_mm", MILLPOSE_AT(centre), Numbers3(kMm, Between(-5000, 5000)),
             "Centre of gravity in the flange frame.")
          .Required(),
      Key<S>("inertia_kg_m2", MILLPOSE_AT(inertia), Numbers3({"kg·m²"}, Between(0, 100000)),
             "Moments of inertia about the centre of gravity, along the flange's x, y, z.")
          .Required(),
  });
}

}  // namespace

Codec<ToolSettings> ToolFields() {
  using S = ToolSettings;
  const auto check_cutter = [](const Value& value, const Context& context, S& tool) {
    if (tool.corner_radius > tool.cutter_diameter / 2)
      context.Child("corner_radius_mm")
          .Add(value.mark, fmt::format("given {} mm; allowed: at most half of diameter_mm, {} mm",
                                       tool.corner_radius, tool.cutter_diameter / 2));
  };
  const auto check = [](const Value& value, const Context& context, S& tool) {
    const Value& name = *value.Find("name");
    tool.name_place = {context.file, name.mark.line, name.mark.column};
    CheckStack(value, context, tool);
    if (tool.axis.cross(tool.x).norm() < 1e-3)
      context.Child("x_in_flange").Add(value.mark, "is parallel to axis_in_flange; allowed: across it");
    for (size_t i = 0; i < tool.compliances.size(); ++i)
      if (tool.compliances[i].link != 6)
        context.Child("compliances")
            .Child(i)
            .Child("mount")
            .Add(value.Find("compliances")->items[i].mark, "of a tool; allowed: link6");
  };
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name of the tool.").Required(),
          Key<S>("number", MILLPOSE_AT(number), Maybe(Integer(1, 99999)),
                 "Number by which controllers know the tool: {number} of their texts."),
          Key<S>("tip_in_flange_mm", MILLPOSE_AT(tip), Numbers3(kMm, Between(-5000, 5000)),
                 "Tool tip in the flange frame.")
              .Required(),
          Key<S>("axis_in_flange", MILLPOSE_AT(axis), Direction(),
                 "Tool axis in the flange frame, from tip to holder: z of the tool frame.")
              .Required(),
          Key<S>("x_in_flange", MILLPOSE_AT(x), Direction(),
                 "Direction in the flange frame whose part across the tool axis is x of the tool frame.")
              .Required(),
          Key<S>("cutter", kSelf,
                 Section<S>(
                     {
                         Key<S>("shape", MILLPOSE_AT(cutter_tip), ChoiceOf(kCutterTipWords),
                                "Shape of the tip: flat end mill, ball, or corner radius."),
                         Key<S>("diameter_mm", MILLPOSE_AT(cutter_diameter), Real(kMm, Between(0.01, 1000)),
                                "Diameter of the cutter.")
                             .Required(),
                         Key<S>("cutting_length_mm", MILLPOSE_AT(cutting_length), Real(kMm, Positive(5000)),
                                "Length from the tip that may be in the material while cutting.")
                             .Required(),
                         Key<S>("corner_radius_mm", MILLPOSE_AT(corner_radius), Real(kMm, UpTo(500)),
                                "Corner radius of a bull cutter."),
                         Key<S>("centre_cutting", MILLPOSE_AT(centre_cutting), Flag(),
                                "Whether it cuts over its centre: may be lowered straight into material.")
                             .WhenSet([](const S& s) { return s.centre_cutting; }),
                         Key<S>("max_ramp_deg", MILLPOSE_AT(max_ramp), Real(kDeg, Between(0.1, 90)),
                                "Steepest ramp or helix by which it may enter material.")
                             .WhenSet([](const S& s) { return s.max_ramp != S{}.max_ramp; }),
                     },
                     check_cutter),
                 "The cutter.")
              .Required(),
          Key<S>("stack", MILLPOSE_AT(stack), ListOf(ToolPartFields()),
                 "Cutter, holder and spindle as cones from the tip upwards.")
              .Required(),
          Key<S>("tip_uncertainty_mm", MILLPOSE_AT(tip_uncertainty), Maybe(Real(kMm, UpTo(100))),
                 "How far the tool's tip may lie from where it was measured, the arm's own error counted: "
                 "says how high "
                 "a step the surface may show where the pose changes."),
          Key<S>("axis_uncertainty_deg", MILLPOSE_AT(axis_uncertainty), Maybe(Real(kDeg, UpTo(10))),
                 "How far the tool axis may lean from where it was measured; as `tip_uncertainty_mm`."),
          Key<S>("load", MILLPOSE_AT(load), Maybe(LoadFields()),
                 "What hangs on the flange in all, as the controller's load data have it; printed in KRL "
                 "headers, "
                 "and written as $LOAD where the cell asks (write_load)."),
          Key<S>("compliances", MILLPOSE_AT(compliances), ListOf(ComplianceFields()),
                 "What gives way only while this tool is in the spindle (mount link6), in addition to "
                 "`stiffness.compliances`.")
              .WhenSet([](const S& s) { return !s.compliances.empty(); }),
      },
      check);
}

}  // namespace config
}  // namespace millpose
