// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/deflection.hpp"

#include "base/trig.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// What a deflection needs to know of the external axes' position.
struct Standing {
  Standing(const PlanResult& plan, const std::vector<SeriesCompliance>& compliances,
           const ExternalPosition& external)
      : R_BW(BaseAt(plan, external).linear().transpose()),
        R_PB(PartAt(plan, external).linear().transpose() * BaseAt(plan, external).linear()),
        to_zero(ToZero(plan, external)),
        beside(CompliancesAt(plan, external, compliances)) {}

  Eigen::Matrix3d R_BW, R_PB;
  Pose to_zero;
  std::vector<SeriesCompliance> beside;  ///< the joints
};

/// The largest |nᵀcF′| over all F′ within the bounds, as objective surface_error has it; g = c·n, mm.
double LargestAlong(const Eigen::Vector3d& g, const Eigen::Vector3d& force, const ForceDoubt& bounds) {
  const double whole = g.norm() * force.norm(), along = std::abs(g.dot(force));
  const double beside = std::sqrt(std::max(0.0, whole * whole - along * along));
  const SineCosine off = SinCos(bounds.angle);
  return (1 + bounds.length) * (along >= whole * off.cos ? whole : along * off.cos + beside * off.sin);
}

void AppendDeflection(const DeflectedPoint& point, std::string& csv) {
  constexpr double kMicro = 1000;
  const PredictedDeflection& d = point.deflection;
  const Eigen::Vector3d moved = kMicro * point.moved;
  const Engagement& cut = point.engagement;
  const auto end = std::back_inserter(csv);
  fmt::format_to(end, "{},{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}", point.number, point.pass,
                 Name(cut.side), cut.width, cut.depth, point.force.x(), point.force.y(), point.force.z());
  fmt::format_to(end, ",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", moved.x(), moved.y(),
                 moved.z(), kMicro * d.normal, kMicro * d.feed, kMicro * d.across, kMicro * d.length);
}

}  // namespace

DeflectionReport PredictDeflections(const PlanResult& plan, const CuttingForce& heaviest,
                                    const std::vector<SeriesCompliance>& compliances, int finished_from,
                                    const ForceDoubt& bounds) {
  DeflectionReport report{heaviest, {}, std::nullopt, bounds};
  const Eigen::Vector3d origin = plan.stiffness_origin == StiffnessOrigin::kFlange
                                     ? Eigen::Vector3d::Zero()
                                     : Eigen::Vector3d(plan.X_FT.translation());
  std::vector<FacePoint> face;
  size_t number = 0;
  for (const PassResult& pass : plan.passes) {
    Standing at(plan, compliances, pass.external);
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const PlannedPoint& planned = pass.points[i];
      const size_t here = number++;
      const MillingPoint& point = planned.point;
      if (planned.skip != Infeasibility::kNone || point.kind != PointKind::kCut) continue;
      if (planned.external) at = Standing(plan, compliances, *planned.external);
      const auto& [R_BW, R_PB, to_zero, beside] = at;
      const Matrix6 C = Compliance(Jacobian(plan.arm, planned.q, origin), plan.arm.stiffness) +
                        SeriesComplianceAt(plan.arm, planned.q, origin, beside);
      const Eigen::Matrix3d c = C.topLeftCorner<3, 3>();
      const Eigen::Vector3d force = R_BW * point.engagement.force;
      const PredictedDeflection deflection =
          PredictDeflection(c, force, R_BW * point.normal, R_BW * point.feed);
      const bool of_face = pass.pass >= finished_from && point.engagement.side != CutSide::kAir;
      report.points.push_back({here, pass.pass, point.engagement, R_PB * force, deflection,
                               R_PB * (c * force), LargestAlong(c * (R_BW * point.normal), force, bounds),
                               of_face});
      if (of_face) face.push_back({to_zero * point.position, pass.pass, deflection.normal});
    }
  }
  report.face = OverFace(face);
  return report;
}

void WriteDeflectionCsv(const DeflectionReport& report, int threads, const ByteSink& sink) {
  constexpr size_t kTogether = 1024;  // rows
  sink(
      "point,pass,side,width_mm,depth_mm,force_x_N,force_y_N,force_z_N,x_um,y_um,z_um,normal_um,feed_um,"
      "across_um,length_um\n");
  const size_t count = report.points.size();
  const auto rows = [&](size_t part) {
    std::string csv;
    for (size_t i = part * kTogether; i < std::min(count, (part + 1) * kTogether); ++i)
      AppendDeflection(report.points[i], csv);
    return csv;
  };
  WriteInOrder((count + kTogether - 1) / kTogether, threads, {}, rows, sink);
}

}  // namespace millpose
