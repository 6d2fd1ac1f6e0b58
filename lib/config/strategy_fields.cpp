// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `toolpath:` that belong to one strategy: a function per strategy, a line per key.
#include "base/text.hpp"
#include "config/fields.hpp"

namespace millpose::config {
namespace {

using S = ToolpathSettings;

Codec<S> PlanesFields() {
  return Section<S>({Key<S>("normal", MILLPOSE_AT(plane_normal), Direction(),
                            "Normal of the planes, in the workpiece frame.")
                         .Required()});
}

Codec<S> RingsFields() {
  return Section<S>(
      {Key<S>("point_mm", MILLPOSE_AT(axis_point), Place(), "A point of the axis, in the workpiece frame.")
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
              "Angle by which each ring begins after the one before.")});
}

Codec<S> PadFields() {
  return Section<S>(
      {Key<S>("pattern", MILLPOSE_AT(pad_pattern), Choice({"zigzag", "spiral"}),
              "Lines joined along the border, or rings from the border inwards."),
       Key<S>("along", MILLPOSE_AT(pad_direction), Direction(),
              "Direction of the zigzag's lines, in the workpiece frame."),
       Key<S>("offset_mm", MILLPOSE_AT(pad_offset), Maybe(Real(kMm, UpTo(1000))),
              "Distance of the tool from borders and islands; the cutter's radius by default.")});
}

void CheckCurve(const Value& value, const Context& context, ToolpathSettings& toolpath) {
  if (toolpath.curve_points.size() < 2)
    context.Add(value.mark,
                fmt::format("a line needs 2 points or more, given {}", toolpath.curve_points.size()));
}

Codec<S> CurveFields() {
  return Section<S>(
      {Key<S>("points_mm", MILLPOSE_AT(curve_points), ListOf(Place()), "A polyline, in the workpiece frame.")
           .Required(),
       Key<S>("direction", MILLPOSE_AT(curve_direction), Direction(),
              "Along it the line is projected onto the faces that face it.")
           .Required()},
      CheckCurve);
}

Codec<CamRotaryAxisSettings> CamRotaryAxisFields() {
  using Axis = CamRotaryAxisSettings;
  return Section<Axis>(
      {Key<Axis>("axis", MILLPOSE_AT(axis), Choice({"A", "B", "C"}), "Its address in the programme.")
           .Required(),
       Key<Axis>("direction", MILLPOSE_AT(direction), Direction(),
                 "Positive angles turn right-handed about it; workpiece frame, all rotary axes at 0.")
           .Required(),
       Key<Axis>("carries", MILLPOSE_AT(carries), Choice({"tool", "workpiece"}), "What it turns."),
       Key<Axis>("point_mm", MILLPOSE_AT(point), Place(),
                 "A point of the axis: in the workpiece frame, of one that carries the tool from its tip. "
                 "Needed where the programme does not name the tip (no TRAORI, no G43.4).")});
}

// Every key is "M" with a number, and keys that hold for another format are told when the file is read.
void CheckCam(const Value& value, const Context& context, ToolpathSettings& toolpath) {
  for (const auto& [code, meaning] : toolpath.cam_kinematics_codes) {
    const auto number = code.size() > 1 && code[0] == 'M' ? ParseNumber(code.substr(1)) : std::nullopt;
    if (!number || !(*number >= 0 && *number <= 9999 && *number == std::floor(*number)))
      context.Add(value.mark, fmt::format("kinematics_codes needs codes like M428, given \"{}\"", code));
  }
}

Codec<S> CamFields() {
  return Section<S>(
      {Key<S>("file", MILLPOSE_AT(cam_file), Text(), "APT CLDATA, G-code or CSV, in the workpiece frame.")
           .Required(),
       Key<S>("contact_distance_mm", MILLPOSE_AT(cam_contact_distance), Real(kMm, Positive(1000)),
              "Points farther from the part at a pass's ends are its lead-in and lead-out."),
       Key<S>("rotary_axes", MILLPOSE_AT(cam_rotary_axes), ListOf(CamRotaryAxisFields()),
              "Of the machine that G-code was written for: those that carry the tool from the "
              "bed to the tool, those that carry the workpiece from the bed to it."),
       Key<S>(
           "tip_programming", MILLPOSE_AT(cam_tip_programming), Maybe(Flag()),
           "Of G-code: whether X, Y, Z are the tip's in the workpiece frame where the file begins (else the "
           "machine's linear axes), and what M codes of the kinematics (M128, M428 to M430) that "
           "kinematics_codes does not name stand for."),
       Key<S>("kinematics_codes", MILLPOSE_AT(cam_kinematics_codes),
              MapOf<std::string>({}, Choice({"tip", "joints"})),
              "Of G-code: what X, Y, Z are from such an M code on, e.g. {M428: tip, M429: joints}."),
       Key<S>("circle", MILLPOSE_AT(cam_circle), Choice({"both", "tangent", "axis"}),
              "Of APT: what decides which way round a CIRCLE with an axis goes where the cut before and the "
              "axis's sign contradict; both: the file is refused there.")},
      CheckCam);
}

}  // namespace

const std::vector<StrategySection>& StrategySections() {
  static const std::vector<StrategySection> sections{
      {"parallel_planes", "planes", PlanesFields(), "Strategy parallel_planes."},
      {"rings", "rings", RingsFields(), "Strategy rings: around an axis."},
      {"pad", "pad", PadFields(), "Strategy pad: a plane region."},
      {"contours", "", {}, ""},
      {"curve", "curve", CurveFields(), "Strategy curve: a single line."},
      {"cam", "cam", CamFields(), "Strategy cam: an imported tool path."},
  };
  return sections;
}

}  // namespace millpose::config
