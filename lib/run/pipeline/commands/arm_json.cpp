// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/arm_json.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

Json RoundedSix(const Vector6& values, double factor) {
  Json list = Json::array();
  for (const double value : values) list.push_back(Rounded(value, factor));
  return list;
}

Json CalibrationJson(const MeasuredArm& measured) {
  if (!measured.arm.deviations) return {};
  constexpr double kArcsec = 3600 * kDegPerRad;
  const DeviationSettings& deviations = *measured.arm.deviations;
  Json gears = Json::array(), couplings = Json::array();
  for (const JointHarmonic& wave : deviations.gears)
    gears.push_back({{"joint", wave.joint},
                     {"harmonic", wave.harmonic},
                     {"amplitude_arcsec", Rounded(wave.amplitude, kArcsec)}});
  for (const JointCoupling& pair : deviations.couplings)
    couplings.push_back({{"joint", pair.joint}, {"follows", pair.follows}, {"factor", pair.factor}});
  return {{"serial", measured.arm.serial},
          {"date", deviations.date},
          {"source", deviations.source},
          {"largest_shift_mm", measured.largest_shift},
          {"largest_turn_mrad", 1000 * measured.largest_turn},
          {"home_flange_shift_mm", measured.home_shift},
          {"home_flange_turn_deg", RadToDeg(measured.home_turn)},
          {"uncertainty_mm", RoundedOrNull(deviations.uncertainty, 1)},
          {"patterns", deviations.patterns.size()},
          {"gears", gears},
          {"couplings", couplings}};
}

}  // namespace

Json ArrivalJson(const ArmArrival& arrival) {
  Json bodies = Json::array();
  for (const ArmArrival::Body& body : arrival.bodies)
    bodies.push_back({{"name", body.name},
                      {"mount", body.mount},
                      {"size_mm", Json{body.size.x(), body.size.y(), body.size.z()}}});
  Json limits = Json::array();
  for (const auto& [lower, upper] : arrival.limits) limits.push_back({Rounded(lower, 1), Rounded(upper, 1)});
  return {{"joints", arrival.joints}, {"zero", arrival.zero},  {"wrist", arrival.wrist},
          {"limits_deg", limits},     {"link_bodies", bodies}, {"controllers", arrival.controllers},
          {"notes", arrival.notes}};
}

Json MeasuredJson(const MeasuredArm& measured) {
  constexpr double kArcmin = 60 * kDegPerRad, kArcsec = 60 * kArcmin, kNmPerRad = 1e-3, kPercent = 100;
  const ArmSettings& arm = measured.arm;
  Json lost, error, springs = Json::array();
  if (arm.lost_motion)
    lost = {{"arcmin", RoundedSix(*arm.lost_motion, kArcmin)}, {"source", arm.lost_motion_source}};
  if (arm.gear_error)
    error = {{"amplitude_arcsec", RoundedSix(arm.gear_error->amplitude, kArcsec)},
             {"source", arm.gear_error->source}};
  for (const ComplianceSettings& spring : measured.compliances)
    springs.push_back({{"name", spring.name}, {"link", WordOf(kLinkWords, spring.link)}});
  const bool sure = !arm.stiffness_uncertainty.isZero(0.0);
  return {{"calibration", CalibrationJson(measured)},
          {"absolute_accuracy", arm.absolute_accuracy},
          {"lost_motion", lost},
          {"gear_error", error},
          {"joint_stiffness",
           {{"Nm_per_rad", RoundedSix(arm.stiffness, kNmPerRad)},
            {"uncertainty_percent", sure ? RoundedSix(arm.stiffness_uncertainty, kPercent) : Json()},
            {"source", arm.stiffness_source}}},
          {"compliances", springs}};
}

}  // namespace millpose
