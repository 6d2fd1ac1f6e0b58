// SPDX-License-Identifier: GPL-3.0-or-later
// Tables 2 and 3, equation 14.
#include "machine/identification/identify.hpp"
#include "tests/paper/page.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

LoadCase Load(const Joints& q, const Vector3d& force, const Vector3d& point) {
  LoadCase load;
  load.q = q;
  load.force = force;
  load.load_point = load.measured_point = point;
  return load;
}

}  // namespace

void Identification2() {
  Write("## Tables 2 and 3, equation 14: identification\n");
  Write(
      "Loads of table 3 from its own parts (tray 39.2 N, discs of 99.8 N): {:.1f}, {:.1f}, {:.1f}, {:.1f} N; "
      "paper 139, 338.6, "
      "538.2, 737.8 N. **Reproduced**.\n",
      39.2 + 99.8, 39.2 + 3 * 99.8, 39.2 + 5 * 99.8, 39.2 + 7 * 99.8);
  Write("Table 2's poses with table 1's arm (the paper prints no positions to compare with):\n");
  Write("| pose | flange centre, mm | D, 1000 mm | in table 5 |\n|---|---|---|---|");
  for (size_t k = 0; k < kTable2.size(); ++k) {
    const Joints& q = kTable2[k];
    const Vector3d p = ForwardFlange(KrQuantecR2700(), q).translation();
    const bool within = (q.array() >= kTable5[0].array()).all() && (q.array() <= kTable5[1].array()).all();
    Write("| {} | {:.1f}, {:.1f}, {:.1f} | {:.3f} | {} |", k + 1, p.x(), p.y(), p.z(),
          Dexterity(Jacobian(KrQuantecR2700(), q, Vector3d::Zero()), 1000),
          within ? "yes" : fmt::format("no: A3 = {:.3f} deg", RadToDeg(q[2])));
  }
  Write("");
  const Arm arm = KrQuantecR2700();
  std::vector<LoadCase> vertical, well;
  for (const Joints& q : kTable2) {
    vertical.push_back(Load(q, {0, 0, -737.8}, Vector3d::Zero()));
    for (const Vector3d& direction :
         {Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 1, -1)})
      well.push_back(Load(q, 737.8 * direction.normalized(), {200, 0, 200}));
  }
  for (std::vector<LoadCase>* cases : {&vertical, &well})  // deflections as equation 14 makes them
    for (LoadCase& load : *cases)
      load.displacement =
          Compliance(Jacobian(arm, load.q, load.load_point), arm.stiffness).topLeftCorner<3, 3>() *
          load.force;
  const Identification poor = IdentifyJointStiffness(arm, vertical, {}),
                       good = IdentifyJointStiffness(arm, well, {});
  std::string blind;
  for (int j = 0; j < 6; ++j)
    if (poor.joints[j].reason.starts_with("not observable")) blind += fmt::format(" A{}", j + 1);
  Write(
      "Vertical loads at the bare flange centre do not show{}: with them the six numbers of equation 14 "
      "**cannot be**",
      blind);
  Write(
      "determined, whatever the measured deflections (which the paper does not print). The same poses with "
      "loads along -z, x, y");
  Write(
      "and x+y-z at (200, 0, 200) mm in the flange show all six, condition number {:.2f} (weighted L, "
      "columns scaled to 1).\n",
      good.condition);
  Write("Equation 14 from deflections that it makes itself, N mm/rad:\n");
  Write(
      "| joint | equation 14 | table 2 and 3, vertical, bare flange | with lever and four directions "
      "|\n|---|---|---|---|");
  for (int j = 0; j < 6; ++j) {
    const auto value = [&](const JointEstimate& joint) {
      return joint.determined ? fmt::format("{:.3e}", joint.stiffness) : std::string("cannot be");
    };
    Write("| {} | {:.3e} | {} | {} |", j + 1, arm.stiffness[j], value(poor.joints[j]), value(good.joints[j]));
  }
  Write("");
}

}  // namespace millpose
