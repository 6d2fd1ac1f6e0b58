// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/registration_error.hpp"

#include "geometry/registration/face_error.hpp"
#include "job/bent_part.hpp"
#include "planning/result/station.hpp"

namespace millpose {

std::optional<RegistrationFigures> ErrorOfRegistration(const JobSettings& job, const PlanResult& plan,
                                                       int finished_from) {
  if (!job.workpiece.registered) return std::nullopt;
  std::vector<PartPlace> face;
  for (const PassResult& pass : plan.passes) {
    if (pass.pass < finished_from) continue;
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const MillingPoint& point = pass.points[i].point;
      if (point.kind != PointKind::kCut || pass.points[i].skip != Infeasibility::kNone) continue;
      const Pose X_PW = PartAt(plan, ExternalAt(pass, i)).inverse(Eigen::Isometry);
      face.push_back({X_PW * point.position, X_PW.linear() * point.normal});
    }
  }
  if (face.empty()) return std::nullopt;
  const RegisteredSettings& known = *job.workpiece.registered;
  const PartBending* bending = BendingOf(job);
  const FaceError error = ErrorOfFace(known.WholeCovariance(), known.centre, face, bending);
  RegistrationFigures figures{
      error.off_95, error.median_off, error.beside_95, job.workpiece.registration_tolerance, {}};
  if (bending) {
    figures.bent = 0;
    for (const PartPlace& place : face)
      figures.bent = std::max(*figures.bent, std::abs(bending->Height(place.position)));
  }
  return figures;
}

std::string RegistrationFinding(const RegistrationFigures& figures) {
  if (!figures.tolerance || figures.off_95 <= *figures.tolerance) return {};
  return fmt::format(
      "the part's place is not known well enough: the face may be off by {:.0f} µm (95 %); allowed: "
      "workpiece.registration.tolerance_mm, {:.0f} µm; `millpose register` says where to probe",
      1e3 * figures.off_95, 1e3 * *figures.tolerance);
}

std::string RegistrationWarning(const JobSettings& job) {
  if ((!job.workpiece.registration_tolerance && !job.workpiece.max_bending) || job.workpiece.registered)
    return {};
  return "workpiece.registration: the part's place was not registered yet; `millpose register` says how far "
         "off the face may be";
}

}  // namespace millpose
