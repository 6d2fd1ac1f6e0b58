// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `stiffness:`, one line each.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

const Unit kMmPerNewton{"mm/N", 1, 1}, kRadPerNewtonMetre{"rad/(N·m)", 1, 1000}, kKilogram{"kg", 1, 1};

Codec<GravitySettings> GravityFields() {
  using S = GravitySettings;
  using M = MassSettings;
  const Codec<M> mass = Section<M>({
      Key<M>("name", MILLPOSE_AT(name), Text(), "Name.").Required(),
      Key<M>("mount", MILLPOSE_AT(link), ChoiceOf<int>({kLinkWords.begin() + 1, kLinkWords.end()}),
             "Link that carries it; link6 is the flange.")
          .Required(),
      Key<M>("mass_kg", MILLPOSE_AT(mass), Real(kKilogram, UpTo(1e5)), "Mass.").Required(),
      Key<M>("centre_mm", MILLPOSE_AT(centre), Numbers3(kMm, Between(-10000, 10000)),
             "Centre of gravity in the link's frame.")
          .Required(),
  });
  const Codec<S> counterbalance = Section<S>({
      Key<S>("torque_Nm", MILLPOSE_AT(counterbalance_torque), Maybe(Real(kNewtonMetre, UpTo(1e7))),
             "Largest torque about axis 2.")
          .Required(),
      Key<S>("zero_deg", MILLPOSE_AT(counterbalance_zero), Real(kDeg, Between(-360, 360)),
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

const Unit kNewtonMetre{"N·m", 1000, 1};

Codec<ComplianceSettings> ComplianceFields() {
  using S = ComplianceSettings;
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in outputs.").Required(),
          Key<S>("mount", MILLPOSE_AT(link), ChoiceOf(kLinkWords),
                 "Link whose outer end gives way; link6 is the flange.")
              .Required(),
          Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Frame of the compliance in the mount's frame."),
          Key<S>("translational_mm_N", MILLPOSE_AT(translational), Numbers3(kMmPerNewton, UpTo(1)),
                 "Displacement per force along x, y, z."),
          Key<S>("rotational_rad_Nm", MILLPOSE_AT(rotational), Numbers3(kRadPerNewtonMetre, UpTo(1)),
                 "Rotation per moment about x, y, z."),
          Key<S>("matrix", MILLPOSE_AT(matrix), ListOf(Numbers6(kOne, Between(-1, 1))),
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

Codec<CellSettings> StiffnessFields() {
  using S = CellSettings;
  return Section<S>({
      Key<S>("at", MILLPOSE_AT(stiffness_at), ChoiceOf(kStiffnessOriginWords),
             "Point at which stiffness is evaluated; flange only to reproduce the paper."),
      Key<S>("characteristic_length_mm", MILLPOSE_AT(characteristic_length), Real(kMm, Between(1, 1e5)),
             "Length by which the dexterity's translational part is divided."),
      Key<S>("compliances", MILLPOSE_AT(compliances), ListOf(ComplianceFields()),
             "Platform, links, flange, spindle, tool: compliances in series with the joints'."),
      Key<S>("gravity", MILLPOSE_AT(gravity), Maybe(GravityFields()),
             "Weights, for the deflection under gravity."),
  });
}

}  // namespace millpose::config
