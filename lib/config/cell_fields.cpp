// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell file: one line each.
#include "config/fields.hpp"

namespace millpose::config {
namespace {

constexpr struct {
  const char* name;
  double mm;
} kLengthUnits[] = {{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"m", 1000}};

Codec<UrdfSettings> UrdfFields() {
  using S = UrdfSettings;
  return Section<S>(
      {
          Key<S>("file", MILLPOSE_AT(file), Text(), "URDF, relative to the cell file.").Required(),
          Key<S>("base_link", MILLPOSE_AT(base_link), Text(), "Link whose frame is the robot base.")
              .Required(),
          Key<S>("flange_link", MILLPOSE_AT(flange_link), Text(),
                 "Link whose frame is the flange; six joints lead to it from the base.")
              .Required(),
          Key<S>("packages", MILLPOSE_AT(packages), MapOf<std::string>({}, Text()),
                 "Folders that `package://NAME/` stands for, relative to the cell file."),
          Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, Above(0)),
                 "Largest deviation of the closed form from the file's joints."),
      },
      [](const Value& value, const Context&, S& urdf) { urdf.line = value.mark.line; });
}

/// With a URDF, what it says is not said again; what it does not say must be.
void CheckArm(const Value& value, const Context& context, ArmSettings& arm) {
  if (arm.urdf.file.empty()) return;
  for (const char* key : {"lengths_mm", "axis_signs", "zero_offsets_deg"})
    if (const auto* given = value.FindKey(key))
      context.Child(key).Add(given->mark, "is derived from the URDF; allowed: one of the two");
}

Codec<ArmSettings> ArmFields() {
  using S = ArmSettings;
  const auto explicit_arm = [](const S& s) { return s.urdf.file.empty(); };
  const auto length = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Real(kMm, Between(-10000, 10000)), doc).Required();
  };
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Maker and model.").Required(),
          Key<S>(
              "urdf", MILLPOSE_AT(urdf), UrdfFields(),
              "A URDF from which lengths, signs, offsets, limits, speeds and bodies of the links are taken.")
              .WhenSet([](const S& s) { return !s.urdf.file.empty(); }),
          Key<S>("lengths_mm", kSelf,
                 Section<S>({
                     length("d1", MILLPOSE_AT(d1), "Height of axis 2 above the base."),
                     length("a1", MILLPOSE_AT(a1), "Axis 1 to axis 2, horizontally."),
                     length("a2", MILLPOSE_AT(a2), "Axis 2 to axis 3."),
                     length("d4", MILLPOSE_AT(d4), "Axis 3 to the wrist centre, along the forearm."),
                     length("dz", MILLPOSE_AT(dz), "Axis 3 to the wrist centre, across the forearm."),
                     length("d6", MILLPOSE_AT(d6), "Wrist centre to the flange."),
                 }),
                 "Lengths of the arm as in the formula of docs/kinematics.md.")
              .WhenSet(explicit_arm)
              .RequiredUnless("urdf"),
          Key<S>("axis_signs", MILLPOSE_AT(sign), Signs(), "Sense of each axis; KUKA: [-1, 1, 1, -1, 1, -1].")
              .WhenSet(explicit_arm)
              .RequiredUnless("urdf"),
          Key<S>("zero_offsets_deg", MILLPOSE_AT(offset), Numbers6(kDeg, Between(-360, 360)),
                 "Inner angle where the arm's own angle is 0.")
              .WhenSet(explicit_arm)
              .DefaultText("[0, 0, 0, 0, 0, 0]"),
          KeyBy<S, std::array<Six, 2>>(
              "limits_deg",
              [](const S& s) {
                return std::array<Six, 2>{s.lower, s.upper};
              },
              [](S& s, const std::array<Six, 2>& limits) {
                s.lower = limits[0];
                s.upper = limits[1];
              },
              Limits(), "Limits of the axes; with a URDF, in place of its own.")
              .WhenSet([](const S& s) { return s.lower != s.upper; })
              .RequiredUnless("urdf"),
          Key<S>("speeds_deg_s", MILLPOSE_AT(speed), Numbers6(kDegPerS, Above(0)),
                 "Largest speeds of the axes; with a URDF, in place of its own.")
              .WhenSet([](const S& s) { return !s.speed.isZero(0.0); })
              .RequiredUnless("urdf"),
          Key<S>("limits_source", MILLPOSE_AT(limits_source), Lines(), "Where limits and speeds come from."),
          Key<S>("accelerations_deg_s2", MILLPOSE_AT(acceleration), Numbers6(kDegPerS2, Above(0)),
                 "Largest accelerations of the axes.")
              .Required(),
          Key<S>("accelerations_assumed", MILLPOSE_AT(acceleration_assumed), Flag(),
                 "Whether the accelerations are an assumption without a source."),
          Key<S>("joint_stiffness_Nm_per_rad", MILLPOSE_AT(stiffness), Numbers6(kNmPerRad, Above(0)),
                 "Stiffness of the joints.")
              .Required(),
          Key<S>("joint_stiffness_source", MILLPOSE_AT(stiffness_source), Lines(),
                 "Where the stiffness comes from."),
      },
      CheckArm);
}

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

Codec<ShapeSettings> ShapeFields() {
  using S = ShapeSettings;
  const auto size = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Real(kMm, Above(0)), doc).Required();
  };
  const auto diameter = size("diameter_mm", MILLPOSE_AT(diameter), "Diameter.");
  const auto length = size("length_mm", MILLPOSE_AT(length), "Length along z.");
  return OneOf<S>(
      &S::kind,
      {
          {"box", Section<S>({Key<S>("size_mm", MILLPOSE_AT(size), Numbers3(kMm, Above(0)),
                                     "Edges along x, y, z; centred.")
                                  .Required()})},
          {"sphere", Section<S>({diameter})},
          {"cylinder", Section<S>({diameter, length})},
          {"capsule", Section<S>({diameter, length})},
          {"cone",
           Section<S>(
               {diameter, size("top_diameter_mm", MILLPOSE_AT(top_diameter), "Diameter on top."), length})},
          {"convex", Section<S>({Key<S>("points_mm", MILLPOSE_AT(points),
                                        ListOf(Numbers3(kMm, Between(-100000, 100000))),
                                        "Points whose convex hull is the body; at least 4.")
                                     .Required()},
                                [](const Value& value, const Context& context, S& shape) {
                                  if (shape.points.size() < 4)
                                    context.Child("points_mm")
                                        .Add(value.mark, fmt::format("given {} points; allowed: at least 4",
                                                                     shape.points.size()));
                                })},
          {"mesh", Section<S>({Key<S>("file", MILLPOSE_AT(mesh_file), Text(),
                                      "Mesh file, relative to the file that names it.")
                                   .Required(),
                               KeyBy<S, std::string>(
                                   "unit", [](const S& s) { return LengthUnitName(s.unit); },
                                   [](S& s, const std::string& name) { s.unit = LengthUnit(name); },
                                   Choice(LengthUnits()), "Unit of the mesh file.")
                                   .Required()})},
      });
}

Codec<BodySettings> BodyFields() {
  using S = BodySettings;
  return Section<S>({
      Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in findings and `excluded_pairs`.").Required(),
      Key<S>("class", MILLPOSE_AT(body_class),
             Choice({"link", "spindle", "holder", "cutter", "fixture", "platform"}),
             "What the body is; decides which pairs are checked and with which clearance.")
          .Required(),
      Key<S>("mount", MILLPOSE_AT(mount),
             Choice({"world", "base", "link1", "link2", "link3", "link4", "link5", "link6", "tool",
                     "workpiece"}),
             "Frame that the body hangs on.")
          .Required(),
      Key<S>("shape", MILLPOSE_AT(shape), ShapeFields(), "One shape.").Required(),
      Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Place of the shape in the frame that it hangs on."),
  });
}

const Unit kMmPerNewton{"mm/N", 1, 1}, kRadPerNewtonMetre{"rad/(N·m)", 1, 1000}, kKilogram{"kg", 1, 1},
    kNewtonMetre{"N·m", 1000, 1};
const std::vector<std::string> kLinks{"link1", "link2", "link3", "link4", "link5", "link6"};

Codec<ComplianceSettings> ComplianceFields() {
  using S = ComplianceSettings;
  std::vector<std::string> mounts{"base"};
  mounts.insert(mounts.end(), kLinks.begin(), kLinks.end());
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in outputs.").Required(),
          Key<S>("mount", MILLPOSE_AT(mount), Choice(mounts),
                 "Link whose outer end gives way; link6 is the flange.")
              .Required(),
          Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Frame of the compliance in the mount's frame."),
          Key<S>("translational_mm_N", MILLPOSE_AT(translational), Numbers3(kMmPerNewton, AtLeast(0)),
                 "Displacement per force along x, y, z."),
          Key<S>("rotational_rad_Nm", MILLPOSE_AT(rotational), Numbers3(kRadPerNewtonMetre, AtLeast(0)),
                 "Rotation per moment about x, y, z."),
          Key<S>("matrix", MILLPOSE_AT(matrix), ListOf(Numbers6(kOne, Any())),
                 "Six rows of the full compliance in place of the diagonals: mm/N, 1/N, 1/N, rad/(N·mm).")
              .WhenSet([](const S& s) { return !s.matrix.empty(); }),
      },
      [](const Value& value, const Context& context, S& s) {
        if (s.matrix.empty()) return;
        Eigen::Matrix<double, 6, 6> m;
        for (size_t i = 0; i < 6 && s.matrix.size() == 6; ++i)
          m.row(static_cast<Eigen::Index>(i)) = s.matrix[i];
        if (s.matrix.size() != 6)
          context.Child("matrix").Add(value.mark, fmt::format("given {} rows; allowed: 6", s.matrix.size()));
        else if ((m - m.transpose()).cwiseAbs().maxCoeff() > 1e-9 * m.cwiseAbs().maxCoeff() ||
                 (m.diagonal().array() < 0).any())
          context.Child("matrix").Add(value.mark, "not symmetric, or negative on the diagonal");
        if (!s.translational.isZero(0.0) || !s.rotational.isZero(0.0))
          context.Add(value.mark, "given matrix and diagonals; allowed: one of them");
      });
}

Codec<GravitySettings> GravityFields() {
  using S = GravitySettings;
  using M = MassSettings;
  const Codec<M> mass = Section<M>({
      Key<M>("name", MILLPOSE_AT(name), Text(), "Name.").Required(),
      Key<M>("mount", MILLPOSE_AT(mount), Choice(kLinks), "Link that carries it; link6 is the flange.")
          .Required(),
      Key<M>("mass_kg", MILLPOSE_AT(mass), Real(kKilogram, AtLeast(0)), "Mass.").Required(),
      Key<M>("centre_mm", MILLPOSE_AT(centre), Numbers3(kMm, Between(-10000, 10000)),
             "Centre of gravity in the link's frame.")
          .Required(),
  });
  using B = S;
  const Codec<B> counterbalance = Section<B>({
      Key<B>("torque_Nm", MILLPOSE_AT(counterbalance_torque), Maybe(Real(kNewtonMetre, AtLeast(0))),
             "Largest torque about axis 2.")
          .Required(),
      Key<B>("zero_deg", MILLPOSE_AT(counterbalance_zero), Real(kDeg, Between(-360, 360)),
             "Inner angle of axis 2 at which it gives nothing; torque = -torque_Nm * sin(q2 - zero).")
          .Required(),
  });
  return Section<S>({
      Key<S>("reference_deg", MILLPOSE_AT(reference), Numbers6(kDeg, Between(-3600, 3600)),
             "Pose in which the arm was calibrated: deflections are differences to it.")
          .Required(),
      Key<S>("masses", MILLPOSE_AT(masses), ListOf(mass), "Links, spindle, payload.").Required(),
      Key<S>("counterbalance", kSelf, counterbalance,
             "Device that carries the arm at axis 2; ignored when not given.")
          .WhenSet([](const S& s) { return s.counterbalance_torque.has_value(); }),
  });
}

}  // namespace

const std::vector<std::string>& LengthUnits() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& unit : kLengthUnits) result.emplace_back(unit.name);
    return result;
  }();
  return names;
}

double LengthUnit(const std::string& name) {
  for (const auto& unit : kLengthUnits)
    if (name == unit.name) return unit.mm;
  return 1;
}

std::string LengthUnitName(double mm) {
  for (const auto& unit : kLengthUnits)
    if (unit.mm == mm) return unit.name;
  return "mm";
}

Codec<PoseSettings> PoseFields() {
  using S = PoseSettings;
  return Section<S>({
      Key<S>("xyz_mm", MILLPOSE_AT(position), Numbers3(kMm, Between(-1e6, 1e6)), "Origin."),
      Key<S>("abc_deg", MILLPOSE_AT(abc), Numbers3(kDeg, Between(-360, 360)),
             "A about Z, then B about the new Y, then C about the new X."),
  });
}

const Codec<CellSettings>& CellFields() {
  using S = CellSettings;
  static const Codec<S> fields = Section<S>({
      VersionKey<S>("millpose_cell", 1),
      Key<S>("name", MILLPOSE_AT(name), Text(), "Name of the cell.").Required(),
      Key<S>("arm", MILLPOSE_AT(arm), ArmFields(), "The robot arm.").Required(),
      Key<S>("base_in_world", MILLPOSE_AT(base_in_world), PoseFields(), "Robot base in the world."),
      Key<S>("home_deg", MILLPOSE_AT(home), Numbers6(kDeg, Between(-3600, 3600)),
             "Where programs start and end.")
          .Required(),
      Key<S>("tool", MILLPOSE_AT(tool), ToolFields(), "Tool tip, cutter, holder and spindle.").Required(),
      Key<S>("bodies", MILLPOSE_AT(bodies), ListOf(BodyFields()), "What must not be touched."),
      Key<S>("excluded_pairs", MILLPOSE_AT(excluded_pairs), ListOf(NamePair()),
             "Pairs of bodies that touch by design and are not checked."),
      Key<S>("clearance_mm", kSelf,
             Section<S>({
                 Key<S>("free", MILLPOSE_AT(clearance_free), Real(kMm, AtLeast(0)),
                        "Least distance of all bodies while the tool is out of the material."),
                 Key<S>("cutting", MILLPOSE_AT(clearance_cutting), Real(kMm, AtLeast(0)),
                        "Least distance of spindle and holder from the workpiece while cutting."),
             }),
             "Distances to keep."),
      Key<S>("stiffness", kSelf,
             Section<S>({
                 Key<S>("at", MILLPOSE_AT(stiffness_at), Choice({"tool_tip", "flange"}),
                        "Point at which stiffness is evaluated; flange only to reproduce the paper."),
                 Key<S>("characteristic_length_mm", MILLPOSE_AT(characteristic_length), Real(kMm, Above(0)),
                        "Length by which the dexterity's translational part is divided."),
                 Key<S>("compliances", MILLPOSE_AT(compliances), ListOf(ComplianceFields()),
                        "Platform, links, flange, spindle, tool: compliances in series with the joints'."),
                 Key<S>("gravity", MILLPOSE_AT(gravity), Maybe(GravityFields()),
                        "Weights, for the deflection under gravity."),
             }),
             "How stiffness is evaluated."),
      KeyBy<S, bool>(
          "reproduction_only", [](const S& s) { return !s.programs_allowed; },
          [](S& s, const bool& only) { s.programs_allowed = !only; }, Flag(),
          "The arm's convention is no real controller's: programs are refused."),
      Key<S>("controllers", MILLPOSE_AT(controllers), ControllersFields(),
             "What each controller's programs need to know."),
  });
  return fields;
}

}  // namespace millpose::config
