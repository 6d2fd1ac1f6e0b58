// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `tool:`, one line each.
#include "config/fields.hpp"

namespace millpose::config {
namespace {

Codec<ToolPartSettings> ToolPartFields() {
  using S = ToolPartSettings;
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in findings and `excluded_pairs`.").Required(),
          Key<S>("class", MILLPOSE_AT(body_class), Choice({"cutter", "holder", "spindle"}),
                 "Decides the clearance and whether the part may touch the workpiece while cutting.")
              .Required(),
          Key<S>("length_mm", MILLPOSE_AT(length), Real(kMm, Above(0)), "Length along the tool axis.")
              .Required(),
          Key<S>("diameter_mm", MILLPOSE_AT(diameter), Real(kMm, Above(0)), "Diameter at the lower end.")
              .Required(),
          Key<S>("top_diameter_mm", MILLPOSE_AT(top_diameter), Real(kMm, Above(0)),
                 "Diameter at the upper end.")
              .DefaultText("as `diameter_mm`"),
      },
      [](const Value& value, const Context&, S& part) {
        if (!value.Find("top_diameter_mm")) part.top_diameter = part.diameter;
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
  const auto check_frame = [](const Value& value, const Context& context, S& tool) {
    if (tool.axis.cross(tool.x).norm() < 1e-3)
      context.Child("x_in_flange").Add(value.mark, "is parallel to axis_in_flange; allowed: across it");
  };
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name of the tool.").Required(),
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
                         Key<S>("shape", MILLPOSE_AT(cutter_shape), Choice({"flat", "ball", "bull"}),
                                "Shape of the tip: flat end mill, ball, or corner radius."),
                         Key<S>("diameter_mm", MILLPOSE_AT(cutter_diameter), Real(kMm, Above(0)),
                                "Diameter of the cutter.")
                             .Required(),
                         Key<S>("cutting_length_mm", MILLPOSE_AT(cutting_length), Real(kMm, Above(0)),
                                "Length from the tip that may be in the material while cutting.")
                             .Required(),
                         Key<S>("corner_radius_mm", MILLPOSE_AT(corner_radius), Real(kMm, AtLeast(0)),
                                "Corner radius of a bull cutter."),
                     },
                     check_cutter),
                 "The cutter.")
              .Required(),
          Key<S>("stack", MILLPOSE_AT(stack), ListOf(ToolPartFields()),
                 "Cutter, holder and spindle as cones from the tip upwards.")
              .Required(),
      },
      check_frame);
}

}  // namespace millpose::config
