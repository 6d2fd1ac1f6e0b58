// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/face_json.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUmPerMm = 1000;

Json MicrometresJson(const std::optional<double>& millimetres) {
  return millimetres ? Json(kUmPerMm * *millimetres) : Json(nullptr);
}

Json PlaceJson(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Json FiguresJson(const FaceRays& rays, const FaceFigures& face) {
  Json within = nullptr, step = nullptr;
  if (face.within) within = {{"pass", face.within->pass}, {"um", kUmPerMm * face.within->range}};
  if (face.step)
    step = {{"um", kUmPerMm * face.step->height},
            {"passes", {face.step->pass, face.step->other_pass}},
            {"place_mm", PlaceJson(rays.rays[face.step->ray].origin)}};
  return {{"places", face.rays},
          {"places_left_standing", face.standing},
          {"level_um", kUmPerMm * face.heights.level},
          {"lowest_um", kUmPerMm * face.heights.low},
          {"highest_um", kUmPerMm * face.heights.high},
          {"flatness_um", MicrometresJson(face.flatness)},
          {"minimum_zone_um", MicrometresJson(face.minimum_zone)},
          {"added_um",
           {{"level", kUmPerMm * face.added.level},
            {"lowest", kUmPerMm * face.added.low},
            {"highest", kUmPerMm * face.added.high}}},
          {"largest_within_a_pass", within},
          {"largest_step_between_passes", step}};
}

Json IntervalJson(const DrawnInterval& interval) {
  return {kUmPerMm * interval.low, kUmPerMm * interval.high};
}

Json DrawnJson(const std::optional<DrawnFaces>& drawn) {
  if (!drawn) return nullptr;
  return {{"draws", drawn->count},
          {"places", drawn->rays},
          {"share_percent", {5, 95}},
          {"level_um", IntervalJson(drawn->level)},
          {"added_range_um", IntervalJson(drawn->added)},
          {"flatness_um", drawn->flatness ? IntervalJson(*drawn->flatness) : Json(nullptr)},
          {"expected_flatness_um", MicrometresJson(drawn->expected.flatness)}};
}

Json StudyJson(const FaceRays& rays, const FaceStudy& study) {
  const auto or_null = [&](const std::optional<FaceFigures>& face) {
    return face ? FiguresJson(rays, *face) : Json(nullptr);
  };
  return {{"without_error", FiguresJson(rays, study.flawless.figures)},
          {"force", or_null(study.by_force)},
          {"lost_motion", or_null(study.by_lost)},
          {"geometry", or_null(study.by_geometry)},
          {"expected", FiguresJson(rays, study.expected.figures)},
          {"drawn", DrawnJson(study.drawn)}};
}

Json StatedJson(const StatedErrors& stated) {
  constexpr double kArcmin = 60 * kDegPerRad;
  Json lost = nullptr;
  if (stated.lost) {
    lost = Json::array();
    for (int i = 0; i < 6; ++i) lost.push_back(kArcmin * stated.lost->width[i]);
  }
  return {{"force", stated.force ? Json{{"uncertainty_percent", 100 * stated.force_share},
                                        {"direction_deg", RadToDeg(stated.force_angle)}}
                                 : Json(nullptr)},
          {"lost_motion_arcmin", lost},
          {"tool", stated.tip > 0 || stated.lean > 0 ? Json{{"tip_uncertainty_mm", stated.tip},
                                                            {"axis_uncertainty_deg", RadToDeg(stated.lean)}}
                                                     : Json(nullptr)},
          {"gear_error", stated.gears.has_value()},
          {"geometry", stated.geometry},
          {"registration", stated.part.has_value()}};
}

}  // namespace

Json FaceReportJson(const FaceReport& report) {
  Json fixed = nullptr;
  if (report.fixed) {
    fixed = StudyJson(report.rays, *report.fixed);
    fixed["rotation_deg"] = RadToDeg(*report.rotation);
  }
  return {{"spacing_mm", report.rays.spacing},
          {"plane", report.rays.plane},
          {"stated", StatedJson(report.stated)},
          {"not_in_it", NotInFace(report.stated)},
          {"plan", StudyJson(report.rays, report.plan)},
          {"fixed_rotation", fixed},
          {"fixed_rotation_in_the_way",
           report.fixed_in_the_way.empty() ? Json(nullptr) : Json(report.fixed_in_the_way)}};
}

}  // namespace millpose
